#include "burnish/levelset/accepted.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <numbers>

#include "../octree/cell_scatter.h"
#include "../octree/lattice_lookup.h"
#include "burnish/core/parallel.h"

namespace burnish {
namespace {

// A leaf and one layer around it in cubes of half its cells' side: of these every cell of whatever level that touches the leaf is made.
constexpr int kHalves = 2 * kBlockSide;
constexpr int kSide = kHalves + 2;
using Halves = std::array<std::uint8_t, std::size_t{kSide} * kSide * kSide>;

constexpr std::size_t half_index(int x, int y, int z) {
  return static_cast<std::size_t>((x + 1) + kSide * ((y + 1) + kSide * (z + 1)));
}

struct Span {
  int begin, end;
};
constexpr Span span_of(int offset) {
  return offset < 0 ? Span{-1, 0} : offset > 0 ? Span{kHalves, kHalves + 1} : Span{0, kHalves};
}

// Values of cells, as cubes of half their side around a leaf see them.
class HalfView {
 public:
  HalfView(const Octree& tree, const Field<std::uint8_t>& cells, std::size_t leaf)
      : tree_(tree), cells_(cells), leaf_(static_cast<std::uint32_t>(leaf)), level_(tree.level(leaf)), corner_(lattice_node(tree, leaf, 0, 0, 0)) {}

  void fill(std::uint8_t least, Halves& halves) const {
    halves.fill(0);
    for (int dir = 0; dir < kDirections; ++dir) {
      if (dir != kSelf && tree_.neighbor_kind(leaf_, dir) == NeighborKind::wall) continue;
      const std::uint32_t other = tree_.neighbor_kind(leaf_, dir) == NeighborKind::finer ? Octree::kNone : tree_.neighbor(leaf_, dir);
      if (dir == kSelf) {
        fill_own(least, halves);
        continue;
      }
      const auto [dx, dy, dz] = offset_of(dir);
      const Span xs = span_of(dx), ys = span_of(dy), zs = span_of(dz);
      for (int z = zs.begin; z < zs.end; ++z)
        for (int y = ys.begin; y < ys.end; ++y)
          for (int x = xs.begin; x < xs.end; ++x) halves[half_index(x, y, z)] = value(other, x, y, z) >= least;
    }
  }

 private:
  void fill_own(std::uint8_t least, Halves& halves) const {
    const std::uint8_t* own = cells_.block(leaf_);
    for (int z = 0; z < kHalves; ++z)
      for (int y = 0; y < kHalves; ++y) {
        const std::uint8_t* row = own + node_index(0, y / 2, z / 2);
        for (int x = 0; x < kHalves; ++x) halves[half_index(x, y, z)] = row[x / 2] >= least;
      }
  }

  // `other`: the leaf that holds the cube, unless there are several on that side.
  std::uint8_t value(std::uint32_t other, int x, int y, int z) const {
    const std::array<std::int64_t, 3> doubled{at(corner_.x, x), at(corner_.y, y), at(corner_.z, z)};
    if (other == Octree::kNone) {
      const auto half = [&](std::size_t a) { return static_cast<std::int32_t>(doubled[a] / 2); };
      other = tree_.find_near(leaf_, detail::block_of({half(0), half(1), half(2)}));
    }
    const LatticeNode from = lattice_node(tree_, other, 0, 0, 0);
    const int shift = tree_.level(other) + 1;
    const auto local = [&](std::size_t a, std::int32_t low) { return static_cast<int>((doubled[a] - 2 * std::int64_t{low}) >> shift); };
    return cells_.block(other)[node_index(local(0, from.x), local(1, from.y), local(2, from.z))];
  }

  // In units of half a finest cell.
  std::int64_t at(std::int32_t corner, int half) const { return 2 * std::int64_t{corner} + half * (std::int64_t{1} << level_); }

