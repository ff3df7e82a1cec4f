// Level sets made node by node, for the tests of what works on them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/levelset/level_set.h"

namespace burnish::test {

inline Vec3 to_vec(const LatticeNode& n) {
  return {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
}

// The finest blocks of a domain, all of them: Octree::build of these is uniform.
inline std::vector<std::uint64_t> all_blocks(int depth) {
  std::vector<std::uint64_t> blocks;
  for (std::uint64_t m = 0; m < std::uint64_t{1} << (3 * depth); ++m) blocks.push_back(m);
  return blocks;
}

// A level set with phi = value(lattice node) at every node that a leaf stores; all leaves count as near the surface.
template <class T = double, class Value>
BasicLevelSet<T> level_set_of(Octree tree, Value&& value) {
  BasicLevelSet<T> set;
  set.frame.depth = tree.depth();
  set.phi = Field<T>(tree.size(), 0);
  set.grid.first_facet.resize(tree.size() + 1);
  for (std::size_t leaf = 0; leaf <= tree.size(); ++leaf) set.grid.first_facet[leaf] = leaf;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i)
          set.phi.block(leaf)[node_index(i, j, k)] = static_cast<T>(value(lattice_node(tree, leaf, i, j, k)));
  set.grid.octree = std::move(tree);
  return set;
}

// Makes the nodes on the domain's walls outside, so that the surface ends nowhere.
template <class T>
BasicLevelSet<T> closed_at_walls(BasicLevelSet<T> set) {
  const Octree& tree = set.octree();
  const int side = static_cast<int>(tree.side()) * kBlockSide;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i) {
          const LatticeNode n = lattice_node(tree, leaf, i, j, k);
          const int cell = 1 << tree.level(leaf);
          for (const int x : {n.x, n.y, n.z})
            if (x == 0 || x + cell == side) set.phi.block(leaf)[node_index(i, j, k)] = -1;
        }
  return set;
}

}  // namespace burnish::test
