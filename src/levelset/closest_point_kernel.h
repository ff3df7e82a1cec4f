// The inner loops of redistancing by closest points, in a unit of their own that is compiled for several processors: a block's
// nodes and their closest points, all in cells of the block. The same bits on every processor.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>
#include <limits>

#include "burnish/core/vec.h"
#include "burnish/octree/field.h"
#include "node_bits.h"

namespace burnish::detail {

inline constexpr double kSeedReach = 1.9;    // cells from a node beside the surface to its closest point; the diagonal is 1.73
inline constexpr int kSeedHalo = 4;          // layers of phi that `seed` needs
inline constexpr double kRefineReach = 5;    // cells: what `refine` can do with the widest halo
inline constexpr int kWidestHalo = 8;

// For each node of a block the way to its closest point so far.
template <class T>
struct alignas(64) ClosestPoints {
  std::array<T, kBlockNodes> x, y, z;
  std::array<T, kBlockNodes> bound;  // another point is better if its squared distance is below this; infinite: there is none yet
};

// phi in a block and `width` layers around it, x fastest, as `gather` leaves it, and kPadding numbers more that may be read and do not matter.
inline constexpr std::size_t kPadding = 2;
template <class T>
struct Surroundings {
  const T* phi;
  int width;
};

// Whether some node of the block has a corner of its cells on the other side. Needs one layer.
template <class T>
NodeBits beside_surface(const Surroundings<T>& around);

// Closest points of the nodes `beside` the surface, by Newton's method on the tricubic interpolant, or at kinks by the crossings of
// edges. [T-REDIST-1, T-REDIST-2] Nodes that Newton's method settled become `exact`.
template <class T>
void seed(const Surroundings<T>& around, const NodeBits& beside, ClosestPoints<T>& points, NodeBits& exact);

// Newton's method for nodes within `reach` (<= kRefineReach) that have a closest point and are not exact, from that point. Its halo:
// reach + 3 layers, at most kWidestHalo. Points in an octant, numbered as directions, whose bit is not in `octants` stay as they are. [T-REDIST-4]
template <class T>
void refine(const Surroundings<T>& around, double reach, std::uint32_t octants, ClosestPoints<T>& points, NodeBits& exact);

// The same for one node anywhere whose closest point lies in the block: for feet in leaves finer than the node's.
struct DistantNode {
  Vec3 at, offset;  // in cells of the block
  double sign;      // of phi at the node
  bool refined = false;
};
template <class T>
void refine(const Surroundings<T>& around, DistantNode& node);

// What a block shows its neighbours: the closest points of the nodes that have come within the front's radius, x infinite elsewhere.
template <class T>
struct alignas(64) PublishedPoints {
  std::array<T, kBlockNodes> x, y, z;
  NodeBits nodes;
};

// The closest point of a node, whose squared length in T decides which is nearer. Exact ones give way to those that are clearly nearer only.
template <class T>
void put(ClosestPoints<T>& points, std::size_t node, const Vec3& offset, bool is_exact) {
  constexpr double kExact = 0.9;  // rounding alone moves no other node either
  points.x[node] = static_cast<T>(offset.x);
  points.y[node] = static_cast<T>(offset.y);
  points.z[node] = static_cast<T>(offset.z);
  points.bound[node] = static_cast<T>(squared_norm(offset) * (is_exact ? kExact : 1 - 8. * std::numeric_limits<T>::epsilon()));
}

// Moves the `open` nodes whose bound is at most radius^2 to `out`. Returns the least bound of what stays open.
template <class T>
T publish(const ClosestPoints<T>& points, double radius, NodeBits& open, PublishedPoints<T>& out);

// Published points of a block and one layer around it; node (i, j, k) stands at (i + 1, j + 1, k + 1). x is infinite where there is none.
inline constexpr int kFrontSide = kBlockSide + 2;
template <class T>
class FrontPoints {
 public:
  std::array<T, std::size_t{kFrontSide} * kFrontSide * kFrontSide> x, y, z;

  FrontPoints() {
    x.fill(std::numeric_limits<T>::infinity());
    y.fill(0);
    z.fill(0);
  }
  static std::size_t index(int i, int j, int k) { return static_cast<std::size_t>((i + 1) + kFrontSide * ((j + 1) + kFrontSide * (k + 1))); }

  // Row (j, k) holds a point.
  void note(int j, int k) { rows_[static_cast<std::size_t>(k + 1)] |= static_cast<std::uint16_t>(1u << (j + 1)); }
  // Of rows j - 1, j, j + 1 of plane k: a bit for each that does.
  unsigned rows_around(int j, int k) const { return rows_[static_cast<std::size_t>(k + 1)] >> j & 7u; }
  bool empty() const { return rows_ == decltype(rows_){}; }
  void clear() {
    for (int k = -1; k <= kBlockSide; ++k)
      for (int j = -1; j <= kBlockSide; ++j)
        if ((rows_[static_cast<std::size_t>(k + 1)] >> (j + 1) & 1) != 0) std::fill_n(&x[index(-1, j, k)], kFrontSide, std::numeric_limits<T>::infinity());
    rows_ = {};
  }

 private:
  std::array<std::uint16_t, kFrontSide> rows_{};
};

// Gives every node the best of its 26 neighbours' published points, if it is better than its own; such nodes become open. Nodes
// whose bound is at most settled^2 keep theirs. Returns the least new bound, or infinity. [T-REDIST-3]
template <class T>
T spread(const FrontPoints<T>& front, double settled, ClosestPoints<T>& points, NodeBits& open, NodeBits& exact);

}  // namespace burnish::detail
