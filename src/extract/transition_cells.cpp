#include "transition_cells.h"

#include <algorithm>
#include <array>
#include <tuple>
#include <vector>

#include "lattice_view.h"
#include "tetrahedra.h"

namespace burnish::detail {
namespace {

struct ValuedNode {
  LatticeNode at;
  double phi;
  bool plain;
};

bool before(const LatticeNode& a, const LatticeNode& b) { return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z); }

Vec3 to_vec(const LatticeNode& n) { return {static_cast<double>(n.x), static_cast<double>(n.y), static_cast<double>(n.z)}; }

// The surface vertex between two nodes: same bits whichever comes first.
Vec3 crossing_between(const ValuedNode& a, const ValuedNode& b) {
  const ValuedNode &low = before(a.at, b.at) ? a : b, &high = before(a.at, b.at) ? b : a;
  const double zero = low.plain || high.plain ? 0.5 : low.phi / (low.phi - high.phi);
  const double t = std::clamp(zero, LatticeView::kLeastShare, 1 - LatticeView::kLeastShare);  // [T-MT-3]
  const Vec3 p = to_vec(low.at), q = to_vec(high.at);
  return {p.x + t * (q.x - p.x), p.y + t * (q.y - p.y), p.z + t * (q.z - p.z)};
}

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

// One cell of a leaf with its 27 possible nodes: corners, edge middles, face centres, centre. Node (i, j, k), each 0..2,
// stands half a cell apart. [T-MT-4]
template <class T>
class TransitionCell {
 public:
  TransitionCell(const Octree& tree, const Field<T>& phi, const Field<std::uint8_t>& plain, std::size_t leaf, LatticeNode cell)
      : tree_(tree), phi_(phi), plain_(plain), leaf_(leaf), cell_(cell), size_(1 << tree.level(leaf)) {
    const LatticeNode first = lattice_node(tree, leaf, 0, 0, 0);
    local_ = {(cell.x - first.x) / size_, (cell.y - first.y) / size_, (cell.z - first.z) / size_};
  }

  void cut(TriangleSoup& soup) const {
    if (!has_hanging_nodes()) {
      for (const KuhnTetrahedron& t : kKuhn) {
        const auto corner = [&](std::size_t i) {
          const int c = t.corners[i];
          return node((c & 1) * 2, (c >> 1 & 1) * 2, (c >> 2 & 1) * 2);
        };
        add(corner(0), corner(1), corner(2), corner(3), soup);
      }
      return;
    }
    const ValuedNode apex = mean_of_corners({0, 0, 0}, {2, 2, 2});
    for (int axis = 0; axis < 3; ++axis)
      for (const int end : {0, 2}) cut_face(axis, end, apex, soup);
  }

 private:
  // The kind of neighbour beyond the cell in a direction, if the cell touches its leaf's boundary there.
  bool finer_beyond(std::array<int, 3> toward) const {
    const std::array<int, 3> at{local_.x, local_.y, local_.z};
    std::array<int, 3> dir{};
    for (std::size_t a = 0; a < 3; ++a) {
      const int edge = toward[a] < 0 ? 0 : kBlockSide - 1;
      dir[a] = toward[a] != 0 && at[a] == edge ? toward[a] : 0;
    }
    return tree_.neighbor_kind(leaf_, direction(dir[0], dir[1], dir[2])) == NeighborKind::finer;
  }

  // A face is split if the leaf across it is finer; an edge if any leaf around it is.
  bool face_is_split(int axis, int end) const {
    std::array<int, 3> toward{};
    toward[static_cast<std::size_t>(axis)] = end - 1;
    return finer_beyond(toward);
  }
  // The edge along `axis` at ends (u, v), each 0 or 2, of the following two axes.
  bool edge_is_split(int axis, int u, int v) const {
    const auto b = static_cast<std::size_t>((axis + 1) % 3), c = static_cast<std::size_t>((axis + 2) % 3);
    std::array<int, 3> first{}, second{}, both{};
    first[b] = both[b] = u - 1;
    second[c] = both[c] = v - 1;
    return finer_beyond(first) || finer_beyond(second) || finer_beyond(both);
  }
  bool has_hanging_nodes() const {
    for (int axis = 0; axis < 3; ++axis)
      for (const int u : {0, 2})
        for (const int v : {0, 2})
          if (edge_is_split(axis, u, v)) return true;
    return false;
  }

