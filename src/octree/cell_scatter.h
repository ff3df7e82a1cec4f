// The cells of an octant that a facet cuts.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>

#include "burnish/octree/refine.h"

namespace burnish::detail {

inline constexpr std::size_t kMostCells = kBlockNodes;

// Calls visit(cell), cell = i + n (j + n k), for the cells that facet f cuts (closed) until one call returns true, which is
// then returned.
template <class Visit>
bool for_cells_cut(const OctantFacets& octant, std::uint32_t f, Visit&& visit) {
  const TriangleSoup& soup = octant.soup;
  const Vec3 &a = soup.corner(f, 0), &b = soup.corner(f, 1), &c = soup.corner(f, 2);
  const double cell = octant.cell();
  const Vec3 low = (min(min(a, b), c) - octant.corner) / cell, high = (max(max(a, b), c) - octant.corner) / cell;
  const int n = octant.cells_per_side;
  int begin[3], end[3];
  for (int axis = 0; axis < 3; ++axis) {
    begin[axis] = static_cast<int>(std::max(std::ceil(low[axis]) - 1, 0.0));
    end[axis] = static_cast<int>(std::min(std::floor(high[axis]), n - 1.0)) + 1;
  }
  for (int k = begin[2]; k < end[2]; ++k)
    for (int j = begin[1]; j < end[1]; ++j)
      for (int i = begin[0]; i < end[0]; ++i) {
        const Vec3 center = octant.corner + Vec3{i + 0.5, j + 0.5, k + 0.5} * cell;
        if (triangle_overlaps_cube(a, b, c, center, 0.5 * cell) && visit(static_cast<std::size_t>(i + n * (j + n * k)))) return true;
      }
  return false;
}

// The cell that holds point p (half-open), or kMostCells if none of the octant does.
inline std::size_t cell_of(const OctantFacets& octant, const Vec3& p) {
  const Vec3 q = (p - octant.corner) / octant.cell();
  const int n = octant.cells_per_side;
  if (!(q.x >= 0 && q.y >= 0 && q.z >= 0 && q.x < n && q.y < n && q.z < n)) return kMostCells;
  return static_cast<std::size_t>(static_cast<int>(q.x) + n * (static_cast<int>(q.y) + n * static_cast<int>(q.z)));
}

}  // namespace burnish::detail
