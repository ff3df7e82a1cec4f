#include "point_table.h"

#include <algorithm>
#include <utility>

namespace burnish {

PointTable::PointTable(std::size_t expected_points)
    : slots_(std::bit_ceil(std::max<std::size_t>(16, 2 * expected_points))), mask_(slots_.size() - 1) {
  points_.reserve(expected_points);
}

std::uint32_t PointTable::find(const Vec3& p) const {
  const std::uint64_t hash = hash_of(p);
  for (std::uint64_t at = hash & mask_; slots_[at].number != kFree; at = (at + 1) & mask_)
    if (points_[slots_[at].number] == p) return slots_[at].number;
  return kFree;
}

void PointTable::grow() {
  slots_.assign(2 * slots_.size(), Slot{});
  mask_ = slots_.size() - 1;
  for (std::size_t i = 0; i < points_.size(); ++i) {
    const std::uint64_t hash = hash_of(points_[i]);
    std::uint64_t at = hash & mask_;
    while (slots_[at].number != kFree) at = (at + 1) & mask_;
    slots_[at] = {static_cast<std::uint32_t>(hash >> 32), static_cast<std::uint32_t>(i)};
  }
}

}  // namespace burnish
