// Fields on the octree: 8 x 8 x 8 node values per leaf, and how a kernel sees beyond its block.
//
// **Nodes.** A leaf's values sit at the lower corners of its 8^3 cells; the upper corners belong to the
// neighbours. The *lattice* numbers nodes in units of the finest cell: leaf node (i, j, k) of a leaf of
// level l with lower corner c (in blocks) is lattice node 8 c + 2^l (i, j, k).
//
// **Halo.** Kernels copy a block and W layers around it into a dense array and run there. A halo node that
// some leaf stores is copied (same level) or injected (finer: nodes coincide); one that no leaf stores,
// because its leaf is coarser, is interpolated trilinearly from the coarse cell's corners: second order (`gather_smooth`: of higher order).
// Every reader gets the bitwise same value for the same lattice node, from one function, `node_value`.
// Beyond the domain's walls the nearest stored node's value continues.
#pragma once

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "burnish/core/large_array.h"
#include "burnish/core/parallel.h"
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

// Which leaves store values of their own: a leaf's block among those that a field stores. The first two blocks are *uniform*:
// one value at all nodes, shared by the leaves that store nothing, as those far from the surface. An empty layout is one
// in which every leaf stores its own block.
using FieldLayout = std::vector<std::uint32_t>;
inline constexpr std::uint32_t kUniformBlocks = 2;

// The layout in which the leaves with stores(leaf) have blocks, in order, and all others are uniform, of the first kind.
template <class Stores>
FieldLayout layout_of(std::size_t leaves, Stores&& stores) {
  FieldLayout layout(leaves, 0);
  std::uint32_t next = kUniformBlocks;
  for (std::size_t leaf = 0; leaf < leaves; ++leaf)
    if (stores(leaf)) layout[leaf] = next++;
  return layout;
}

// Values at the nodes of all leaves: block(leaf)[0 ... 511], x fastest.
template <class T>
class Field {
 public:
  Field() = default;
  // Every leaf stores its own values.
  Field(std::size_t leaves, T value) { fill(leaves, value); }
  // Only some do. The uniform blocks hold `value`, as all blocks do at first, and `second`.
  Field(FieldLayout layout, T value, T second) : layout_(std::move(layout)) {
    if (layout_.empty()) return;
    fill(blocks_of(layout_), value);
    std::fill_n(values_.begin() + kBlockNodes, kBlockNodes, second);
  }
  // In the layout of another field.
  template <class U>
  static Field like(const Field<U>& other, T value, T second) {
    return other.layout().empty() ? Field(other.values().size() / kBlockNodes, value) : Field(other.layout(), value, second);
  }

  bool empty() const { return values_.empty(); }
  // Whether the leaf has values of its own, which may be changed one by one.
  bool stores(std::size_t leaf) const { return layout_.empty() || layout_[leaf] >= kUniformBlocks; }
  // The 512 values of a leaf; to be written only if it stores them.
  T* block(std::size_t leaf) { return values_.data() + place(leaf) * kBlockNodes; }
  const T* block(std::size_t leaf) const { return values_.data() + place(leaf) * kBlockNodes; }
  // Gives a leaf that stores nothing the second uniform value, or the first.
  void set_uniform(std::size_t leaf, bool second) { layout_[leaf] = second; }
  // Makes every leaf store its own values.
  void make_dense(std::size_t leaves) {
    if (layout_.empty()) return;
    Field dense(leaves, T{});
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) std::copy_n(std::as_const(*this).block(leaf), kBlockNodes, dense.block(leaf));
    *this = std::move(dense);
  }

  // All values that are stored, those of uniform blocks included; for operations that treat all nodes alike.
  LargeArray<T>& values() { return values_; }
  const LargeArray<T>& values() const { return values_; }
  const FieldLayout& layout() const { return layout_; }
  std::size_t bytes() const { return values_.capacity() * sizeof(T) + layout_.capacity() * sizeof(std::uint32_t); }

 private:
  static std::size_t blocks_of(const FieldLayout& layout) {
    return std::max<std::size_t>(kUniformBlocks, *std::max_element(layout.begin(), layout.end()) + std::size_t{1});
  }
  std::size_t place(std::size_t leaf) const { return layout_.empty() ? leaf : layout_[leaf]; }
  void fill(std::size_t blocks, T value) {
    values_.resize(blocks * kBlockNodes);
    parallel_ranges(values_.size(), std::size_t{1} << 16, [&](std::size_t begin, std::size_t end) {
      std::fill(values_.data() + begin, values_.data() + end, value);
    });
  }

  FieldLayout layout_;
  LargeArray<T> values_;
};

// A node by the leaf that stores it, and its place there.
struct StoredNode {
  std::uint32_t leaf = Octree::kNone;  // kNone: no leaf stores it
  std::uint32_t node = 0;
};

// The next node upwards along an axis, a cell of the leaf away; none at a wall, and where a coarser neighbour has no node there.
StoredNode next_node(const Octree& tree, std::size_t leaf, std::size_t node, int axis);

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

// How nodes of coarser leaves are interpolated for a halo: by the tensor product of Lagrange polynomials through this many of
// the coarse nodes along each axis. With h the finer cell, cubic is off by about 0.4 h^4 and quintic by 0.3 h^6 times the derivative of that order, so that
// second differences across a level jump are of second and of fourth order. Quintic looks three coarse cells far.
enum class HaloOrder { cubic = 4, quintic = 6 };

// `gather` for kernels of high order: halo nodes that no leaf stores are interpolated as above from the coarse lattice, which itself
// is copied, injected or interpolated. [T-HALO-2] Nodes inside leaves that store nothing have the uniform value.
template <class T>
void gather_smooth(const Octree& tree, const Field<T>& field, std::size_t leaf, int width, HaloOrder order, T* dense);

}  // namespace burnish