  const Octree& tree_;
  const Field<std::uint8_t>& cells_;
  const std::uint32_t leaf_;
  const int level_;
  const LatticeNode corner_;
};

// out[n] = whether some cube is set in a box about place n: from cube 2 n - 1 on, `width` of them along each axis. Axis by axis.
std::array<std::uint8_t, kBlockNodes> any_within(const Halves& halves, int width) {
  constexpr std::size_t plane = std::size_t{kSide} * kSide, thin = std::size_t{kBlockSide} * kSide;
  std::array<std::uint8_t, kBlockSide * plane> along_z{};
  std::array<std::uint8_t, kBlockSide * thin> along_yz{};
  std::array<std::uint8_t, kBlockNodes> out{};
  for (std::size_t k = 0; k < kBlockSide; ++k)
    for (std::size_t z = 2 * k; z < 2 * k + static_cast<std::size_t>(width); ++z)
      for (std::size_t n = 0; n < plane; ++n) along_z[n + plane * k] |= halves[n + plane * z];
  for (std::size_t k = 0; k < kBlockSide; ++k)
    for (std::size_t j = 0; j < kBlockSide; ++j)
      for (std::size_t y = 2 * j; y < 2 * j + static_cast<std::size_t>(width); ++y)
        for (std::size_t x = 0; x < kSide; ++x) along_yz[x + kSide * j + thin * k] |= along_z[x + kSide * y + plane * k];
  for (std::size_t n = 0; n < kBlockNodes; ++n)
    for (std::size_t x = 2 * (n % 8); x < 2 * (n % 8) + static_cast<std::size_t>(width); ++x) out[n] |= along_yz[x + kSide * (n / 8)];
  return out;
}

// The leaves of which some cell is at least `least`, and those that touch one of them.
std::vector<std::uint32_t> leaves_around(const Octree& tree, const Field<std::uint8_t>& cells, std::uint8_t least) {
  std::vector<char> has(tree.size());
  parallel_for(tree.size(), [&](std::size_t leaf) {
    const std::uint8_t* block = cells.block(leaf);
    has[leaf] = std::any_of(block, block + kBlockNodes, [&](std::uint8_t v) { return v >= least; });
  }, 256);
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t leaf = 0; leaf < tree.size(); ++leaf) {
    bool near = cells.stores(leaf) && has[leaf];
    for (int dir = 0; dir < kDirections && !near && cells.stores(leaf); ++dir)
      for (const std::uint32_t other : tree.neighbors(leaf, dir)) near |= has[other] != 0;
    if (near) leaves.push_back(leaf);
  }
  return leaves;
}

void mark_cut(const TriangleSoup& soup, const SurfaceOctree& grid, const std::vector<char>& active, Field<std::uint8_t>& cells, Progress& progress) {
  parallel_ranges(grid.octree.size(), 64, [&](std::size_t begin, std::size_t end) {
    progress.check();
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      if (!cells.stores(leaf)) continue;
      const LatticeNode c = lattice_node(grid.octree, leaf, 0, 0, 0);
      const Vec3 corner{static_cast<double>(c.x), static_cast<double>(c.y), static_cast<double>(c.z)};
      const OctantFacets octant{soup, grid.facets_of(leaf), corner, grid.octree.level(leaf), kBlockSide, 0};
      std::uint8_t* marks = cells.block(leaf);
      for (const std::uint32_t f : octant.facets)
        if (active.empty() || active[f]) detail::for_cells_cut(octant, f, [&](std::size_t cell) {
          marks[cell] = static_cast<std::uint8_t>(AcceptedMark::cut);
          return false;
        });
    }
  });
}

// For each of the leaves, put(leaf, marks) with what `cells`' cubes of at least `least` have in the box about each place.
template <class Put>
void for_surroundings(const Octree& tree, const Field<std::uint8_t>& cells, AcceptedMark least, int width, Progress& progress, Put&& put) {
  const std::vector<std::uint32_t> leaves = leaves_around(tree, cells, static_cast<std::uint8_t>(least));
  parallel_ranges(leaves.size(), 16, [&](std::size_t begin, std::size_t end) {
    progress.check();
    Halves halves;
    for (std::size_t i = begin; i < end; ++i) {
      HalfView(tree, cells, leaves[i]).fill(static_cast<std::uint8_t>(least), halves);
      put(leaves[i], any_within(halves, width));
    }
  });
}

