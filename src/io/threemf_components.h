// How often the components of a 3MF place objects, counted before lib3mf reads it: that visits every placement, and ten lines can ask for 10^10.
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <unordered_map>

namespace burnish {

// Takes the XML of a model in pieces and knows the objects' and components' tags alone. Memory: one number an object.
class ComponentCounter {
 public:
  void put(std::string_view piece);
  // Of the object with most: itself, its components, theirs, and so on; each as often as it is there. No more than 2^62.
  std::uint64_t most_placements() const { return most_; }

 private:
  void take(std::string_view tag);

  std::string tag_;  // from its < on
  bool in_tag_ = false;
  std::uint64_t object_ = 0;  // the id of the one that is open
  std::unordered_map<std::uint64_t, std::uint64_t> placements_;
  std::uint64_t most_ = 0;
};

}  // namespace burnish
