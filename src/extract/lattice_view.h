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

// Copies a leaf's block and the two layers around it that neighbours of its level hold; `outside` elsewhere. No other nodes
// belong to cells that are cut into Kuhn tetrahedra.
template <class T, class U>
void copy_same_level(const Octree& tree, const Field<T>& field, std::size_t leaf, U outside, U* dense) {
  if (field.empty()) return void(std::fill_n(dense, LatticeView::kNodes, outside));
  static constexpr int w = LatticeView::kWidth;
  for (int dir = 0; dir < kDirections; ++dir) {
    const auto [dx, dy, dz] = offset_of(dir);
    const auto begin = [](int d) { return d < 0 ? -w : d > 0 ? kBlockSide : 0; };
    const auto length = [](int d) { return d == 0 ? kBlockSide : w; };
    const bool same = tree.neighbor_kind(leaf, dir) == NeighborKind::same;
    const T* source = same ? field.block(tree.neighbor(leaf, dir)) : nullptr;
    const int x = begin(dx) - kBlockSide * dx;
    for (int k = begin(dz); k < begin(dz) + length(dz); ++k)
      for (int j = begin(dy); j < begin(dy) + length(dy); ++j) {
        U* row = dense + LatticeView::at({begin(dx), j, k});
        if (!same) {
          std::fill_n(row, length(dx), outside);
          continue;
        }
        const T* from = source + node_index(x, j - kBlockSide * dy, k - kBlockSide * dz);
        if (dx == 0) std::copy_n(from, kBlockSide, row);
        else std::copy_n(from, w, row);
      }
  }
}

// The sides of a view's nodes as bits: bit x + 2 of row (y, z). Nodes on the surface, and those that the view knows nothing of, are on neither.
class SideRows {
 public:
  SideRows() = default;
  SideRows(const LatticeView& view, std::uint32_t same) {
    for (int z = -1; z < kRows - 1; ++z)
      for (int y = -1; y < kRows - 1; ++y) {
        const std::size_t first = LatticeView::at({-LatticeView::kWidth, y, z});
        unsigned in = 0, stays = 0;
        for (std::size_t i = 0; i < LatticeView::kSide; ++i) {
          in |= static_cast<unsigned>(view.phi[first + i] >= 0) << i;
          stays |= static_cast<unsigned>(view.move[first + i] == kStays) << i;
        }
        const unsigned known = stays & known_in_row(same, y, z);
        in_[row(y, z)] = static_cast<std::uint16_t>(in & known);
        out_[row(y, z)] = static_cast<std::uint16_t>(~in & known);
      }
  }

  // The side of a node that the view knows.
  Side side(LocalNode n) const {
    const std::size_t r = row(n.y, n.z);
    const int bit = n.x + LatticeView::kWidth;
    return in_[r] >> bit & 1 ? kIn : out_[r] >> bit & 1 ? kOut : kOn;
  }
  // Bit x: node (x, y, z) has a neighbour on the other side.
  unsigned beside_surface(int y, int z) const {
    const unsigned in = in_[row(y, z)], out = out_[row(y, z)];
    return own((in & neighbors(out_, y, z)) | (out & neighbors(in_, y, z)));
  }
  // Bit x: the edge from node (x, y, z) in a direction upwards is crossed.
  unsigned crossed(int y, int z, Step s) const {
    const std::size_t to = row(y + s.y, z + s.z);
    return own((in_[row(y, z)] & (out_[to] >> s.x)) | (out_[row(y, z)] & (in_[to] >> s.x)));
  }
  // Bit x: the corners of cell (x, y, z) are not all strictly on one side.
  unsigned cut_cells(int y, int z) const {
    unsigned in = ~0u, out = ~0u;
    for (int c = 0; c < 4; ++c) {
      const std::size_t r = row(y + (c & 1), z + (c >> 1));
      in &= in_[r] & (in_[r] >> 1);
      out &= out_[r] & (out_[r] >> 1);
    }
    return own(~(in | out));
  }

 private:
  static constexpr int kRows = kBlockSide + 3;  // -1 to 9, as far as the apex of a tetrahedron beside a cell of the leaf
  using Rows = std::array<std::uint16_t, std::size_t{kRows} * kRows>;
  static constexpr std::size_t row(int y, int z) { return static_cast<std::size_t>((y + 1) + kRows * (z + 1)); }
  static unsigned own(unsigned bits) { return bits >> LatticeView::kWidth & 0xffu; }
  static unsigned known_in_row(std::uint32_t same, int y, int z) {
    const auto beyond = [](int i) { return i < 0 ? -1 : i >= kBlockSide ? 1 : 0; };
    const unsigned kinds = same >> direction(-1, beyond(y), beyond(z)) & 7u;
    return (kinds & 1 ? 0x003u : 0u) | (kinds & 2 ? 0x3fcu : 0u) | (kinds & 4 ? 0xc00u : 0u);
  }
  static unsigned neighbors(const Rows& rows, int y, int z) {
    const auto up = [&](int dy, int dz) { const unsigned r = rows[row(y + dy, z + dz)]; return r | r >> 1; };
    const auto down = [&](int dy, int dz) { const unsigned r = rows[row(y - dy, z - dz)]; return r | r << 1; };
    return up(0, 0) | down(0, 0) | up(1, 0) | down(1, 0) | up(0, 1) | down(0, 1) | up(1, 1) | down(1, 1);
  }

  Rows in_, out_;
};

}  // namespace burnish::detail
