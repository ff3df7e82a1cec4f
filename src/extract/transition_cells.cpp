#include "transition_cells.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <utility>

#include "../levelset/transition_tetrahedra.h"
#include "lattice_view.h"
#include "tetrahedra.h"

namespace burnish::detail {
namespace {

bool before(const LatticeNode& a, const LatticeNode& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

Vec3 to_vec(const LatticeNode& n) { return {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)}; }

// Whether a node of the domain is stored, and marked.
bool is_marked(const Octree& tree, const Field<std::uint8_t>& marked, const LatticeNode& n) {
  const auto side = static_cast<std::int32_t>(tree.side()) * kBlockSide;
  if (marked.empty() || n.x >= side || n.y >= side || n.z >= side) return false;
  const auto block = [](std::int32_t x) { return static_cast<std::uint32_t>(x) / kBlockSide; };
  const std::uint32_t leaf = tree.find({block(n.x), block(n.y), block(n.z)});
  const LatticeNode first = lattice_node(tree, leaf, 0, 0, 0);
  const int level = tree.level(leaf);
  const std::array<std::int32_t, 3> at{n.x - first.x, n.y - first.y, n.z - first.z};
  if ((at[0] | at[1] | at[2]) & ((1 << level) - 1)) return false;
  return marked.block(leaf)[node_index(at[0] >> level, at[1] >> level, at[2] >> level)] != 0;
}

// The surface vertex between two nodes: same bits whichever comes first.
Vec3 crossing_between(const Octree& tree, const Field<std::uint8_t>& plain, const ValuedNode& a, const ValuedNode& b) {
  const ValuedNode &low = before(a.at, b.at) ? a : b, &high = before(a.at, b.at) ? b : a;
  const bool middle = is_marked(tree, plain, low.at) || is_marked(tree, plain, high.at);
  const double zero = middle ? 0.5 : low.phi / (low.phi - high.phi);
  const double t = std::clamp(zero, LatticeView::kLeastShare, 1 - LatticeView::kLeastShare);  // [T-MT-3]
  const Vec3 p = to_vec(low.at), q = to_vec(high.at);
  return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z + t * (q.z - p.z)};
}

}  // namespace

// [T-MT-4]
template <class T>
void cut_transition_cell(const Octree& tree, const Field<T>& phi, const Field<std::uint8_t>& plain, std::size_t leaf,
                         LatticeNode cell, TriangleSoup& soup) {
  const auto shorter = [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
    return squared_norm(p - r) <= squared_norm(q - s);
  };
  const auto emit = [&](const Vec3& p, const Vec3& q, const Vec3& r) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), {p, q, r});
    soup.facets.push_back({first, first + 1, first + 2});
  };
  TransitionCell<T> transition(tree, phi, leaf, cell);
  if (!transition.is_cut()) return;
  transition.for_each_tetrahedron([&](ValuedTetrahedron v) {
    const Vec3 o = to_vec(v[0].at);
    if (dot(to_vec(v[1].at) - o, cross(to_vec(v[2].at) - o, to_vec(v[3].at) - o)) < 0) std::swap(v[2], v[3]);
    std::array<Side, 4> side{};
    for (std::size_t i = 0; i < 4; ++i) side[i] = v[i].phi >= 0 ? kIn : kOut;
    const auto vertex = [&](int i, int j) {
      return crossing_between(tree, plain, v[static_cast<std::size_t>(i)], v[static_cast<std::size_t>(j)]);
    };
    cut_tetrahedron(side, vertex, [](int) { return false; }, shorter, emit);
  });
}

template void cut_transition_cell(const Octree&, const Field<float>&, const Field<std::uint8_t>&, std::size_t, LatticeNode,
                                  TriangleSoup&);
template void cut_transition_cell(const Octree&, const Field<double>&, const Field<std::uint8_t>&, std::size_t, LatticeNode,
                                  TriangleSoup&);

}  // namespace burnish::detail
