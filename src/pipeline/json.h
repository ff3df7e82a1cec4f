// What everything that Burnish prints as JSON has in common.
#pragma once

#include <nlohmann/json.hpp>
#include <string>

#include "burnish/core/vec.h"

namespace burnish {

using Json = nlohmann::ordered_json;

// Names may hold any bytes; JSON holds UTF-8 only.
inline std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

inline Json generator() { return "burnish " BURNISH_VERSION; }

inline Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

inline Json json_of(const Box3& box) {
  if (box.empty()) return nullptr;
  return {{"lower", json_of(box.lower)}, {"upper", json_of(box.upper)}, {"diagonal", box.diagonal()}};
}

}  // namespace burnish
