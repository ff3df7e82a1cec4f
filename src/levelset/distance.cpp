#include "burnish/levelset/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "distance_kernel.h"

namespace burnish {
namespace {

using detail::swapped;

// One leaf while facets are scattered to its nodes.
//
// Rows of eight nodes run along the axis to which the surface is most parallel, so that a row's nodes are about equally
// far from it and whole rows can be skipped: a facet whose box is farther from the row than the farthest of the row's
// current distances cannot matter. Coordinates are in cells of the block, relative to its corner, with x and that axis
// swapped.
class BlockScatter {
 public:
  explicit BlockScatter(const TriangleSoup& soup) : soup_(soup) {}

  // Distances of a leaf's nodes to the facets, as far as they are at most `band` of the leaf's cells.
  void run(const Octree& tree, std::size_t leaf, std::span<const std::uint32_t> facets, double band, const std::vector<char>& active) {
    const LatticeNode corner = lattice_node(tree, leaf, 0, 0, 0);
    cell_ = static_cast<double>(1u << tree.level(leaf));
    base_ = {static_cast<double>(corner.x), static_cast<double>(corner.y), static_cast<double>(corner.z)};
    items_.clear();
    for (const std::uint32_t f : facets)
      if (active.empty() || active[f]) add(f);
    swap_axis();
    block_.reset(band * band, static_cast<double>(kNoFacet));
    // Near rows first: they bring the distances down against which far rows are then skipped.
    detail::scatter(items_.data(), items_.size(), std::min(kFirstReach, band), block_.rows());
    detail::scatter(items_.data(), items_.size(), band, block_.rows());
  }

  // The results: squared distances in finest cells, and the facets.
  void store_squared(double* squared) const {
    store(block_.squared, [&](std::size_t to, double d2) { squared[to] = d2 * (cell_ * cell_); });
  }
  void store_nearest(std::uint32_t* nearest) const {
    store(block_.id, [&](std::size_t to, double id) { nearest[to] = static_cast<std::uint32_t>(id); });
  }

 private:
  static constexpr double kFirstReach = 0.5;  // cells

  void add(std::uint32_t f) {
    const auto local = [&](int i) { return (soup_.corner(f, i) - base_) / cell_; };
    items_.push_back(detail::item_of(local(0), local(1), local(2), f));
  }

  void swap_axis() {
    Vec3 across;
    for (const detail::ScatterItem& item : items_) {
      const Vec3 n = cross(item.corners[1] - item.corners[0], item.corners[2] - item.corners[0]);
      across += Vec3{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    }
    axis_ = detail::row_axis(across);
    if (axis_ == 0) return;
    for (detail::ScatterItem& item : items_) {
      for (Vec3& corner : item.corners) corner = swapped(corner, axis_);
      item.low = swapped(item.low, axis_);
      item.high = swapped(item.high, axis_);
    }
  }

  template <class Put>
  void store(const std::array<double, kBlockNodes>& values, Put&& put) const {
    const std::array<std::size_t, 3> stride{1, kBlockSide, kBlockSide * kBlockSide};
    const std::size_t sx = stride[static_cast<std::size_t>(axis_)], sy = axis_ == 1 ? 1 : stride[1], sz = axis_ == 2 ? 1 : stride[2];
    std::size_t n = 0;
    for (std::size_t k = 0; k < kBlockSide; ++k)
      for (std::size_t j = 0; j < kBlockSide; ++j)
        for (std::size_t i = 0; i < kBlockSide; ++i, ++n) put(i * sx + j * sy + k * sz, values[n]);
  }

  const TriangleSoup& soup_;
  double cell_ = 1;
  Vec3 base_;
  int axis_ = 0;
  std::vector<detail::ScatterItem> items_;
  detail::BlockDistances block_;
};

}  // namespace

void exact_squared_distances(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, std::size_t leaf,
                             double band, const std::vector<char>& active, double* squared, std::uint32_t* nearest) {
  BlockScatter block(lattice_soup);
  block.run(grid.octree, leaf, grid.facets_of(leaf), band, active);
  block.store_squared(squared);
  block.store_nearest(nearest);
}

DistanceField exact_distances(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, double band,
                              const std::vector<char>& active, Progress& progress, KeepNearest keep) {
  const std::size_t leaves = grid.octree.size();
  const bool keep_nearest = keep == KeepNearest::yes;
  DistanceField field;
  const auto reach = static_cast<float>(band);
  field.distance = field_over(grid, reach, -reach);
  if (keep_nearest) field.nearest = field_over<std::uint32_t>(grid, kNoFacet, kNoFacet);
  parallel_ranges(leaves, 16, [&](std::size_t begin, std::size_t end) {
    progress.check();
    BlockScatter block(lattice_soup);
    std::array<double, kBlockNodes> squared;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      if (!grid.near_surface(leaf)) continue;
      block.run(grid.octree, leaf, grid.facets_of(leaf), band, active);
      block.store_squared(squared.data());
      detail::roots(squared.data(), field.distance.block(leaf));
      if (keep_nearest) block.store_nearest(field.nearest.block(leaf));
    }
  });
  return field;
}

void squared_distances_to(const TriangleSoup& lattice_soup, std::span<const std::uint32_t> facets, const Octree& tree,
                          std::size_t leaf, double* squared, std::uint32_t* nearest) {
  BlockScatter block(lattice_soup);
  block.run(tree, leaf, facets, tree.side() * 2.0 * kBlockSide, {});
  block.store_squared(squared);
  block.store_nearest(nearest);
}

}  // namespace burnish