std::uint64_t count_at_least(const Field<std::uint8_t>& field, std::uint8_t least) {
  const auto range = [&](std::size_t begin, std::size_t end) {
    return static_cast<std::uint64_t>(std::count_if(field.values().begin() + static_cast<std::ptrdiff_t>(begin), field.values().begin() + static_cast<std::ptrdiff_t>(end),
                                                    [&](std::uint8_t v) { return v >= least; }));
  };
  return parallel_reduce(field.values().size(), std::size_t{1} << 16, std::uint64_t{0}, range, std::plus<>());
}

}  // namespace

double accepted_band(bool several_levels) { return (several_levels ? 4 : 2) * std::numbers::sqrt3; }

template <class T>
AcceptedCells accepted_cells(const TriangleSoup& lattice_soup, const BasicLevelSet<T>& level_set, const std::vector<char>& active, Progress& progress) {
  const Octree& tree = level_set.octree();
  AcceptedCells result;
  Field<std::uint8_t> cut = Field<std::uint8_t>::like(level_set.phi, 0, 0);
  mark_cut(lattice_soup, level_set.grid, active, cut, progress);
  result.cells = cut;
  // Cells touch where their cubes of half the smaller one's side do: four along each axis, the cell's own two in their middle.
  for_surroundings(tree, cut, AcceptedMark::cut, 4, progress, [&](std::uint32_t leaf, const auto& touched) {
    std::uint8_t* marks = result.cells.block(leaf);
    for (std::size_t n = 0; n < kBlockNodes; ++n) marks[n] = std::max(marks[n], touched[n]);
  });
  // A node is in the cells of the eight cubes around it.
  result.nodes = Field<std::uint8_t>::like(level_set.phi, 0, 0);
  for_surroundings(tree, result.cells, AcceptedMark::neighbor, 2, progress,
                   [&](std::uint32_t leaf, const auto& held) { std::copy(held.begin(), held.end(), result.nodes.block(leaf)); });
  result.cells_cut = count_at_least(result.cells, static_cast<std::uint8_t>(AcceptedMark::cut));
  result.cells_accepted = count_at_least(result.cells, static_cast<std::uint8_t>(AcceptedMark::neighbor));
  result.nodes_accepted = count_at_least(result.nodes, 1);
  return result;
}

template <class T>
Field<std::uint8_t> nodes_within_band(const BasicLevelSet<T>& level_set, Progress& progress) {
  const Octree& tree = level_set.octree();
  Field<std::uint8_t> nodes = Field<std::uint8_t>::like(level_set.phi, 0, 0);
  parallel_ranges(tree.size(), 64, [&](std::size_t begin, std::size_t end) {
    progress.check();
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      if (!nodes.stores(leaf) || !level_set.grid.near_surface(leaf)) continue;
      const double band = std::ldexp(level_set.band, tree.level(leaf));
      const T* phi = level_set.phi.block(leaf);
      std::transform(phi, phi + kBlockNodes, nodes.block(leaf), [&](T v) { return std::uint8_t{std::abs(static_cast<double>(v)) < band}; });
    }
  });
  return nodes;
}

template AcceptedCells accepted_cells(const TriangleSoup&, const BasicLevelSet<float>&, const std::vector<char>&, Progress&);
template AcceptedCells accepted_cells(const TriangleSoup&, const BasicLevelSet<double>&, const std::vector<char>&, Progress&);
template Field<std::uint8_t> nodes_within_band(const BasicLevelSet<float>&, Progress&);
template Field<std::uint8_t> nodes_within_band(const BasicLevelSet<double>&, Progress&);

}  // namespace burnish
