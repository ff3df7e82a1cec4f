#include "burnish/levelset/topology.h"

#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_map>
#include <utility>
#include <vector>

#include "../octree/lattice_lookup.h"
#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "leaf_sides.h"
#include "transition_tetrahedra.h"

namespace burnish {
namespace {

using namespace detail;

constexpr std::size_t kLeafGrain = 64;
constexpr int kNine = kBlockSide + 1;

struct Place {
  int i, j, k;
};
constexpr Place place_of(std::size_t node) {
  const int n = static_cast<int>(node);
  return {n % kBlockSide, n / kBlockSide % kBlockSide, n / kBlockSide / kBlockSide};
}
constexpr Place above(Place p, int corner) { return {p.i + (corner & 1), p.j + (corner >> 1 & 1), p.k + (corner >> 2 & 1)}; }

bool is_cut(unsigned signs, unsigned corners) { return (signs & corners) != 0 && (signs & corners) != corners; }

// Calls visit(path, size) for the 25 simplices of a Kuhn cell whose lowest corner is the cell's: chains 0 < a < b < 7 of corner
// numbers, with 2 to 4 corners.
template <class Visit>
void for_each_anchored_simplex(Visit&& visit) {
  for (int a = 1; a < 8; ++a) {
    visit(std::array<int, 4>{0, a}, 2);
    for (int b = a + 1; b < 8; ++b) {
      if ((a & b) != a) continue;
      visit(std::array<int, 4>{0, a, b}, 3);
      for (int c = b + 1; c < 8; ++c)
        if ((b & c) == b) visit(std::array<int, 4>{0, a, b, c}, 4);
    }
  }
}

// What the anchored simplices add to the surface's Euler characteristic, by the signs of the cell's corners: a cut edge
// holds a vertex, a cut triangle an edge, a cut tetrahedron a face. [T-TOPO-2]
std::array<std::int8_t, 256> euler_by_signs() {
  std::array<std::int8_t, 256> table{};
  for (unsigned signs = 0; signs < 256; ++signs)
    for_each_anchored_simplex([&](const std::array<int, 4>& path, int size) {
      unsigned corners = 0;
      for (int c = 0; c < size; ++c) corners |= 1u << path[static_cast<std::size_t>(c)];
      if (is_cut(signs, corners)) table[signs] = static_cast<std::int8_t>(table[signs] + (size == 3 ? -1 : 1));
    });
  return table;
}

// Components of the equal-signed nodes of a leaf, joined by edges of Kuhn cells within it. Numbers start at 0.
struct Labels {
  std::array<std::uint16_t, kBlockNodes> of{};
  std::uint32_t count = 0;
};

template <class T>
void label_nodes(const T* phi, std::uint32_t same, Labels& labels) {
  std::array<std::uint16_t, kBlockNodes> parent{};
  std::uint16_t used = 0;
  const auto find = [&](std::uint16_t l) {
    while (parent[l] != l) l = parent[l];
    return l;
  };
  for (std::size_t n = 0; n < kBlockNodes; ++n) {
    const Place p = place_of(n);
    int own = -1;
    for (int corner = 1; corner < 8; ++corner) {
      const int dx = corner & 1, dy = corner >> 1 & 1, dz = corner >> 2 & 1;
      if (p.i < dx || p.j < dy || p.k < dz) continue;
      const std::size_t below = node_index(p.i - dx, p.j - dy, p.k - dz);
      if ((phi[below] >= 0) != (phi[n] >= 0) || (kTouched.by_cell[below] & ~same)) continue;
      const std::uint16_t other = labels.of[below];
      if (own < 0) own = other;
      if (own == other) continue;
      const std::uint16_t a = find(static_cast<std::uint16_t>(own)), b = find(other);
      parent[std::max(a, b)] = std::min(a, b);
    }
    if (own < 0) parent[used] = used, own = used++;
    labels.of[n] = static_cast<std::uint16_t>(own);
  }
  std::array<std::uint16_t, kBlockNodes> number{};
  for (std::uint16_t l = 0; l < used; ++l)
    number[l] = parent[l] == l ? static_cast<std::uint16_t>(labels.count++) : number[find(l)];
  for (std::uint16_t& l : labels.of) l = number[l];
}

struct NodeHash {
  std::size_t operator()(const LatticeNode& n) const {
    const auto part = [](std::int32_t x) { return static_cast<std::uint64_t>(static_cast<std::uint32_t>(x)); };
    return (part(n.x) * 0x9e3779b97f4a7c15u) ^ (part(n.y) * 0xc2b2ae3d27d4eb4fu) ^ (part(n.z) * 0x165667b19e3779f9u);
  }
};
struct SameNode {
  bool operator()(const LatticeNode& a, const LatticeNode& b) const { return a.x == b.x && a.y == b.y && a.z == b.z; }
};

// The simplices at and beside transition cells one by one: several cells have the same ones.
struct Explicit {
  std::vector<std::uint64_t> edges;  // both numbers, the lower one first
  std::vector<std::array<std::uint32_t, 3>> triangles;
  std::int64_t tetrahedra = 0;

