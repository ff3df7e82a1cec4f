// The tetrahedra of a cell with hanging nodes, or beside one: what extraction cuts and topology counts.
//
// The cell may have finer neighbours across any of its faces and edges: a face split in four contributes eight triangles, a face with split
// edges only a fan from its centre, any other the two of the Kuhn subdivision; neighbours derive the same. Cells without
// hanging nodes become the six Kuhn tetrahedra.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

#include "../octree/lattice_lookup.h"
#include "burnish/octree/field.h"

namespace burnish::detail {

// The six tetrahedra of a cell along its main diagonal, corners numbered x + 2 y + 4 z, in the order along the diagonal. [T-MT-1]
inline constexpr std::array<std::array<int, 4>, 6> kKuhnPaths{
    {{0, 1, 3, 7}, {0, 1, 5, 7}, {0, 2, 3, 7}, {0, 2, 6, 7}, {0, 4, 5, 7}, {0, 4, 6, 7}}};

struct ValuedNode {
  LatticeNode at;
  double phi;
};
using ValuedTetrahedron = std::array<ValuedNode, 4>;

// One cell of a leaf with its 27 possible nodes: corners, edge middles, face centres, centre. Node (i, j, k), each 0..2,
// stands half a cell apart. [T-MT-4]
template <class T>
class TransitionCell {
 public:
  TransitionCell(const Octree& tree, const Field<T>& phi, std::size_t leaf, LatticeNode cell)
      : tree_(tree), phi_(phi), leaf_(leaf), cell_(cell), size_(1 << tree.level(leaf)) {
    const LatticeNode first = lattice_node(tree, leaf, 0, 0, 0);
    local_ = {(cell.x - first.x) / size_, (cell.y - first.y) / size_, (cell.z - first.z) / size_};
    known_.fill(std::numeric_limits<double>::quiet_NaN());
  }

  // Whether nodes of the cell are on both sides. Fans add none that are alone on theirs: they have means.
  bool is_cut() {
    int inside = 0, nodes = 0;
    for_each_node([&](const ValuedNode& n) { inside += n.phi >= 0, ++nodes; });
    return inside != 0 && inside != nodes;
  }

  // Calls visit(node) for the cell's corners and hanging nodes.
  template <class Visit>
  void for_each_node(Visit&& visit) {
    for (const int k : {0, 2})
      for (const int j : {0, 2})
        for (const int i : {0, 2}) visit(node(i, j, k));
    if (!has_hanging_nodes()) return;
    for (int axis = 0; axis < 3; ++axis)
      for (const int u : {0, 2}) {
        for (const int v : {0, 2})
          if (edge_is_split(axis, u, v)) visit(node_at(axis, 1, u, v));
        if (face_is_split(axis, u)) visit(node_at(axis, u, 1, 1));
      }
  }

  // Calls visit(tetrahedron) for all tetrahedra of the cell, oriented either way.
  template <class Visit>
  void for_each_tetrahedron(Visit&& visit) {
    if (!has_hanging_nodes()) {
      for (const auto& path : kKuhnPaths) {
        const auto corner = [&](std::size_t i) {
          const int c = path[i];
          return node((c & 1) * 2, (c >> 1 & 1) * 2, (c >> 2 & 1) * 2);
        };
        visit(ValuedTetrahedron{corner(0), corner(1), corner(2), corner(3)});
      }
      return;
    }
    const ValuedNode apex = mean_of_corners({0, 0, 0}, {2, 2, 2});
    for (int axis = 0; axis < 3; ++axis)
      for (const int end : {0, 2}) visit_face(axis, end, apex, visit);
  }

 private:
  // The kind of neighbour beyond the cell in a direction, if the cell touches its leaf's boundary there.
  bool finer_beyond(std::array<int, 3> toward) const {
    const std::array<int, 3>& at = local_;
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
    if (size_ == 1) return false;  // nothing is finer
    for (int axis = 0; axis < 3; ++axis)
      for (const int u : {0, 2})
        for (const int v : {0, 2})
          if (edge_is_split(axis, u, v)) return true;
    return false;
  }

  LatticeNode lattice(int i, int j, int k) const {
    return {cell_.x + i * size_ / 2, cell_.y + j * size_ / 2, cell_.z + k * size_ / 2};
  }
  // A node that some leaf stores, or that is interpolated as every reader does; looked up once.
  ValuedNode node(int i, int j, int k) {
    const LatticeNode at = lattice(i, j, k);
    double& value = known_[static_cast<std::size_t>(i + 3 * (j + 3 * k))];
    if (std::isnan(value)) value = value_of(i, j, k, at);
    return {at, value};
  }
  double value_of(int i, int j, int k, const LatticeNode& at) const {
    const int x = local_[0] + i / 2, y = local_[1] + j / 2, z = local_[2] + k / 2;
    const bool is_own = ((i | j | k) & 1) == 0 && std::max({x, y, z}) < kBlockSide;
    if (is_own) return static_cast<double>(phi_.block(leaf_)[node_index(x, y, z)]);
    return static_cast<double>(static_cast<T>(node_value_near(tree_, phi_, static_cast<std::uint32_t>(leaf_), at)));
  }
  // By its place along an axis and along the following two.
  ValuedNode node_at(int axis, int along, int u, int v) {
    std::array<int, 3> at{};
    at[static_cast<std::size_t>(axis)] = along;
    at[static_cast<std::size_t>((axis + 1) % 3)] = u;
    at[static_cast<std::size_t>((axis + 2) % 3)] = v;
    return node(at[0], at[1], at[2]);
  }
  // A node of the fan: the middle of the box between two nodes, with the mean of its corners' values.
  ValuedNode mean_of_corners(std::array<int, 3> low, std::array<int, 3> high) {
    double sum = 0;
    int count = 0;
    for (int k = low[2]; k <= high[2]; k += 2)
      for (int j = low[1]; j <= high[1]; j += 2)
        for (int i = low[0]; i <= high[0]; i += 2, ++count) sum += node(i, j, k).phi;
    return {lattice((low[0] + high[0]) / 2, (low[1] + high[1]) / 2, (low[2] + high[2]) / 2), sum / count};
  }

  template <class Visit>
  void visit_face(int axis, int end, const ValuedNode& apex, Visit& visit) {
    const auto value = [&](int u, int v) { return node_at(axis, end, u, v); };
    const auto quad = [&](int u, int v, int side) {
      const ValuedNode p = value(u, v), q = value(u + side, v + side);
      visit(ValuedTetrahedron{apex, p, value(u + side, v), q});
      visit(ValuedTetrahedron{apex, p, q, value(u, v + side)});
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
    std::array<int, 3> low{0, 0, 0}, high{2, 2, 2};
    low[static_cast<std::size_t>(axis)] = high[static_cast<std::size_t>(axis)] = end;
    const ValuedNode center = mean_of_corners(low, high);
    for (std::size_t r = 0; r < ring.size(); ++r)
      visit(ValuedTetrahedron{apex, center, ring[r], ring[(r + 1) % ring.size()]});
  }

  const Octree& tree_;
  const Field<T>& phi_;
  const std::size_t leaf_;
  const LatticeNode cell_;
  const int size_;
  std::array<int, 3> local_{};
  std::array<double, 27> known_;  // not a number: not yet
};

}  // namespace burnish::detail
