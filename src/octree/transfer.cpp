#include "burnish/octree/transfer.h"

#include <algorithm>
#include <array>
#include <utility>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr std::size_t kLeafGrain = 16;

// Of a block's cells, the slope along an axis, per cell.
template <class T>
double slope(const T* values, std::array<int, 3> cell, std::size_t axis) {
  std::array<int, 3> low = cell, high = cell;
  low[axis] = std::max(cell[axis] - 1, 0);
  high[axis] = std::min(cell[axis] + 1, kBlockSide - 1);
  const auto at = [&](const std::array<int, 3>& c) { return static_cast<double>(values[node_index(c[0], c[1], c[2])]); };
  return (at(high) - at(low)) / (high[axis] - low[axis]);
}

// Cells of leaf `leaf` of `to`, which lies in the leaf `old` of `from`. [T-ADAPT-4]
template <class T>
void refine_cells(const Octree& from, const T* values, std::size_t old, const Octree& to, std::size_t leaf, Reconstruction reconstruction, T* out) {
  const LatticeNode base = lattice_node(from, old, 0, 0, 0);
  const int large = 1 << from.level(old);
  const double small = static_cast<double>(1 << to.level(leaf)) / large;
  std::size_t n = 0;
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j)
      for (int i = 0; i < kBlockSide; ++i, ++n) {
        const LatticeNode node = lattice_node(to, leaf, i, j, k);
        const std::array<std::int32_t, 3> at{node.x - base.x, node.y - base.y, node.z - base.z};
        const std::array<int, 3> cell{at[0] / large, at[1] / large, at[2] / large};
        double value = values[node_index(cell[0], cell[1], cell[2])];
        if (reconstruction == Reconstruction::linear)
          for (std::size_t axis = 0; axis < 3; ++axis) {
            const double offset = static_cast<double>(at[axis] % large) / large + 0.5 * small - 0.5;  // of the centre, in old cells
            value += slope(values, cell, axis) * offset;
          }
        out[n] = static_cast<T>(value);
      }
}

// Cells of leaf `leaf` of `to`, which holds the leaves `range` of `from`. [T-ADAPT-4]
template <class T>
void coarsen_cells(const Octree& from, const Field<T>& field, LeafRange range, const Octree& to, std::size_t leaf, T* out) {
  std::array<double, kBlockNodes> sum{};
  const LatticeNode base = lattice_node(to, leaf, 0, 0, 0);
  const int level = to.level(leaf);
  for (std::size_t old = range.begin; old < range.end; ++old) {
    const double weight = 1.0 / static_cast<double>(std::uint64_t{1} << 3 * (level - from.level(old)));
    const T* values = field.block(old);
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i) {
          const LatticeNode node = lattice_node(from, old, i, j, k);
          sum[node_index((node.x - base.x) >> level, (node.y - base.y) >> level, (node.z - base.z) >> level)] +=
              weight * static_cast<double>(values[node_index(i, j, k)]);
        }
  }
  std::transform(sum.begin(), sum.end(), out, [](double v) { return static_cast<T>(v); });
}

std::vector<std::uint32_t> united_lists(const SurfaceOctree& grid, LeafRange range) {
  std::vector<std::uint32_t> all;
  for (std::size_t leaf = range.begin; leaf < range.end; ++leaf) {
    const auto list = grid.facets_of(leaf);
    all.insert(all.end(), list.begin(), list.end());
  }
  std::sort(all.begin(), all.end());
  all.erase(std::unique(all.begin(), all.end()), all.end());
  return all;
}

}  // namespace

LeafRange leaves_in(const Octree& tree, std::uint64_t key) {
  const std::size_t begin = tree.find(morton::corner(key));
  const std::uint64_t last = key + ((std::uint64_t{1} << 3 * morton::level(key)) - 1);
  std::size_t end = begin + 1;
  while (end < tree.size() && tree.key(end) <= last) ++end;
  return {begin, end};
}

template <class T>
Field<T> transfer_nodal(const Octree& from, const Field<T>& field, const Octree& to) {
  Field<T> result(to.size(), T{});
  parallel_for(
      to.size(),
      [&](std::size_t leaf) {
        T* out = result.block(leaf);
        if (const std::uint32_t same = from.find_key(to.key(leaf)); same != Octree::kNone) {
          std::copy_n(field.block(same), kBlockNodes, out);
          return;
        }
        for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
          out[n] = static_cast<T>(node_value(
              from, field, lattice_node(to, leaf, n % kBlockSide, n / kBlockSide % kBlockSide, n / (kBlockSide * kBlockSide))));
      },
      kLeafGrain);
  return result;
}

template <class T>
Field<T> transfer_conserved(const Octree& from, const Field<T>& field, const Octree& to, Reconstruction reconstruction) {
  Field<T> result(to.size(), T{});
  parallel_for(
      to.size(),
      [&](std::size_t leaf) {
        T* out = result.block(leaf);
        const LeafRange range = leaves_in(from, to.key(leaf));
        const int old_level = from.level(range.begin), level = to.level(leaf);
        if (old_level == level)
          std::copy_n(field.block(range.begin), kBlockNodes, out);
        else if (old_level > level)
          refine_cells(from, field.block(range.begin), range.begin, to, leaf, reconstruction, out);
        else
          coarsen_cells(from, field, range, to, leaf, out);
      },
      kLeafGrain);
  return result;
}

SurfaceOctree transfer_facets(const SurfaceOctree& from, Octree to) {
  SurfaceOctree result;
  std::vector<std::vector<std::uint32_t>> united(to.size());  // of leaves that hold several old ones
  std::vector<LeafRange> ranges(to.size());
  result.first_facet.assign(to.size() + 1, 0);
  parallel_for(
      to.size(),
      [&](std::size_t leaf) {
        const LeafRange range = ranges[leaf] = leaves_in(from.octree, to.key(leaf));
        if (range.end - range.begin > 1) united[leaf] = united_lists(from, range);
        result.first_facet[leaf] = range.end - range.begin > 1 ? united[leaf].size() : from.facets_of(range.begin).size();
      },
      kLeafGrain);
  result.facets.resize(exclusive_scan_in_place(result.first_facet));
  parallel_for(
      to.size(),
      [&](std::size_t leaf) {
        const std::span<const std::uint32_t> list =
            ranges[leaf].end - ranges[leaf].begin > 1 ? std::span<const std::uint32_t>(united[leaf]) : from.facets_of(ranges[leaf].begin);
        std::copy(list.begin(), list.end(), result.facets.begin() + static_cast<std::ptrdiff_t>(result.first_facet[leaf]));
      },
      kLeafGrain);
  result.octree = std::move(to);
  return result;
}

template Field<float> transfer_nodal(const Octree&, const Field<float>&, const Octree&);
template Field<double> transfer_nodal(const Octree&, const Field<double>&, const Octree&);
template Field<float> transfer_conserved(const Octree&, const Field<float>&, const Octree&, Reconstruction);
template Field<double> transfer_conserved(const Octree&, const Field<double>&, const Octree&, Reconstruction);

}  // namespace burnish