  template <class Node>
  void add(const Node& node, int size) {  // node(i): number of the simplex' corner i
    if (size == 4) return void(++tetrahedra);
    const auto [a, b] = std::minmax({node(0), node(1)});
    if (size == 2) return edges.push_back(std::uint64_t{a} << 32 | b);
    const std::uint32_t c = node(2);
    triangles.push_back({std::min(a, c), std::clamp(c, a, b), std::max(b, c)});
  }
  std::int64_t euler() {
    const auto distinct = [](auto& list) {
      std::sort(list.begin(), list.end());
      return std::unique(list.begin(), list.end()) - list.begin();
    };
    return distinct(edges) - distinct(triangles) + tetrahedra;
  }
};

template <class T>
class Topology {
 public:
  explicit Topology(const BasicLevelSet<T>& set) : tree_(set.octree()), phi_(set.phi), sides_(set.octree(), set.phi) {}

  LevelSetTopology run(Progress& progress) {
    label_leaves();
    progress.check();
    const std::int64_t plain = count_plain_cells();
    progress.check();
    list_special_cells();
    return summary(plain + explicit_.euler());
  }

 private:
  void label_leaves() {
    const std::size_t leaves = tree_.size();
    slot_.assign(leaves, 0);
    std::vector<std::uint32_t> mixed;
    for (std::uint32_t leaf = 0; leaf < leaves; ++leaf)
      if (sides_.of(leaf) == 3) slot_[leaf] = static_cast<std::uint32_t>(mixed.size()), mixed.push_back(leaf);
    labels_.resize(mixed.size());
    parallel_for(mixed.size(), [&](std::size_t m) { label_nodes(phi_.block(mixed[m]), sides_.same(mixed[m]), labels_[m]); }, kLeafGrain);
    first_.resize(leaves);
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
      first_[leaf] = static_cast<std::uint32_t>(inside_.size());
      // A leaf on one side is connected: the cells that lie in it whole are.
      if (sides_.of(leaf) != 3) inside_.push_back(sides_.of(leaf) == 1);
      else inside_.resize(inside_.size() + labels_[slot_[leaf]].count);
      if (sides_.of(leaf) != 3) continue;
      for (std::size_t n = 0; n < kBlockNodes; ++n) inside_[id(leaf, n)] = phi_.block(leaf)[n] >= 0;
    }
  }

  std::uint32_t id(std::size_t leaf, std::size_t node) const {
    return first_[leaf] + (sides_.of(leaf) == 3 ? labels_[slot_[leaf]].of[node] : 0u);
  }

  // A node up to one beyond the leaf, where the leaf has a neighbour of its level.
  std::pair<std::uint32_t, std::size_t> wrapped(std::size_t leaf, Place p) const {
    const int dir = direction(p.i / kBlockSide, p.j / kBlockSide, p.k / kBlockSide);
    return {tree_.neighbor(leaf, dir), node_index(p.i % kBlockSide, p.j % kBlockSide, p.k % kBlockSide)};
  }

