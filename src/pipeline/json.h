// What everything that Burnish prints as JSON has in common.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/build_info.h"
#include "burnish/core/error.h"
#include "burnish/core/timer.h"
#include "burnish/core/vec.h"
#include "burnish/octree/refine.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/compare.h"

namespace burnish {

using Json = nlohmann::ordered_json;

// Names may hold any bytes; JSON holds UTF-8 only.
inline std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

inline Json generator() { return "burnish " + std::string(build_info().version); }

template <class T>
Json or_null(const std::optional<T>& value) { return value ? Json(*value) : Json(); }

inline Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

inline Json json_of(const Box3& box) {
  if (box.empty()) return nullptr;
  return {{"lower", json_of(box.lower)}, {"upper", json_of(box.upper)}, {"diagonal", box.diagonal()}};
}

inline Json json_of(const Error& error) {
  return {{"code", name(error.code())}, {"exit_code", exit_code(error.code())}, {"message", error.what()}, {"hint", error.hint()}};
}

// "mm", or null.
inline Json json_of(const std::optional<ModelUnit>& unit) { return unit ? Json(std::string(name(*unit))) : Json(); }

// Why there is no result, or null.
inline Json failure_of(const std::optional<Error>& failure) { return failure ? json_of(*failure) : Json(); }

// Null if nothing was measured.
inline Json json_of(const OneSidedDistance& d) {
  if (d.samples == 0) return nullptr;
  return {{"max", d.max}, {"mean", d.mean}, {"rms", d.rms}, {"samples", d.samples}};
}

inline Json json_of(const Loss& l) {
  return {{"position", json_of(l.position)}, {"distance", l.distance}, {"area", l.area}, {"samples", l.samples}, {"reason", l.reason}};
}

inline Json json_of(const std::vector<StageCost>& stages) {
  Json list = Json::array();
  for (const StageCost& stage : stages) {
    list.push_back({
        {"name", stage.name},
        {"wall_seconds", stage.wall_seconds},
        {"cpu_seconds", stage.cpu_seconds},
        {"peak_bytes", stage.peak_bytes},
    });
  }
  return list;
}

// How many octants each criterion of `limits` divided, null where it was not asked for, and the balance.
inline Json divisions_of(const RefinementLimits& limits, const GrowthStatistics& statistics) {
  Json divided;
  for (const char* criterion : {"max_face_limit", "max_face_cut", "refine_tol"}) divided[criterion] = nullptr;
  const auto criteria = criteria_of(limits);
  for (std::size_t c = 0; c < criteria.size(); ++c) divided[std::string(criteria[c]->name())] = statistics.divided_by[c];
  divided["balance"] = statistics.divided_by_balance;
  return divided;
}

}  // namespace burnish
