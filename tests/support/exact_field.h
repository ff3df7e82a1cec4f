// Exact signed distances at the nodes of leaves of any level, the surface's lists of facets given.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>

#include "burnish/levelset/distance.h"
#include "support/level_sets.h"

namespace burnish::test {

// Signed by `inside(point)`. Leaves without facets get not a number: nothing there may be looked at.
template <class Inside>
Field<double> exact_field(const TriangleSoup& soup, const SurfaceOctree& grid, const Inside& inside) {
  Field<double> field(grid.octree.size(), std::numeric_limits<double>::quiet_NaN());
  std::array<double, kBlockNodes> squared;
  std::array<std::uint32_t, kBlockNodes> nearest;
  for (std::size_t leaf = 0; leaf < grid.octree.size(); ++leaf) {
    if (!grid.near_surface(leaf)) continue;
    squared_distances_to(soup, grid.facets_of(leaf), grid.octree, leaf, squared.data(), nearest.data());
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
      const Vec3 p = to_vec(lattice_node(grid.octree, leaf, n % 8, n / 8 % 8, n / 64));
      const double d = std::sqrt(squared[static_cast<std::size_t>(n)]);
      field.block(leaf)[n] = inside(p) ? d : -d;
    }
  }
  return field;
}

}  // namespace burnish::test