  // Row j + 9 k: bit i is set for an inside node (i, j, k) of the leaf and its upper neighbours of the same level.
  std::array<std::uint16_t, kNine * kNine> sign_rows(std::size_t leaf) const {
    std::array<std::uint16_t, kNine * kNine> rows{};
    for (int upper = 0; upper < 8; ++upper) {
      const int dx = upper & 1, dy = upper >> 1 & 1, dz = upper >> 2 & 1, dir = direction(dx, dy, dz);
      if (!(sides_.same(leaf) >> dir & 1)) continue;
      const T* phi = phi_.block(tree_.neighbor(leaf, dir));
      for (int k = 0; k < (dz ? 1 : kBlockSide); ++k)
        for (int j = 0; j < (dy ? 1 : kBlockSide); ++j)
          for (int i = 0; i < (dx ? 1 : kBlockSide); ++i)
            rows[static_cast<std::size_t>(j + dy * kBlockSide + kNine * (k + dz * kBlockSide))] |=
                static_cast<std::uint16_t>((phi[node_index(i, j, k)] >= 0) << (i + dx * kBlockSide));
    }
    return rows;
  }

  static unsigned signs_of_cell(const std::array<std::uint16_t, kNine * kNine>& rows, Place p) {
    const auto pair = [&](int dy, int dz) { return rows[static_cast<std::size_t>(p.j + dy + kNine * (p.k + dz))] >> p.i & 3u; };
    return pair(0, 0) | pair(1, 0) << 2 | pair(0, 1) << 4 | pair(1, 1) << 6;
  }

  // Simplices anchored at nodes with Kuhn cells all around, which no transition cell has.
  std::int64_t count_plain_cells() const {
    const auto table = euler_by_signs();
    return parallel_reduce(
        tree_.size(), kLeafGrain, std::int64_t{0},
        [&](std::size_t begin, std::size_t end) {
          std::int64_t sum = 0;
          for (std::size_t leaf = begin; leaf < end; ++leaf) {
            if (sides_.around(leaf, kUpper) != 3) continue;
            const auto rows = sign_rows(leaf);
            for (std::size_t n = 0; n < kBlockNodes; ++n)
              if (sides_.is_plain_node(leaf, n)) sum += table[signs_of_cell(rows, place_of(n))];
          }
          return sum;
        },
        std::plus<>());
  }

  // Joins leaves, and nodes across their boundaries; lists the simplices of and beside transition cells.
  void list_special_cells() {
    for (std::size_t leaf = 0; leaf < tree_.size(); ++leaf) {
      join_faces(leaf);
      if (sides_.around(leaf, kUpper) != 3) continue;
      for (int upper = 1; upper < 8; ++upper) join_upwards(leaf, upper);
      if (sides_.same(leaf) != kAllSame) list_special_cells(leaf);
    }
  }

  void list_special_cells(std::size_t leaf) {
    const auto rows = sign_rows(leaf);
    for (std::size_t n = 0; n < kBlockNodes; ++n) {
      if (sides_.is_plain_node(leaf, n)) continue;
      if (!sides_.is_plain_cell(leaf, n)) {
        if (sides_.around(leaf, kTouched.by_cell[n] & kUpper) == 3 && !join_uniform_cell(leaf, n)) list_transition_cell(leaf, n);
        continue;
      }
      const unsigned signs = signs_of_cell(rows, place_of(n));
      if (signs != 0 && signs != 255) list_anchored(leaf, n, signs);
    }
  }

  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t pair = std::uint64_t{a} << 32 | b;
    if (a != b && (joined_.empty() || joined_.back() != pair)) joined_.push_back(pair);
  }

