// Cutting one tetrahedron, and the Kuhn subdivision of a cube.
#pragma once

#include <array>
#include <cstdint>

#include "../levelset/transition_tetrahedra.h"

namespace burnish::detail {

// A node's side of the surface. A moved node lies on it.
using Side = std::int8_t;
inline constexpr Side kIn = 1, kOn = 0, kOut = -1;

struct Step {
  int x, y, z;
};

// The seven edges of the Kuhn subdivision that leave a node upwards; bit b of a corner number is axis b.
inline constexpr std::array<Step, 7> kEdgeSteps{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 0}, {1, 0, 1}, {0, 1, 1}, {1, 1, 1}}};

// Edge number of the step from corner a to corner b of a cube, a a subset of b.
constexpr int edge_number(int a, int b) {
  constexpr std::array<int, 8> kByMask{-1, 0, 1, 3, 2, 4, 5, 6};
  return kByMask[static_cast<std::size_t>(a ^ b)];
}

// The six tetrahedra 0 -> unit(i) -> unit(i) + unit(j) -> 7, corners numbered x + 2 y + 4 z, positively oriented
// with (v1 - v0, v2 - v0, v3 - v0) a right-handed frame. `path` is the order along the diagonal. [T-MT-1]
struct KuhnTetrahedron {
  std::array<int, 4> corners;  // positively oriented
  std::array<int, 4> path;     // 0 = path[0] < ... < path[3] = 7
};
inline constexpr std::array<KuhnTetrahedron, 6> kKuhn{{
    {{0, 1, 3, 7}, kKuhnPaths[0]},
    {{0, 5, 1, 7}, kKuhnPaths[1]},
    {{0, 3, 2, 7}, kKuhnPaths[2]},
    {{0, 2, 6, 7}, kKuhnPaths[3]},
    {{0, 4, 5, 7}, kKuhnPaths[4]},
    {{0, 6, 4, 7}, kKuhnPaths[5]},
}};

constexpr Step negative(Step s) { return {-s.x, -s.y, -s.z}; }
constexpr Step minus(Step a, Step b) { return {a.x - b.x, a.y - b.y, a.z - b.z}; }

// The 14 nodes that share an edge with a node: k < 7 upwards along kEdgeSteps, then downwards.
inline constexpr int kNeighbors = 14;
constexpr Step neighbor_step(int k) {
  return k < 7 ? kEdgeSteps[static_cast<std::size_t>(k)] : negative(kEdgeSteps[static_cast<std::size_t>(k - 7)]);
}

constexpr int neighbor_number(Step s) {
  for (int k = 0; k < kNeighbors; ++k) {
    const Step t = neighbor_step(k);
    if (t.x == s.x && t.y == s.y && t.z == s.z) return k;
  }
  return -1;
}

// One of the 24 tetrahedra around a node: its corners by neighbour number, positively oriented, -1 the node itself.
using StarTetrahedron = std::array<int, 4>;

constexpr std::array<StarTetrahedron, 24> make_star() {
  std::array<StarTetrahedron, 24> star{};
  std::size_t n = 0;
  for (const KuhnTetrahedron& t : kKuhn)
    for (int self = 0; self < 4; ++self) {
      const auto corner = [&](int i) {
        const int c = t.corners[static_cast<std::size_t>(i)];
        return Step{c & 1, c >> 1 & 1, c >> 2 & 1};
      };
      for (int i = 0; i < 4; ++i)
        star[n][static_cast<std::size_t>(i)] = i == self ? -1 : neighbor_number(minus(corner(i), corner(self)));
      ++n;
    }
  return star;
}

inline constexpr auto kStar = make_star();

// The other corners of vertex i's tetrahedron, so that (i, others...) is an even permutation of 0..3.
inline constexpr std::array<std::array<int, 3>, 4> kEven{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

// Cuts a positively oriented tetrahedron whose corners are on the given sides. [T-MT-2]
//
// vertex(i, j): the surface vertex between corners i and j, which is the corner itself where one of the two is on the
// surface. opposite_out(i): for a tetrahedron with the three corners other than i on the surface and i inside,
// whether its neighbour across that face is outside. shorter(p, q, r, s): true to cut the quadrilateral p, q, r, s
// along p-r, false along q-s. emit(a, b, c): a facet, seen counter-clockwise from outside.
template <class Vertex, class OppositeOut, class Shorter, class Emit>
void cut_tetrahedron(const std::array<Side, 4>& side, Vertex&& vertex, OppositeOut&& opposite_out, Shorter&& shorter,
                     Emit&& emit) {
  int in = 0, out = 0, last_in = 0, last_out = 0;
  for (int i = 0; i < 4; ++i) {
    if (side[static_cast<std::size_t>(i)] == kIn) ++in, last_in = i;
    if (side[static_cast<std::size_t>(i)] == kOut) ++out, last_out = i;
  }
  if (in == 0) return;
  if (out == 0 && !(in == 1 && opposite_out(last_in))) return;
  if (in == 1) {
    const auto& o = kEven[static_cast<std::size_t>(last_in)];
    emit(vertex(last_in, o[0]), vertex(last_in, o[1]), vertex(last_in, o[2]));
  } else if (out == 1) {
    const auto& o = kEven[static_cast<std::size_t>(last_out)];
    emit(vertex(last_out, o[0]), vertex(last_out, o[2]), vertex(last_out, o[1]));
  } else {
    int i = 0;
    while (side[static_cast<std::size_t>(i)] != kIn) ++i;
    const auto& o = kEven[static_cast<std::size_t>(i)];
    // Rotate the other three so that the second inside corner comes first: still even.
    int r = 0;
    while (side[static_cast<std::size_t>(o[static_cast<std::size_t>(r)])] != kIn) ++r;
    const int j = o[static_cast<std::size_t>(r)], k = o[static_cast<std::size_t>((r + 1) % 3)],
              l = o[static_cast<std::size_t>((r + 2) % 3)];
    const auto p = vertex(i, k), q = vertex(i, l), s = vertex(j, l), t = vertex(j, k);
    if (shorter(p, q, s, t)) {
      emit(p, q, s);
      emit(p, s, t);
    } else {
      emit(p, q, t);
      emit(q, s, t);
    }
  }
}

}  // namespace burnish::detail