  LatticeNode lattice(int i, int j, int k) const {
    return {cell_.x + i * size_ / 2, cell_.y + j * size_ / 2, cell_.z + k * size_ / 2};
  }
  // A node that some leaf stores, or that is interpolated as every reader does.
  ValuedNode node(int i, int j, int k) const {
    const LatticeNode at = lattice(i, j, k);
    return {at, static_cast<double>(static_cast<T>(node_value(tree_, phi_, at))), is_marked(tree_, plain_, at)};
  }
  // A node of the fan: the middle of the box between two nodes, with the mean of its corners' values.
  ValuedNode mean_of_corners(std::array<int, 3> low, std::array<int, 3> high) const {
    double sum = 0;
    int count = 0;
    for (int k = low[2]; k <= high[2]; k += 2)
      for (int j = low[1]; j <= high[1]; j += 2)
        for (int i = low[0]; i <= high[0]; i += 2, ++count) sum += node(i, j, k).phi;
    return {lattice((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2), sum / count,
            false};
  }

  void cut_face(int axis, int end, const ValuedNode& apex, TriangleSoup& soup) const {
    const auto on_face = [&](int u, int v) {
      std::array<int, 3> at{};
      at[static_cast<std::size_t>(axis)] = end;
      at[static_cast<std::size_t>((axis + 1) % 3)] = u;
      at[static_cast<std::size_t>((axis + 2) % 3)] = v;
      return at;
    };
    const auto value = [&](int u, int v) {
      const auto at = on_face(u, v);
      return node(at[0], at[1], at[2]);
    };
    const auto quad = [&](int u, int v, int side) {
      const ValuedNode p = value(u, v), q = value(u + side, v + side);
      add(apex, p, value(u + side, v), q, soup);
      add(apex, p, q, value(u, v + side), soup);
    };
    if (face_is_split(axis, end)) {
      for (const int v : {0, 1})
        for (const int u : {0, 1}) quad(u, v, 1);
      return;
    }
    const int b = (axis + 1) % 3, c = (axis + 2) % 3;
    // edge_is_split wants the ends of the two axes that follow the edge's own.
    const bool low_v = edge_is_split(b, 0, end), high_v = edge_is_split(b, 2, end);
    const bool low_u = edge_is_split(c, end, 0), high_u = edge_is_split(c, end, 2);
    if (!(low_v || high_v || low_u || high_u)) return quad(0, 0, 2);
    std::vector<ValuedNode> ring{value(0, 0)};
    if (low_v) ring.push_back(value(1, 0));
    ring.push_back(value(2, 0));
    if (high_u) ring.push_back(value(2, 1));
    ring.push_back(value(2, 2));
    if (high_v) ring.push_back(value(1, 2));
    ring.push_back(value(0, 2));
    if (low_u) ring.push_back(value(0, 1));
    const ValuedNode center = mean_of_corners(on_face(0, 0), on_face(2, 2));
    for (std::size_t r = 0; r < ring.size(); ++r) add(apex, center, ring[r], ring[(r + 1) % ring.size()], soup);
  }

  // Cuts one tetrahedron, whatever its orientation.
  void add(const ValuedNode& a, const ValuedNode& b, const ValuedNode& c, const ValuedNode& d, TriangleSoup& soup) const {
    std::array<ValuedNode, 4> v{a, b, c, d};
    const Vec3 o = to_vec(v[0].at);
    if (dot(to_vec(v[1].at) - o, cross(to_vec(v[2].at) - o, to_vec(v[3].at) - o)) < 0) std::swap(v[2], v[3]);
    std::array<Side, 4> side{};
    for (std::size_t i = 0; i < 4; ++i) side[i] = v[i].phi >= 0 ? kIn : kOut;
    const auto vertex = [&](int i, int j) {
      return crossing_between(v[static_cast<std::size_t>(i)], v[static_cast<std::size_t>(j)]);
    };
    const auto shorter = [](const Vec3& p, const Vec3& q, const Vec3& r, const Vec3& s) {
      return squared_norm(p - r) <= squared_norm(q - s);
    };
    cut_tetrahedron(side, vertex, [](int) { return false; }, shorter, [&](const Vec3& p, const Vec3& q, const Vec3& r) {
      const auto first = static_cast<std::uint32_t>(soup.points.size());
      soup.points.insert(soup.points.end(), {p, q, r});
      soup.facets.push_back({first, first + 1, first + 2});
    });
  }

  const Octree& tree_;
  const Field<T>& phi_;
  const Field<std::uint8_t>& plain_;
  const std::size_t leaf_;
  const LatticeNode cell_;
  const int size_;
  LocalNode local_{};
};

}  // namespace

template <class T>
void cut_transition_cell(const Octree& tree, const Field<T>& phi, const Field<std::uint8_t>& plain, std::size_t leaf,
                         LatticeNode cell, TriangleSoup& soup) {
  TransitionCell<T>(tree, phi, plain, leaf, cell).cut(soup);
}

template void cut_transition_cell(const Octree&, const Field<float>&, const Field<std::uint8_t>&, std::size_t, LatticeNode,
                                  TriangleSoup&);
template void cut_transition_cell(const Octree&, const Field<double>&, const Field<std::uint8_t>&, std::size_t, LatticeNode,
                                  TriangleSoup&);

}  // namespace burnish::detail