  // Leaves on one side are joined across faces: the cells at a face's middle touch no third leaf.
  void join_faces(std::size_t leaf) {
    if (sides_.of(leaf) == 3) return;
    for (const int dir : {direction(1, 0, 0), direction(0, 1, 0), direction(0, 0, 1)})
      for (const std::uint32_t other : tree_.neighbors(leaf, dir))
        if (sides_.of(other) == sides_.of(leaf)) join(first_[leaf], first_[other]);
  }

  // Edges of Kuhn cells from this leaf to one of its level above it, by their upper nodes.
  void join_upwards(std::size_t leaf, int upper) {
    const int ex = upper & 1, ey = upper >> 1 & 1, ez = upper >> 2 & 1, dir = direction(ex, ey, ez);
    if (!(sides_.same(leaf) >> dir & 1)) return;
    const std::size_t other = tree_.neighbor(leaf, dir);
    const bool face = !(upper & (upper - 1));
    if (sides_.of(leaf) != 3 && (sides_.of(leaf) | sides_.of(other)) != 3 && face) return;  // by join_faces, or nothing to join
    const std::uint16_t* labels = sides_.of(leaf) == 3 ? labels_[slot_[leaf]].of.data() : nullptr;
    const std::uint16_t* others = sides_.of(other) == 3 ? labels_[slot_[other]].of.data() : nullptr;
    for (int k = 0; k < (ez ? 1 : kBlockSide); ++k)
      for (int j = 0; j < (ey ? 1 : kBlockSide); ++j)
        for (int i = 0; i < (ex ? 1 : kBlockSide); ++i) {
          const std::size_t to = node_index(i, j, k);
          const std::uint32_t b = first_[other] + (others ? others[to] : 0u);
          for (int corner = upper; corner < 8; ++corner) {
            const Place from{i + ex * kBlockSide - (corner & 1), j + ey * kBlockSide - (corner >> 1 & 1),
                             k + ez * kBlockSide - (corner >> 2)};
            if ((corner & upper) != upper || from.i < 0 || from.j < 0 || from.k < 0) continue;
            const std::size_t n = node_index(from.i, from.j, from.k);
            const std::uint32_t a = first_[leaf] + (labels ? labels[n] : 0u);
            if (inside_[a] == inside_[b] && sides_.is_plain_cell(leaf, n)) join(a, b);
          }
        }
  }

  // Joins the nodes of a transition cell if its corners in leaves of this level, and all leaves of other levels that it touches, are on one
  // side: then so are the nodes between them.
  bool join_uniform_cell(std::size_t leaf, std::size_t n) {
    const std::uint32_t foreign = kTouched.by_cell[n] & kUpper & ~sides_.same(leaf);
    const bool inside = inside_[id(leaf, n)];
    if (sides_.around(leaf, foreign, inside ? 1 : 2) == 3) return false;
    std::array<std::uint32_t, 8> ids;
    std::size_t count = 0;
    for (int corner = 0; corner < 8; ++corner) {
      const Place at = above(place_of(n), corner);
      if (!(sides_.same(leaf) >> direction(at.i / kBlockSide, at.j / kBlockSide, at.k / kBlockSide) & 1)) continue;
      const auto [owner, node] = wrapped(leaf, at);
      ids[count] = id(owner, node);
      if (inside_[ids[count++]] != inside) return false;
    }
    for (std::size_t i = 1; i < count; ++i) join(ids[0], ids[i]);
    for (int dir = 0; dir < kDirections; ++dir)
      if (foreign >> dir & 1)
        for (const std::uint32_t other : tree_.neighbors(leaf, dir)) join(ids[0], first_[other]);
    return true;
  }

  // A number for a node of explicit simplices; nodes that no leaf stores become components of their own first.
  std::uint32_t number(const LatticeNode& at, bool is_inside) {
    const auto [entry, is_new] = numbers_.try_emplace(at, static_cast<std::uint32_t>(components_.size()));
    if (is_new) {
      const LocatedNode located = locate(tree_, 0, at);
      if (!located.beyond && located.is_stored()) {
        components_.push_back(id(located.leaf, located.place()));
      } else {
        components_.push_back(static_cast<std::uint32_t>(inside_.size()));
        inside_.push_back(is_inside);
      }
    }
    return entry->second;
  }

