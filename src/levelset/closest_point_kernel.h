// The inner loops of redistancing by closest points, in a unit of their own that is compiled for several processors: a block's
// nodes and their closest points, all in cells of the block. The same bits on every processor.
#pragma once

#include <array>
#include <cstdint>
#include <limits>

#include "burnish/octree/field.h"

namespace burnish::detail {

// A bit per node: bit i of byte j + 8 k.
using BlockBits = std::array<std::uint8_t, kBlockSide * kBlockSide>;

inline constexpr double kSeedReach = 1.9;    // cells from a node beside the surface to its closest point; the diagonal is 1.73
inline constexpr int kSeedHalo = 4;          // layers of phi that `seed` needs
inline constexpr double kRefineReach = 6;    // cells: what `refine` can do with the widest halo
inline constexpr int kWidestHalo = 8;

// For each node of a block the way to its closest point so far.
template <class T>
struct alignas(64) ClosestPoints {
  std::array<T, kBlockNodes> x, y, z;
  std::array<T, kBlockNodes> bound;  // another point is better if its squared distance is below this; infinite: there is none yet
};

// phi in a block and `width` layers around it, x fastest, as `gather` leaves it.
template <class T>
struct Surroundings {
  const T* phi;
  int width;
};

// Whether some node of the block has a corner of its cells on the other side. Needs one layer.
template <class T>
BlockBits beside_surface(const Surroundings<T>& around);

// Closest points of the nodes `beside` the surface, by Newton's method on the tricubic interpolant, or at kinks by the crossings of
// edges. [T-REDIST-1, T-REDIST-2] Nodes that Newton's method settled become `exact`.
template <class T>
void seed(const Surroundings<T>& around, const BlockBits& beside, ClosestPoints<T>& points, BlockBits& exact);

// Newton's method for nodes within `reach` (<= kRefineReach) that have a closest point and are not exact, from that point. Its halo:
// reach + 3 layers, at most kWidestHalo. Points in an octant, numbered as directions, whose bit is not in `octants` stay as they are. [T-REDIST-4]
template <class T>
void refine(const Surroundings<T>& around, double reach, std::uint32_t octants, ClosestPoints<T>& points, BlockBits& exact);

// What a block shows its neighbours: the closest points of the nodes that have come within the front's radius, x infinite elsewhere.
template <class T>
struct alignas(64) PublishedPoints {
  std::array<T, kBlockNodes> x, y, z;
  BlockBits nodes;
};

// Moves the `open` nodes whose bound is at most radius^2 to `out`. Returns the least bound of what stays open.
template <class T>
T publish(const ClosestPoints<T>& points, double radius, BlockBits& open, PublishedPoints<T>& out);

// Published points of a block and one layer around it; node (i, j, k) stands at (i + 1, j + 1, k + 1).
inline constexpr int kFrontSide = kBlockSide + 2;
template <class T>
struct FrontPoints {
  std::array<T, std::size_t{kFrontSide} * kFrontSide * kFrontSide> x, y, z;
  std::array<bool, std::size_t{kFrontSide} * kFrontSide> row;  // of y and z: whether it holds a point

  static std::size_t row_index(int j, int k) { return static_cast<std::size_t>((j + 1) + kFrontSide * (k + 1)); }
  static std::size_t index(int i, int j, int k) { return static_cast<std::size_t>(i + 1) + kFrontSide * row_index(j, k); }
  void clear() {
    x.fill(std::numeric_limits<T>::infinity());
    row.fill(false);
  }
};

// Gives every node the best of its 26 neighbours' published points, if it is better than its own; such nodes become open.
// Returns the least new bound, or infinity. [T-REDIST-3]
template <class T>
T spread(const FrontPoints<T>& front, ClosestPoints<T>& points, BlockBits& open, BlockBits& exact);

}  // namespace burnish::detail
