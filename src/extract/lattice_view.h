// What the extraction sees of the lattice around one leaf: values, sides, moved nodes, crossings.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "burnish/core/vec.h"
#include "burnish/octree/field.h"
#include "tetrahedra.h"

namespace burnish::detail {

// How a node was moved: the number of the incident Kuhn edge whose crossing it went to. 0..6 upwards along
// kEdgeSteps, 7..13 downwards; kStays: not at all.
using Move = std::uint8_t;
inline constexpr Move kStays = 255;

struct LocalNode {
  int x, y, z;
  friend constexpr LocalNode operator+(LocalNode n, Step s) { return {n.x + s.x, n.y + s.y, n.z + s.z}; }
  friend constexpr LocalNode operator-(LocalNode n, Step s) { return {n.x - s.x, n.y - s.y, n.z - s.z}; }
};

// Nodes -2..9 of one leaf along each axis; positions in cells of the leaf, relative to its corner.
class LatticeView {
 public:
  static constexpr int kWidth = 2;
  static constexpr int kSide = kBlockSide + 2 * kWidth;
  static constexpr std::size_t kNodes = std::size_t{kSide} * kSide * kSide;
  static constexpr double kLeastShare = 0.02;  // crossings keep this part of their edge from its ends

  static constexpr std::size_t at(LocalNode n) {
    return static_cast<std::size_t>((n.x + kWidth) + kSide * ((n.y + kWidth) + kSide * (n.z + kWidth)));
  }

  std::array<double, kNodes> phi;
  std::array<Move, kNodes> move;
  std::array<std::uint8_t, kNodes> plain;

  Side sign(LocalNode n) const { return phi[at(n)] >= 0 ? kIn : kOut; }
  Side side(LocalNode n) const { return move[at(n)] != kStays ? kOn : sign(n); }

  // Where along edge `direction` from its lower node the zero lies, in [0, 1].
  double crossing(LocalNode low, int direction) const {
    const LocalNode high = low + kEdgeSteps[static_cast<std::size_t>(direction)];
    if (plain[at(low)] || plain[at(high)]) return 0.5;
    const double p = phi[at(low)], q = phi[at(high)];
    return p / (p - q);
  }
  Vec3 edge_point(LocalNode low, int direction, double t) const {
    const Step s = kEdgeSteps[static_cast<std::size_t>(direction)];
    return {low.x + t * s.x, low.y + t * s.y, low.z + t * s.z};
  }
  // The same for an edge between nodes that stay, kept away from its ends.
  double kept_crossing(LocalNode low, int direction) const {
    return std::clamp(crossing(low, direction), kLeastShare, 1 - kLeastShare);
  }
  // Where a node is, moved or not.
  Vec3 position(LocalNode n) const {
    const Move m = move[at(n)];
    if (m == kStays) return {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)};
    const int direction = m % 7;
    const LocalNode low = m < 7 ? n : n - kEdgeSteps[static_cast<std::size_t>(direction)];
    return edge_point(low, direction, crossing(low, direction));
  }
};

}  // namespace burnish::detail