  void list_anchored(std::size_t leaf, std::size_t n, unsigned signs) {
    const Place p = place_of(n);
    std::array<std::uint32_t, 8> numbers;
    for (int c = 0; c < 8; ++c) {
      const Place q = above(p, c);
      numbers[static_cast<std::size_t>(c)] = number(lattice_node(tree_, leaf, q.i, q.j, q.k), signs >> c & 1);
    }
    for_each_anchored_simplex([&](const std::array<int, 4>& path, int size) {
      unsigned corners = 0;
      for (int c = 0; c < size; ++c) corners |= 1u << path[static_cast<std::size_t>(c)];
      if (is_cut(signs, corners))
        explicit_.add([&](int c) { return numbers[static_cast<std::size_t>(path[static_cast<std::size_t>(c)])]; }, size);
    });
  }

  void list_transition_cell(std::size_t leaf, std::size_t n) {
    const Place p = place_of(n);
    TransitionCell<T> cell(tree_, phi_, leaf, lattice_node(tree_, leaf, p.i, p.j, p.k));
    cell.for_each_tetrahedron([&](const ValuedTetrahedron& corners) { list_tetrahedron(corners); });
  }

  void list_tetrahedron(const ValuedTetrahedron& corners) {
    unsigned signs = 0;
    std::array<std::uint32_t, 4> numbers;
    for (std::size_t c = 0; c < 4; ++c) {
      signs |= static_cast<unsigned>(corners[c].phi >= 0) << c;
      numbers[c] = number(corners[c].at, corners[c].phi >= 0);
    }
    for (std::size_t c = 1; c < 4; ++c)
      for (std::size_t b = 0; b < c; ++b)
        if ((signs >> b & 1) == (signs >> c & 1)) join(components_[numbers[b]], components_[numbers[c]]);
    for (unsigned subset = 0; subset < 16; ++subset) {
      if (!is_cut(signs, subset)) continue;
      std::array<std::uint32_t, 4> chosen{};
      int size = 0;
      for (unsigned c = 0; c < 4; ++c)
        if (subset >> c & 1) chosen[static_cast<std::size_t>(size++)] = numbers[c];
      explicit_.add([&](int c) { return chosen[static_cast<std::size_t>(c)]; }, size);
    }
  }

  // [T-TOPO-3]
  LevelSetTopology summary(std::int64_t euler) const {
    UnionFind sets(inside_.size());
    for (const std::uint64_t pair : joined_) sets.unite(static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair));
    LevelSetTopology result;
    for (std::uint32_t c = 0; c < inside_.size(); ++c)
      if (sets.is_representative(c)) ++(inside_[c] ? result.inside_components : result.outside_components);
    result.surface_components = result.inside_components + result.outside_components - 1;
    result.euler_characteristic = euler;
    result.genus = static_cast<std::int64_t>(result.surface_components) - euler / 2;
    return result;
  }

  const Octree& tree_;
  const Field<T>& phi_;
  const LeafSides sides_;
  std::vector<std::uint32_t> slot_;    // leaf -> its labels
  std::vector<Labels> labels_;         // of leaves with nodes on both sides
  std::vector<std::uint32_t> first_;   // leaf -> its first component
  std::vector<std::uint8_t> inside_;   // of components, before they are joined
  std::vector<std::uint64_t> joined_;   // pairs of them
  std::unordered_map<LatticeNode, std::uint32_t, NodeHash, SameNode> numbers_;
  std::vector<std::uint32_t> components_;  // of numbered nodes
  Explicit explicit_;
};

}  // namespace

template <class T>
LevelSetTopology level_set_topology(const BasicLevelSet<T>& set, Progress& progress) {
  return Topology<T>(set).run(progress);
}

template LevelSetTopology level_set_topology(const BasicLevelSet<float>&, Progress&);
template LevelSetTopology level_set_topology(const BasicLevelSet<double>&, Progress&);

}  // namespace burnish
