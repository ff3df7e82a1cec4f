// The simplices at and beside transition cells that the surface cuts, one by one: several cells have the same ones, so those on a cell's
// boundary are listed by their nodes, and counted once each. What lies within a cell is counted there.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "../octree/lattice_lookup.h"
#include "transition_tetrahedra.h"

namespace burnish::detail {

// A lattice node under a number of its own: the leaf that holds it, and its place there in quarters of the leaf's cells (0 to 32 along each axis, for
// nodes beyond a wall belong to the leaf before it). Fans have nodes in the middle of cells and faces.
struct NumberedNode {
  std::uint64_t number = 0;
  std::uint32_t leaf = Octree::kNone;  // that stores it, if one does
  std::uint32_t place = 0;

  bool is_stored() const { return leaf != Octree::kNone; }
};

// Numbers nodes at and near one leaf.
class NodeNumbers {
 public:
  NodeNumbers(const Octree& tree, std::uint32_t leaf)
      : tree_(tree), leaf_(leaf), first_(lattice_node(tree, leaf, 0, 0, 0)), level_(tree.level(leaf)) {}

  NumberedNode operator()(const LatticeNode& at) const {
    const std::array<std::int32_t, 3> local{at.x - first_.x, at.y - first_.y, at.z - first_.z};
    // Most nodes are the leaf's, or of its neighbours of the same level.
    const int side = 3 + level_, dx = local[0] >> side, dy = local[1] >> side, dz = local[2] >> side;
    if (std::min({dx, dy, dz}) >= -1 && std::max({dx, dy, dz}) <= 1) {
      const int dir = direction(dx, dy, dz);
      if (dir == kSelf) return numbered(leaf_, level_, local, false);
      const std::int32_t size = kBlockSide << level_;
      if (tree_.neighbor_kind(leaf_, dir) == NeighborKind::same)
        return numbered(tree_.neighbor(leaf_, dir), level_, {local[0] - dx * size, local[1] - dy * size, local[2] - dz * size}, false);
    }
    const LocatedNode located = locate(tree_, leaf_, at);
    const LatticeNode first = lattice_node(tree_, located.leaf, 0, 0, 0);
    return numbered(located.leaf, tree_.level(located.leaf), {at.x - first.x, at.y - first.y, at.z - first.z}, located.beyond);
  }

 private:
  static NumberedNode numbered(std::uint32_t leaf, int level, const std::array<std::int32_t, 3>& local, bool beyond) {
    const auto quarters = [&](std::size_t a) { return static_cast<std::uint64_t>(local[a]) * 4 >> level; };
    NumberedNode node;
    node.number = std::uint64_t{leaf} << 18 | quarters(0) | quarters(1) << 6 | quarters(2) << 12;
    if (beyond || ((local[0] | local[1] | local[2]) & ((1 << level) - 1)) != 0) return node;
    node.leaf = leaf;
    node.place = static_cast<std::uint32_t>(node_index(local[0] >> level, local[1] >> level, local[2] >> level));
    return node;
  }

  const Octree& tree_;
  const std::uint32_t leaf_;
  const LatticeNode first_;
  const int level_;
};

// Cells see themselves as 27 slots, i + 3 j + 9 k: corners, edge middles, face centres, centre. A simplex is on the cell's boundary if all its
// slots are on one side. Bits: the sides that a slot is on.
inline constexpr std::size_t kSlots = 27;
inline constexpr auto kSidesOfSlot = [] {
  std::array<std::uint8_t, kSlots> sides{};
  for (unsigned slot = 0; slot < kSlots; ++slot) {
    unsigned bits = 0, rest = slot;
    for (unsigned axis = 0; axis < 3; ++axis, rest /= 3) bits |= rest % 3 == 0 ? 1u << axis : rest % 3 == 2 ? 8u << axis : 0u;
    sides[slot] = static_cast<std::uint8_t>(bits);
  }
  return sides;
}();

constexpr std::size_t slot_of_corner(int corner) {
  return static_cast<std::size_t>(2 * (corner & 1) + 6 * (corner >> 1 & 1) + 18 * (corner >> 2 & 1));
}

// Cut simplices on the boundaries of cells, by the numbers of their nodes in ascending order; and Euler's sum over the others.
class SimplexList {
 public:
  void add_edge(std::uint64_t a, std::uint64_t b) { edges_.push_back({std::min(a, b), std::max(a, b)}); }
  void add_triangle(std::uint64_t a, std::uint64_t b, std::uint64_t c) {
    std::array<std::uint64_t, 3> nodes{a, b, c};
    std::sort(nodes.begin(), nodes.end());
    triangles_.push_back(nodes);
  }
  void add_inner(std::int64_t euler) { inner_ += euler; }

