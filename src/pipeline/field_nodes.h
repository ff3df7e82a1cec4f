// Finding the leaf's node at or below a lattice point.
#pragma once

#include "burnish/octree/field.h"

namespace burnish {

// The node at or below `at` along each axis, of the leaf that holds it; kNone outside the domain. Fast in or beside the leaf `near`.
inline StoredNode node_at_or_below(const Octree& tree, const LatticeNode& at, std::uint32_t near) {
  const auto side = static_cast<std::int64_t>(tree.side()) * kBlockSide;
  for (const std::int32_t c : {at.x, at.y, at.z})
    if (c < 0 || c >= side) return {};
  const auto block = [](std::int32_t c) { return static_cast<std::uint32_t>(c) / kBlockSide; };
  const std::uint32_t leaf = tree.find_near(near, {block(at.x), block(at.y), block(at.z)});
  const LatticeNode corner = lattice_node(tree, leaf, 0, 0, 0);
  const int level = tree.level(leaf);
  return {leaf, static_cast<std::uint32_t>(node_index((at.x - corner.x) >> level, (at.y - corner.y) >> level, (at.z - corner.z) >> level))};
}

}  // namespace burnish
