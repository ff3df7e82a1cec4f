#include "snap.h"

#include <algorithm>

namespace burnish::detail {
namespace {

constexpr double kLeastVolume = 0.04;  // of a moved tetrahedron, as part of an unmoved one's

// How far a node was moved, squared. From the values alone, so that every leaf that sees the node gets the same bits:
// whether a node or its neighbour moved farther must be the same question from both sides.
double squared_move(const LatticeView& view, LocalNode n) {
  const Move m = view.move[LatticeView::at(n)];
  if (m == kStays) return 0;
  const Step s = kEdgeSteps[static_cast<std::size_t>(m % 7)];
  const double share = m < 7 ? view.crossing(n, m) : 1 - view.crossing(n - s, m - 7);
  return share * share * (s.x * s.x + s.y * s.y + s.z * s.z);
}

// The points at which the surface meets the boundary of a node's star, and how they are linked: vertices of a graph
// that is a single cycle exactly if the surface around the node is one disc.
class LinkCurve {
 public:
  // Points: crossing of link edge (a, b), or link node a on the surface.
  static int edge_point(int a, int b) { return kNeighbors + std::min(a, b) * kNeighbors + std::max(a, b); }

  void link(int p, int q) {
    for (const int i : {p, q}) {
      const auto point = static_cast<std::size_t>(i);
      if (degree_[point] == 0) {
        parent_[point] = static_cast<std::uint8_t>(point);
        ++components_;
      }
      if (++degree_[point] > 2) branches_ = true;
      points_ += degree_[point] == 1;
      odd_ += degree_[point] == 1 ? 1 : -1;
    }
    const std::uint8_t a = find(p), b = find(q);
    if (a != b) {
      parent_[a] = b;
      --components_;
    }
  }
  bool is_single_cycle() const { return points_ >= 3 && components_ == 1 && odd_ == 0 && !branches_; }

 private:
  std::uint8_t find(int i) const {
    auto p = static_cast<std::uint8_t>(i);
    while (parent_[p] != p) p = parent_[p];
    return p;
  }

  static constexpr int kPoints = kNeighbors + kNeighbors * kNeighbors;  // < 256
  std::array<std::uint8_t, kPoints> degree_{};
  std::array<std::uint8_t, kPoints> parent_;  // of points that have a degree
  int points_ = 0, components_ = 0, odd_ = 0;
  bool branches_ = false;
};

// [T-SNAP-2]
bool surface_is_a_disc(const std::array<Side, kNeighbors>& side) {
  LinkCurve curve;
  // Link edges between two nodes on the surface: which sides the two triangles beside them see.
  std::array<std::uint8_t, kNeighbors * kNeighbors> seen{};
  for (const StarTetrahedron& t : kStar) {
    std::array<int, 3> link{};
    std::size_t n = 0;
    for (const int corner : t)
      if (corner >= 0) link[n++] = corner;
    std::array<int, 3> on{}, in{}, out{};
    std::size_t ons = 0, ins = 0, outs = 0;
    for (const int k : link) {
      const Side s = side[static_cast<std::size_t>(k)];
      if (s == kOn) on[ons++] = k;
      if (s == kIn) in[ins++] = k;
      if (s == kOut) out[outs++] = k;
    }
    if (ins == 1 && outs == 1) curve.link(on[0], LinkCurve::edge_point(in[0], out[0]));
    if (ins == 1 && outs == 2) curve.link(LinkCurve::edge_point(in[0], out[0]), LinkCurve::edge_point(in[0], out[1]));
    if (ins == 2 && outs == 1) curve.link(LinkCurve::edge_point(in[0], out[0]), LinkCurve::edge_point(in[1], out[0]));
    if (ons == 2) {
      std::uint8_t& sides = seen[static_cast<std::size_t>(std::min(on[0], on[1]) * kNeighbors + std::max(on[0], on[1]))];
      sides |= ins ? 1 : 2;
      if (sides == 3) curve.link(on[0], on[1]);
    }
    if (ons == 3) return false;
  }
  return curve.is_single_cycle();
}

// Whether moved neighbour k of node n, which was moved by `here`, comes after it in the order of moves: the nearest first, the lower
// node first where two moved as far.
bool moves_later(const LatticeView& view, LocalNode n, int k, double here) {
  const double there = squared_move(view, n + neighbor_step(k));
  return k < kNeighbors / 2 ? here <= there : here < there;
}

// The sides around moved node n when nodes move one by one: those that move later are still where they were.
std::array<Side, kNeighbors> sides_when_moved(const LatticeView& view, LocalNode n, std::array<Side, kNeighbors> side,
                                              const std::array<bool, kNeighbors>& later) {
  for (int k = 0; k < kNeighbors; ++k)
    if (later[static_cast<std::size_t>(k)]) side[static_cast<std::size_t>(k)] = view.sign(n + neighbor_step(k));
  return side;
}

}  // namespace

// [T-SNAP-1]
Move best_move(const LatticeView& view, LocalNode n) {
  if (view.plain[LatticeView::at(n)]) return kStays;
  const Side here = view.sign(n);
  Move best = kStays;
  double least = kSnapLength * kSnapLength;
  for (int k = 0; k < kNeighbors; ++k) {
    const Step s = neighbor_step(k);
    const LocalNode other = n + s;
    if (view.sign(other) == here || view.plain[LatticeView::at(other)]) continue;
    const double p = view.phi[LatticeView::at(n)], q = view.phi[LatticeView::at(other)];
    const double t = p / (p - q);
    if (t >= kSnap) continue;
    const double length2 = t * t * (s.x * s.x + s.y * s.y + s.z * s.z);
    if (length2 < least) {
      least = length2;
      best = static_cast<Move>(k);
    }
  }
  return best;
}

bool must_stay(const LatticeView& view, LocalNode n) {
  const double here = squared_move(view, n);
  std::array<Vec3, kNeighbors> position;
  std::array<Side, kNeighbors> side;
  std::array<bool, kNeighbors> later;
  for (int k = 0; k < kNeighbors; ++k) {
    const LocalNode other = n + neighbor_step(k);
    position[static_cast<std::size_t>(k)] = view.position(other);
    side[static_cast<std::size_t>(k)] = view.side(other);
    later[static_cast<std::size_t>(k)] = side[static_cast<std::size_t>(k)] == kOn && moves_later(view, n, k, here);
  }
  const Vec3 self = view.position(n);
  for (const StarTetrahedron& t : kStar) {
    std::array<Vec3, 4> v;
    int on = 0;
    bool last = true;
    for (std::size_t i = 0; i < 4; ++i) {
      v[i] = t[i] < 0 ? self : position[static_cast<std::size_t>(t[i])];
      if (t[i] < 0 || side[static_cast<std::size_t>(t[i])] != kOn) continue;
      ++on;
      last = last && !later[static_cast<std::size_t>(t[i])];
    }
    const double volume = dot(v[1] - v[0], cross(v[2] - v[0], v[3] - v[0]));
    if ((volume < kLeastVolume || on == 3) && last) return true;
  }
  // The second keeps the surface's topology, step by step. [T-SNAP-3]
  if (!surface_is_a_disc(side)) return true;
  const auto then = sides_when_moved(view, n, side, later);
  return then != side && !surface_is_a_disc(then);
}

}  // namespace burnish::detail
