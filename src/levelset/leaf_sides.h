// On which side of the surface leaves have nodes, and which of their cells are cut into Kuhn tetrahedra: what extraction and topology
// ask before they look at single nodes.
#pragma once

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/octree/field.h"

namespace burnish::detail {

// The directions, as bits, of the leaves that hold corners of a leaf's cell, the leaf itself among them.
constexpr std::uint32_t touched_by_cell(int i, int j, int k) {
  const auto low = [](int x) { return x == 0 ? -1 : 0; };
  const auto high = [](int x) { return x == kBlockSide - 1 ? 1 : 0; };
  std::uint32_t bits = 0;
  for (int dz = low(k); dz <= high(k); ++dz)
    for (int dy = low(j); dy <= high(j); ++dy)
      for (int dx = low(i); dx <= high(i); ++dx) bits |= 1u << direction(dx, dy, dz);
  return bits;
}

struct TouchedDirections {
  std::array<std::uint32_t, kBlockNodes> by_cell{};         // by the cell above a node
  std::array<std::uint32_t, kBlockNodes> by_cells_around{};  // by any of the eight cells around a node
};

constexpr TouchedDirections touched_directions() {
  TouchedDirections touched;
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j)
      for (int i = 0; i < kBlockSide; ++i) {
        const auto below = [](int x) { return x == 0 ? 0 : x - 1; };
        touched.by_cell[node_index(i, j, k)] = touched_by_cell(i, j, k);
        for (const int x : {below(i), i})
          for (const int y : {below(j), j})
            for (const int z : {below(k), k}) touched.by_cells_around[node_index(i, j, k)] |= touched_by_cell(x, y, z);
      }
  return touched;
}
inline constexpr TouchedDirections kTouched = touched_directions();

// The directions, as bits, in which a leaf has neighbours of its own level. A cell is cut into Kuhn tetrahedra if it touches
// no others; else it is a transition cell.
inline constexpr std::uint32_t kAllSame = (1u << kDirections) - 1;
inline std::uint32_t same_level_directions(const Octree& tree, std::size_t leaf) {
  std::uint32_t bits = 0;
  for (int dir = 0; dir < kDirections; ++dir)
    if (tree.neighbor_kind(leaf, dir) == NeighborKind::same) bits |= 1u << dir;
  return bits;
}

// Bit 0: some of a leaf's nodes are inside; bit 1: some are outside.
template <class T>
std::uint8_t sides_of(const T* phi) {
  bool inside = false, outside = false;
  for (std::size_t row = 0; row < kBlockNodes && !(inside && outside); row += kBlockSide)
    for (std::size_t i = 0; i < kBlockSide; ++i) {
      inside |= phi[row + i] >= 0;
      outside |= !(phi[row + i] >= 0);
    }
  return static_cast<std::uint8_t>((inside ? 1 : 0) | (outside ? 2 : 0));
}

// The directions in which corners of a leaf's cells can lie, the leaf itself among them.
inline constexpr std::uint32_t kUpper = touched_by_cell(kBlockSide - 1, kBlockSide - 1, kBlockSide - 1);

// The sides, 1 inside and 2 outside, on which leaves have nodes, and the directions of neighbours of their level.
class LeafSides {
 public:
  template <class T>
  LeafSides(const Octree& tree, const Field<T>& phi) : tree_(tree), own_(tree.size()), same_(tree.size()) {
    parallel_for(tree.size(), [&](std::size_t leaf) {
      own_[leaf] = phi.stores(leaf) ? sides_of(phi.block(leaf)) : phi.block(leaf)[0] >= 0 ? 1 : 2;
      same_[leaf] = same_level_directions(tree, leaf);
    }, kGrain);
    read_ = own_;
    // Cells of coarser leaves are interpolated between corners that leaves beyond can hold: those come first.
    for (int level = tree.depth() - 1; level >= 0; --level)
      parallel_for(tree.size(), [&](std::size_t leaf) {
        if (tree.level(leaf) == level && same_[leaf] != kAllSame) read_[leaf] = around(leaf, kUpper);
      }, kGrain);
  }

  std::uint8_t of(std::size_t leaf) const { return own_[leaf]; }
  std::uint32_t same(std::size_t leaf) const { return same_[leaf]; }
  bool is_plain_cell(std::size_t leaf, std::size_t n) const { return !(kTouched.by_cell[n] & ~same_[leaf]); }
  // Only plain cells around.
  bool is_plain_node(std::size_t leaf, std::size_t n) const { return !(kTouched.by_cells_around[n] & ~same_[leaf]); }

  // The leaf's own sides, and of all values that are read from the leaves in some directions.
  std::uint8_t around(std::size_t leaf, std::uint32_t directions) const { return around(leaf, directions, own_[leaf]); }
  // The same with `seen` instead of the leaf's own.
  std::uint8_t around(std::size_t leaf, std::uint32_t directions, std::uint8_t seen) const {
    for (std::uint32_t rest = directions & ~(1u << kSelf); rest != 0 && seen != 3; rest &= rest - 1) {
      const int dir = std::countr_zero(rest);
      const bool coarser = tree_.neighbor_kind(leaf, dir) == NeighborKind::coarser;
      for (const std::uint32_t other : tree_.neighbors(leaf, dir)) seen |= coarser ? read_[other] : own_[other];
    }
    return seen;
  }

 private:
  static constexpr std::size_t kGrain = 256;
  const Octree& tree_;
  std::vector<std::uint8_t> own_;
  std::vector<std::uint8_t> read_;  // with what finer leaves read from its cells
  std::vector<std::uint32_t> same_;
};

}  // namespace burnish::detail
