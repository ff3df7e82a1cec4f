// Finding lattice nodes in leaves: what `node_value`, `gather` and `gather_smooth` share.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>

#include "burnish/octree/field.h"

namespace burnish::detail {

inline morton::Position block_of(const LatticeNode& node) {
  return {static_cast<std::uint32_t>(node.x) / kBlockSide, static_cast<std::uint32_t>(node.y) / kBlockSide,
          static_cast<std::uint32_t>(node.z) / kBlockSide};
}

// The nearest node of the domain.
inline LatticeNode clamped(const Octree& tree, LatticeNode node) {
  const auto last = static_cast<std::int32_t>(tree.side()) * kBlockSide - 1;
  return {std::clamp(node.x, 0, last), std::clamp(node.y, 0, last), std::clamp(node.z, 0, last)};
}

// Where the copied range of one axis lies: in the halo below, in the block, in the halo above.
struct Range {
  int begin, end;
};

inline Range halo_range(int offset, int width) {
  if (offset < 0) return {-width, 0};
  if (offset > 0) return {kBlockSide, kBlockSide + width};
  return {0, kBlockSide};
}

// A node of the domain and the leaf that holds it.
struct LocatedNode {
  std::uint32_t leaf;
  std::int32_t mask;                   // the leaf's cell, in finest cells, minus 1
  std::array<std::int32_t, 3> local;   // relative to the leaf's lower corner
  bool beyond;                         // moved in from beyond a wall: no node to interpolate to on that side

  bool is_stored() const { return beyond || ((local[0] | local[1] | local[2]) & mask) == 0; }
  // The place in the leaf's block of the node itself, or of the one below.
  std::size_t place() const {
    const int l = std::popcount(static_cast<std::uint32_t>(mask));
    return node_index(local[0] >> l, local[1] >> l, local[2] >> l);
  }
};

// `near`: a leaf to start the search from.
inline LocatedNode locate(const Octree& tree, std::uint32_t near, const LatticeNode& node) {
  const LatticeNode inside = clamped(tree, node);
  const std::uint32_t leaf = tree.find_near(near, block_of(inside));
  const morton::Position c = tree.corner(leaf);
  return {leaf,
          (1 << tree.level(leaf)) - 1,
          {inside.x - static_cast<std::int32_t>(c.x) * kBlockSide, inside.y - static_cast<std::int32_t>(c.y) * kBlockSide,
           inside.z - static_cast<std::int32_t>(c.z) * kBlockSide},
          inside.x != node.x || inside.y != node.y || inside.z != node.z};
}

// `node_value` with a leaf to start the search from.
template <class T>
double node_value_near(const Octree& tree, const Field<T>& field, std::uint32_t near, const LatticeNode& node);

}  // namespace burnish::detail
