#include "burnish/levelset/distance.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "distance_kernel.h"

namespace burnish {
namespace {

using detail::PreparedTriangle;

struct NodeRange {
  int begin, end;
};

// Nodes of one axis of a block (lower corner `base`) within `band` of [low, high].
NodeRange nodes_within(double low, double high, double base, double band) {
  const int begin = static_cast<int>(std::ceil(std::max(low - band - base, 0.0)));
  const int end = static_cast<int>(std::floor(std::min(high + band - base, kBlockSide - 1.0))) + 1;
  return {begin, end};
}

double distance_to_range(double x, double low, double high) { return std::max({low - x, x - high, 0.0}); }

// The squared distances of one block while its facets are scattered, and the farthest of each row,
// below which a facet must come to matter.
struct BlockDistances {
  std::array<double, kBlockNodes> squared;
  std::array<double, kBlockNodes> id;
  std::array<double, kBlockSide * kBlockSide> row_max;

  explicit BlockDistances(double band) {
    squared.fill(band * band);
    id.fill(static_cast<double>(kNoFacet));
    row_max.fill(band * band);
  }
};

void scatter_facet(const TriangleSoup& soup, std::uint32_t f, const Vec3& base, double band, BlockDistances& block) {
  const Vec3 &a = soup.corner(f, 0), &b = soup.corner(f, 1), &c = soup.corner(f, 2);
  const Vec3 low = min(min(a, b), c), high = max(max(a, b), c);
  const NodeRange ry = nodes_within(low.y, high.y, base.y, band), rz = nodes_within(low.z, high.z, base.z, band);
  if (ry.begin >= ry.end || rz.begin >= rz.end) return;
  const PreparedTriangle t = detail::prepare(a, b, c);
  for (int k = rz.begin; k < rz.end; ++k) {
    const double dz = distance_to_range(base.z + k, low.z, high.z);
    for (int j = ry.begin; j < ry.end; ++j) {
      const double dy = distance_to_range(base.y + j, low.y, high.y);
      const std::size_t row = static_cast<std::size_t>(j + kBlockSide * k);
      if (dy * dy + dz * dz >= block.row_max[row]) continue;
      double* squared = block.squared.data() + row * kBlockSide;
      detail::update_row(t, f, base.x, base.y + j, base.z + k, squared, block.id.data() + row * kBlockSide);
      block.row_max[row] = *std::max_element(squared, squared + kBlockSide);
    }
  }
}

}  // namespace

void exact_squared_distances(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, std::size_t leaf,
                             double band, const std::vector<char>& active, double* squared, std::uint32_t* nearest) {
  const LatticeNode corner = lattice_node(grid.octree, leaf, 0, 0, 0);
  const Vec3 base{static_cast<double>(corner.x), static_cast<double>(corner.y), static_cast<double>(corner.z)};
  BlockDistances block(band);
  for (const std::uint32_t f : grid.facets_of(leaf))
    if (active.empty() || active[f]) scatter_facet(lattice_soup, f, base, band, block);
  std::copy(block.squared.begin(), block.squared.end(), squared);
  std::transform(block.id.begin(), block.id.end(), nearest, [](double id) { return static_cast<std::uint32_t>(id); });
}

DistanceField exact_distances(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, double band,
                              const std::vector<char>& active, Progress& progress) {
  const std::size_t leaves = grid.octree.size();
  DistanceField field{Field<float>(leaves, static_cast<float>(band)), Field<std::uint32_t>(leaves, kNoFacet)};
  parallel_ranges(leaves, 16, [&](std::size_t begin, std::size_t end) {
    progress.check();
    std::array<double, kBlockNodes> squared;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      if (!grid.near_surface(leaf)) continue;
      exact_squared_distances(lattice_soup, grid, leaf, band, active, squared.data(), field.nearest.block(leaf));
      std::transform(squared.begin(), squared.end(), field.distance.block(leaf),
                     [](double d2) { return static_cast<float>(std::sqrt(d2)); });
    }
  });
  return field;
}

}  // namespace burnish