  // Leaves each simplex once.
  void drop_copies() {
    drop_copies_of(edges_);
    drop_copies_of(triangles_);
  }
  void append(const SimplexList& other) {
    edges_.insert(edges_.end(), other.edges_.begin(), other.edges_.end());
    triangles_.insert(triangles_.end(), other.triangles_.begin(), other.triangles_.end());
    inner_ += other.inner_;
  }
  // Once there are no copies. [T-TOPO-2]
  std::int64_t euler() const { return static_cast<std::int64_t>(edges_.size()) - static_cast<std::int64_t>(triangles_.size()) + inner_; }

  template <class T>
  static void drop_copies_of(std::vector<T>& list) {
    parallel_sort(list);
    list.erase(std::unique(list.begin(), list.end()), list.end());
  }

 private:
  std::vector<std::array<std::uint64_t, 2>> edges_;
  std::vector<std::array<std::uint64_t, 3>> triangles_;
  std::int64_t inner_ = 0;
};

// One transition cell by its slots: what of its simplices is cut, and which slots edges join.
class CellSimplices {
 public:
  // Listed as they come from TransitionCell.
  void add_tetrahedron(const std::array<std::size_t, 4>& slots, const std::array<bool, 4>& inside) {
    for (std::size_t c = 0; c < 4; ++c) {
      used_ |= 1u << slots[c];
      inside_ |= static_cast<std::uint32_t>(inside[c]) << slots[c];
    }
    bool is_cut = false;
    for (std::size_t c = 1; c < 4; ++c)
      for (std::size_t b = 0; b < c; ++b) {
        const auto [low, high] = std::minmax(slots[b], slots[c]);
        std::uint32_t& edges = inside[b] == inside[c] ? joined_[low] : cut_[low];
        edges |= 1u << high;
        is_cut = is_cut || inside[b] != inside[c];
      }
    if (!is_cut) return;
    ++tetrahedra_;
    for (std::size_t left_out = 0; left_out < 4; ++left_out) add_triangle(slots, inside, left_out);
  }

  // Numbers are asked for by number(slot).
  template <class Number>
  void list(Number&& number, SimplexList& out) const {
    std::int64_t inner = tetrahedra_ - inner_triangle_uses_ / 2;
    for (std::size_t low = 0; low < kSlots; ++low)
      for (std::uint32_t rest = cut_[low]; rest != 0; rest &= rest - 1) {
        const auto high = static_cast<std::size_t>(std::countr_zero(rest));
        if (kSidesOfSlot[low] & kSidesOfSlot[high]) out.add_edge(number(low), number(high));
        else ++inner;
      }
    for (std::size_t t = 0; t < triangle_count_; ++t) out.add_triangle(number(triangles_[t][0]), number(triangles_[t][1]), number(triangles_[t][2]));
    out.add_inner(inner);
  }

  std::uint32_t used() const { return used_; }
  bool is_inside(std::size_t slot) const { return inside_ >> slot & 1; }
  // The slots joined to this one by edges, itself among them.
  std::uint32_t joined_to(std::size_t slot) const {
    std::uint32_t all = 1u << slot;
    for (std::uint32_t before = 0; before != all;) {
      before = all;
      for (std::size_t low = 0; low < kSlots; ++low)
        if (joined_[low] != 0 && ((all >> low & 1) || (all & joined_[low]))) all |= joined_[low] | 1u << low;
    }
    return all;
  }

 private:
  void add_triangle(const std::array<std::size_t, 4>& slots, const std::array<bool, 4>& inside, std::size_t left_out) {
    std::array<std::uint8_t, 3> corners{};
    unsigned sides = 0x3f, in = 0;
    for (std::size_t c = 0, n = 0; c < 4; ++c) {
      if (c == left_out) continue;
      corners[n++] = static_cast<std::uint8_t>(slots[c]);
      sides &= kSidesOfSlot[slots[c]];
      in += inside[c];
    }
    if (in == 0 || in == 3) return;
    if (sides != 0) triangles_[triangle_count_++] = corners;
    else ++inner_triangle_uses_;  // by the two tetrahedra at it
  }

  std::uint32_t used_ = 0, inside_ = 0;
  std::array<std::uint32_t, kSlots> cut_{}, joined_{};       // edges: the higher slots, by the lower one
  std::array<std::array<std::uint8_t, 3>, 48> triangles_{};  // on the boundary, eight a face at most
  std::size_t triangle_count_ = 0;
  std::int64_t tetrahedra_ = 0, inner_triangle_uses_ = 0;
};

}  // namespace burnish::detail
