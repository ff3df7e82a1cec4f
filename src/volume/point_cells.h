// The cells at each point of a volume mesh.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/volume/volume_mesh.h"

namespace burnish {

class PointCells {
 public:
  explicit PointCells(const VolumeMesh& mesh) : first_(mesh.mesh.points.size() + 1, 0), cells_(mesh.corners.size()) {
    for (const std::uint32_t p : mesh.corners) ++first_[p + 1];
    for (std::size_t p = 1; p < first_.size(); ++p) first_[p] += first_[p - 1];
    std::vector<std::uint64_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t c = 0; c < mesh.cells(); ++c)
      for (const std::uint32_t p : mesh.cell(c)) cells_[next[p]++] = c;
  }

  // Ascending.
  std::span<const std::uint32_t> operator[](std::size_t point) const { return {cells_.data() + first_[point], static_cast<std::size_t>(first_[point + 1] - first_[point])}; }

 private:
  std::vector<std::uint64_t> first_;
  std::vector<std::uint32_t> cells_;
};

}  // namespace burnish
