// Fields on the octree: 8 x 8 x 8 node values per leaf, and how a kernel sees beyond its block.
//
// **Nodes.** A leaf's values sit at the lower corners of its 8^3 cells; the upper corners belong to the
// neighbours. The *lattice* numbers nodes in units of the finest cell: leaf node (i, j, k) of a leaf of
// level l with lower corner c (in blocks) is lattice node 8 c + 2^l (i, j, k).
//
// **Halo.** Kernels copy a block and W layers around it into a dense array and run there. A halo node that
// some leaf stores is copied (same level) or injected (finer: nodes coincide); one that no leaf stores,
// because its leaf is coarser, is interpolated trilinearly from the coarse cell's corners: second order.
// Every reader gets the bitwise same value for the same lattice node, from one function, `node_value`.
// Beyond the domain's walls the nearest stored node's value continues.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/octree/octree.h"

namespace burnish {

inline constexpr int kBlockSide = 8;
inline constexpr std::size_t kBlockNodes = 512;

// A lattice node: integer coordinates in units of the finest cell.
struct LatticeNode {
  std::int32_t x = 0, y = 0, z = 0;
};

constexpr std::size_t node_index(int i, int j, int k) {
  return static_cast<std::size_t>(i + kBlockSide * (j + kBlockSide * k));
}

// The lattice node of a leaf's node (i, j, k), which may lie outside 0..7 (in the halo).
inline LatticeNode lattice_node(const Octree& tree, std::size_t leaf, int i, int j, int k) {
  const morton::Position c = tree.corner(leaf);
  const int l = tree.level(leaf);
  return {static_cast<std::int32_t>(c.x) * kBlockSide + i * (1 << l),
          static_cast<std::int32_t>(c.y) * kBlockSide + j * (1 << l),
          static_cast<std::int32_t>(c.z) * kBlockSide + k * (1 << l)};
}

// Values at the nodes of all leaves; leaf b's are [512 b, 512 (b + 1)), x fastest.
template <class T>
struct Field {
  std::vector<T> values;

  Field() = default;
  Field(std::size_t leaves, T value) : values(leaves * kBlockNodes, value) {}

  T* block(std::size_t leaf) { return values.data() + leaf * kBlockNodes; }
  const T* block(std::size_t leaf) const { return values.data() + leaf * kBlockNodes; }
};

// The value at any lattice node of the domain, as described above. T is float or double.
template <class T>
double node_value(const Octree& tree, const Field<T>& field, LatticeNode node);

// Trilinear interpolation at a point in lattice units, between the nodes of the leaf that holds it.
// Second order where the field is smooth, across level jumps too.
template <class T>
double sample(const Octree& tree, const Field<T>& field, double x, double y, double z);

// Copies a leaf's block and `width` (1 to 4) layers around it to `dense`, (8 + 2 width)^3 values, x fastest,
// so that node (i, j, k) stands at (i + width, j + width, k + width).
template <class T>
void gather(const Octree& tree, const Field<T>& field, std::size_t leaf, int width, T* dense);

}  // namespace burnish
