#include "burnish/levelset/distance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "distance_kernel.h"

namespace burnish {
namespace {

using detail::PreparedTriangle;

struct NodeRange {
  int begin, end;
};

// Nodes of one axis of a block within `band` of [low, high].
NodeRange nodes_within(double low, double high, double band) {
  const int begin = static_cast<int>(std::ceil(std::max(low - band, 0.0)));
  const int end = static_cast<int>(std::floor(std::min(high + band, kBlockSide - 1.0))) + 1;
  return {begin, end};
}

double distance_to_range(double x, double low, double high) { return std::max({low - x, x - high, 0.0}); }

Vec3 swapped(Vec3 v, int axis) {
  std::swap(v.x, v[axis]);
  return v;
}

// One block while facets are scattered to its nodes.
//
// Rows of eight nodes run along the axis to which the surface is most parallel, so that a row's nodes are about equally
// far from it and whole rows can be skipped: a facet whose box is farther from the row than the farthest of the row's
// current distances cannot matter. Coordinates are in cells of the block, relative to its corner, with x and that axis
// swapped.
class BlockScatter {
 public:
  // The nodes of a leaf; `band` in its cells.
  BlockScatter(const TriangleSoup& soup, const Octree& tree, std::size_t leaf, double band)
      : soup_(soup), cell_(static_cast<double>(1u << tree.level(leaf))), band_(band) {
    const LatticeNode corner = lattice_node(tree, leaf, 0, 0, 0);
    base_ = {static_cast<double>(corner.x), static_cast<double>(corner.y), static_cast<double>(corner.z)};
    squared_.fill(band * band);
    id_.fill(static_cast<double>(kNoFacet));
    row_max_.fill(band * band);
  }

  void run(std::span<const std::uint32_t> facets, const std::vector<char>& active) {
    choose_axis(facets);
    for (const std::uint32_t f : facets)
      if (active.empty() || active[f]) add(f);
    // Near rows first: they bring the distances down against which far rows are then skipped.
    scatter(std::min(1.0, band_));
    scatter(band_);
  }

  void store(double* squared, std::uint32_t* nearest) const {
    const std::array<std::size_t, 3> stride{1, kBlockSide, kBlockSide * kBlockSide};
    const std::size_t sx = stride[static_cast<std::size_t>(axis_)], sa = axis_ == 1 ? 1 : stride[1], sb = axis_ == 2 ? 1 : stride[2];
    std::size_t n = 0;
    for (std::size_t k = 0; k < kBlockSide; ++k)
      for (std::size_t j = 0; j < kBlockSide; ++j)
        for (std::size_t i = 0; i < kBlockSide; ++i, ++n) {
          const std::size_t to = i * sx + j * sa + k * sb;
          squared[to] = squared_[n] * (cell_ * cell_);
          nearest[to] = static_cast<std::uint32_t>(id_[n]);
        }
  }

 private:
  struct Item {
    PreparedTriangle triangle;
    Vec3 low, high;
    double facet;
  };

  void choose_axis(std::span<const std::uint32_t> facets) {
    Vec3 across;
    for (const std::uint32_t f : facets) {
      const Vec3 n = facet_normal_2a(soup_, f);
      across += Vec3{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    }
    axis_ = across.x <= across.y && across.x <= across.z ? 0 : across.y <= across.z ? 1 : 2;
  }

  void add(std::uint32_t f) {
    const auto local = [&](int i) { return swapped((soup_.corner(f, i) - base_) / cell_, axis_); };
    const Vec3 a = local(0), b = local(1), c = local(2);
    items_.push_back({detail::prepare(a, b, c), min(min(a, b), c), max(max(a, b), c), static_cast<double>(f)});
  }

  void scatter(double band) {
    for (const Item& item : items_) {
      const NodeRange ry = nodes_within(item.low.y, item.high.y, band), rz = nodes_within(item.low.z, item.high.z, band);
      const double dx = std::max({item.low.x - (kBlockSide - 1), -item.high.x, 0.0});
      for (int k = rz.begin; k < rz.end; ++k) {
        const double dz = distance_to_range(k, item.low.z, item.high.z);
        for (int j = ry.begin; j < ry.end; ++j) {
          const double dy = distance_to_range(j, item.low.y, item.high.y);
          const std::size_t row = static_cast<std::size_t>(j + kBlockSide * k);
          if (dx * dx + dy * dy + dz * dz >= row_max_[row]) continue;  // [T-DIST-3]
          double* squared = squared_.data() + row * kBlockSide;
          detail::update_row(item.triangle, item.facet, j, k, squared, id_.data() + row * kBlockSide);
          row_max_[row] = *std::max_element(squared, squared + kBlockSide);
        }
      }
    }
  }

  const TriangleSoup& soup_;
  Vec3 base_;
  const double cell_;
  const double band_;
  int axis_ = 0;
  std::vector<Item> items_;
  std::array<double, kBlockNodes> squared_;
  std::array<double, kBlockNodes> id_;
  std::array<double, kBlockSide * kBlockSide> row_max_;
};

}  // namespace

void exact_squared_distances(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, std::size_t leaf,
                             double band, const std::vector<char>& active, double* squared, std::uint32_t* nearest) {
  BlockScatter block(lattice_soup, grid.octree, leaf, band);
  block.run(grid.facets_of(leaf), active);
  block.store(squared, nearest);
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

void squared_distances_to(const TriangleSoup& lattice_soup, std::span<const std::uint32_t> facets, const Octree& tree,
                          std::size_t leaf, double* squared, std::uint32_t* nearest) {
  BlockScatter block(lattice_soup, tree, leaf, tree.side() * 2.0 * kBlockSide);
  block.run(facets, {});
  block.store(squared, nearest);
}

}  // namespace burnish
