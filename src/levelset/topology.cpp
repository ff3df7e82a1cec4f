#include "burnish/levelset/topology.h"

#include <algorithm>
#include <array>
#include <bit>
#include <functional>
#include <optional>
#include <utility>
#include <vector>

#include "burnish/core/large_array.h"
#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "leaf_sides.h"
#include "node_labels.h"
#include "simplex_list.h"
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

// What some leaves list: components that are joined, nodes that no leaf stores, and simplices.
struct Listed {
  // Nodes that no leaf stores are not numbered yet when they are listed: they stand for themselves.
  static constexpr std::uint64_t kUnstored = std::uint64_t{1} << 63;

  std::vector<std::uint64_t> joined;                         // pairs of components, the first in the upper half
  std::vector<std::array<std::uint64_t, 2>> joined_unstored;  // pairs of which one is kUnstored | number of the node
  std::vector<std::uint64_t> unstored;                       // 2 * number of the node + whether it is inside
  SimplexList simplices;

  void join(std::uint32_t a, std::uint32_t b) {
    const std::uint64_t pair = std::uint64_t{a} << 32 | b;
    std::uint64_t& recent = recent_[(a * 31 + b) % recent_.size()];
    if (a == b || recent == pair) return;
    joined.push_back(recent = pair);
  }
  void join_any(std::uint64_t a, std::uint64_t b) {
    if ((a | b) & kUnstored) joined_unstored.push_back({a, b});
    else join(static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b));
  }
  void drop_copies() {
    SimplexList::drop_copies_of(unstored);
    simplices.drop_copies();
  }
  void append(const Listed& other) {
    joined.insert(joined.end(), other.joined.begin(), other.joined.end());
    joined_unstored.insert(joined_unstored.end(), other.joined_unstored.begin(), other.joined_unstored.end());
    unstored.insert(unstored.end(), other.unstored.begin(), other.unstored.end());
    simplices.append(other.simplices);
  }

 private:
  std::array<std::uint64_t, 64> recent_{};  // the same pairs come again and again
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
    const Listed listed = list_special_cells(progress);
    return summary(plain + listed.simplices.euler(), listed);
  }

 private:
  void label_leaves() {
    const std::size_t leaves = tree_.size();
    slot_.assign(leaves, 0);
    std::vector<std::uint32_t> mixed;
    for (std::uint32_t leaf = 0; leaf < leaves; ++leaf)
      if (sides_.of(leaf) == 3) slot_[leaf] = static_cast<std::uint32_t>(mixed.size()), mixed.push_back(leaf);
    labels_.resize(mixed.size());
    parallel_for(mixed.size(), [&](std::size_t m) { Labeller(phi_.block(mixed[m]), plain_cells(mixed[m]), labels_[m]); }, kLeafGrain);
    first_.resize(leaves);
    for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
      first_[leaf] = static_cast<std::uint32_t>(inside_.size());
      // A leaf on one side is connected: the cells that lie in it whole are.
      if (sides_.of(leaf) != 3) inside_.push_back(sides_.of(leaf) == 1);
      else inside_.resize(inside_.size() + labels_[slot_[leaf]].count);
    }
    parallel_for(mixed.size(), [&](std::size_t m) {
      for (std::size_t r = 0; r < kBlockRows; ++r)
        for (unsigned runs = labels_[m].starts[r]; runs != 0; runs &= runs - 1) {
          const int i = std::countr_zero(runs);
          inside_[id(mixed[m], r * kBlockSide + static_cast<std::size_t>(i))] = labels_[m].inside[r] >> i & 1;
        }
    }, kLeafGrain);
  }

  std::uint32_t id(std::size_t leaf, std::size_t node) const {
    return first_[leaf] + (sides_.of(leaf) == 3 ? labels_[slot_[leaf]].of[node] : 0u);
  }

  // A node up to one beyond the leaf, where the leaf has a neighbour of its level.
  std::pair<std::uint32_t, std::size_t> wrapped(std::size_t leaf, Place p) const {
    const int dir = direction(p.i / kBlockSide, p.j / kBlockSide, p.k / kBlockSide);
    return {tree_.neighbor(leaf, dir), node_index(p.i % kBlockSide, p.j % kBlockSide, p.k % kBlockSide)};
  }

  RowBits plain_cells(std::size_t leaf) const {
    if (sides_.same(leaf) == kAllSame) return all_rows();
    RowBits rows;
    for (std::size_t r = 0; r < kBlockRows; ++r) {
      const std::size_t n = r * kBlockSide;  // cells between a row's ends touch the same leaves
      const unsigned middle = sides_.is_plain_cell(leaf, n + 1) ? 0x7eu : 0u;
      rows[r] = static_cast<std::uint8_t>(sides_.is_plain_cell(leaf, n) | middle | unsigned{sides_.is_plain_cell(leaf, n + 7)} << 7);
    }
    return rows;
  }
  // Nodes with Kuhn cells all around.
  static RowBits plain_nodes(const RowBits& cells) {
    RowBits rows;
    for (std::size_t r = 0; r < kBlockRows; ++r) rows[r] = static_cast<std::uint8_t>(cells[r] & (cells[r] << 1 | 1));
    for (const std::size_t stride : {std::size_t{1}, std::size_t{kBlockSide}})
      for (std::size_t r = kBlockRows; r-- > stride;)
        if (r / stride % kBlockSide != 0) rows[r] &= rows[r - stride];
    return rows;
  }
  static RowBits all_rows() {
    RowBits rows;
    rows.fill(0xff);
    return rows;
  }
  NodeRow row(std::size_t leaf, std::size_t r) const {
    return sides_.of(leaf) == 3 ? labels_[slot_[leaf]].row(r) : NodeRow{sides_.of(leaf) == 1 ? 0xffu : 0u, 1};
  }

  // Row j + 9 k: bit i is set for an inside node (i, j, k) of the leaf and its upper neighbours of the same level.
  using SignRows = std::array<std::uint16_t, kNine * kNine>;
  SignRows sign_rows(std::size_t leaf) const {
    SignRows rows{};
    for (int upper = 0; upper < 8; ++upper) {
      const int dx = upper & 1, dy = upper >> 1 & 1, dz = upper >> 2 & 1, dir = direction(dx, dy, dz);
      if (!(sides_.same(leaf) >> dir & 1)) continue;
      const std::size_t other = tree_.neighbor(leaf, dir);
      for (int k = 0; k < (dz ? 1 : kBlockSide); ++k)
        for (int j = 0; j < (dy ? 1 : kBlockSide); ++j) {
          const unsigned inside = row(other, row_index(j, k)).inside;
          rows[static_cast<std::size_t>(j + dy * kBlockSide + kNine * (k + dz * kBlockSide))] |=
              static_cast<std::uint16_t>(dx ? (inside & 1) << kBlockSide : inside);
        }
    }
    return rows;
  }

  // Bit i: the corners of cell (i, j, k) are on both sides.
  static unsigned cut_cells(const SignRows& rows, int j, int k) {
    unsigned in = ~0u, out = ~0u;
    for (int c = 0; c < 4; ++c) {
      const unsigned r = rows[static_cast<std::size_t>(j + (c & 1) + kNine * (k + (c >> 1)))];
      in &= r & r >> 1;
      out &= ~r & ~(r >> 1);
    }
    return ~(in | out) & 0xffu;
  }

  static unsigned signs_of_cell(const SignRows& rows, Place p) {
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
            const RowBits plain = plain_nodes(plain_cells(leaf));
            for (int k = 0; k < kBlockSide; ++k)
              for (int j = 0; j < kBlockSide; ++j)
                for (unsigned cells = cut_cells(rows, j, k) & plain[row_index(j, k)]; cells != 0; cells &= cells - 1)
                  sum += table[signs_of_cell(rows, {std::countr_zero(cells), j, k})];
          }
          return sum;
        },
        std::plus<>());
  }

  // Joins leaves, and nodes across their boundaries; lists the simplices of and beside transition cells.
  Listed list_special_cells(Progress& progress) const {
    std::vector<Listed> parts((tree_.size() + kLeafGrain - 1) / kLeafGrain);
    parallel_ranges(tree_.size(), kLeafGrain, [&](std::size_t begin, std::size_t end) {
      progress.check();
      Listed& listed = parts[begin / kLeafGrain];
      for (std::size_t leaf = begin; leaf < end; ++leaf) list_leaf(static_cast<std::uint32_t>(leaf), listed);
      listed.drop_copies();
    });
    Listed all;
    for (const Listed& part : parts) all.append(part);
    all.drop_copies();
    return all;
  }

  void list_leaf(std::uint32_t leaf, Listed& listed) const {
    join_faces(leaf, listed);
    if (sides_.around(leaf, kUpper) != 3) return;
    const RowBits plain = plain_cells(leaf);
    for (int upper = 1; upper < 8; ++upper) join_upwards(leaf, upper, plain, listed);
    if (sides_.same(leaf) == kAllSame) return;
    list_anchored(leaf, plain, listed.simplices);
    list_transition_cells(leaf, plain, listed);
  }

  // Leaves on one side are joined across faces: the cells at a face's middle touch no third leaf.
  void join_faces(std::size_t leaf, Listed& listed) const {
    if (sides_.of(leaf) == 3) return;
    for (const int dir : {direction(1, 0, 0), direction(0, 1, 0), direction(0, 0, 1)})
      for (const std::uint32_t other : tree_.neighbors(leaf, dir))
        if (sides_.of(other) == sides_.of(leaf)) listed.join(first_[leaf], first_[other]);
  }

  // Edges of Kuhn cells from this leaf to one of its level above it, by their upper nodes.
  void join_upwards(std::size_t leaf, int upper, const RowBits& plain, Listed& listed) const {
    const int ex = upper & 1, ey = upper >> 1 & 1, ez = upper >> 2 & 1, dir = direction(ex, ey, ez);
    if (!(sides_.same(leaf) >> dir & 1)) return;
    const std::size_t other = tree_.neighbor(leaf, dir);
    const bool face = !(upper & (upper - 1));
    if (sides_.of(leaf) != 3 && (sides_.of(leaf) | sides_.of(other)) != 3 && face) return;  // by join_faces, or nothing to join
    for (int k = 0; k < (ez ? 1 : kBlockSide); ++k)
      for (int j = 0; j < (ey ? 1 : kBlockSide); ++j)
        for (int dz = ez; dz < 2; ++dz)
          for (int dy = ey; dy < 2; ++dy) {
            const int from_j = j + ey * kBlockSide - dy, from_k = k + ez * kBlockSide - dz;
            if (from_j < 0 || from_k < 0) continue;
            const std::size_t from = row_index(from_j, from_k), to = row_index(j, k);
            const NodeRow below = row(leaf, from), here = row(other, to);
            const auto join = [&](int i, int i_below) {
              listed.join(id(leaf, from * kBlockSide + static_cast<std::size_t>(i_below)), id(other, to * kBlockSide + static_cast<std::size_t>(i)));
            };
            if (!ex) for_joined_runs(here, below, plain[from], join);
            else if (plain[from] >> (kBlockSide - 1) & ~((below.inside >> (kBlockSide - 1)) ^ here.inside) & 1) join(0, kBlockSide - 1);
          }
  }

  // Joins the nodes of a transition cell if its corners in leaves of this level, and all leaves of other levels that it touches, are on one
  // side: then so are the nodes between them.
  bool join_uniform_cell(std::size_t leaf, std::size_t n, Listed& listed) const {
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
    for (std::size_t i = 1; i < count; ++i) listed.join(ids[0], ids[i]);
    for (int dir = 0; dir < kDirections; ++dir)
      if (foreign >> dir & 1)
        for (const std::uint32_t other : tree_.neighbors(leaf, dir)) listed.join(ids[0], first_[other]);
    return true;
  }

  // Those of Kuhn cells at nodes beside transition cells.
  void list_anchored(std::uint32_t leaf, const RowBits& plain, SimplexList& simplices) const {
    const SignRows rows = sign_rows(leaf);
    const RowBits counted = plain_nodes(plain);
    const NodeNumbers numbers(tree_, leaf);
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j) {
        const std::size_t r = row_index(j, k);
        for (unsigned cells = cut_cells(rows, j, k) & plain[r] & ~counted[r] & 0xffu; cells != 0; cells &= cells - 1) {
          const Place p{std::countr_zero(cells), j, k};
          list_anchored(leaf, p, signs_of_cell(rows, p), numbers, simplices);
        }
      }
  }

  // The simplices anchored at the lowest corner of a Kuhn cell.
  void list_anchored(std::uint32_t leaf, Place p, unsigned signs, const NodeNumbers& number_of, SimplexList& simplices) const {
    std::array<std::uint64_t, 8> numbers;
    for (int c = 0; c < 8; ++c) {
      const Place q = above(p, c);
      numbers[static_cast<std::size_t>(c)] = number_of(lattice_node(tree_, leaf, q.i, q.j, q.k)).number;
    }
    for_each_anchored_simplex([&](const std::array<int, 4>& path, int size) {
      unsigned corners = 0;
      for (int c = 0; c < size; ++c) corners |= 1u << path[static_cast<std::size_t>(c)];
      if (!is_cut(signs, corners)) return;
      const auto number = [&](std::size_t c) { return numbers[static_cast<std::size_t>(path[c])]; };
      if (size == 2) simplices.add_edge(number(0), number(1));
      else if (size == 3) simplices.add_triangle(number(0), number(1), number(2));
      else simplices.add_inner(1);
    });
  }

  void list_transition_cells(std::uint32_t leaf, const RowBits& plain, Listed& listed) const {
    const NodeNumbers numbers(tree_, leaf);
    std::uint32_t last = 0;  // neighbouring cells touch the same leaves
    bool mixed = false;
    for (std::size_t r = 0; r < kBlockRows; ++r)
      for (unsigned cells = ~plain[r] & 0xffu; cells != 0; cells &= cells - 1) {
        const std::size_t n = r * kBlockSide + static_cast<std::size_t>(std::countr_zero(cells));
        const std::uint32_t touched = kTouched.by_cell[n] & kUpper;
        if (touched != last) last = touched, mixed = sides_.around(leaf, touched) == 3;
        if (mixed && !join_uniform_cell(leaf, n, listed)) list_transition_cell(leaf, n, numbers, listed);
      }
  }

  void list_transition_cell(std::uint32_t leaf, std::size_t n, const NodeNumbers& numbered, Listed& listed) const {
    const Place p = place_of(n);
    const LatticeNode low = lattice_node(tree_, leaf, p.i, p.j, p.k);
    // In halves of the cell; cells of finest leaves have corners only.
    const int level = tree_.level(leaf);
    const auto slot_of = [&](const LatticeNode& at) {
      return static_cast<std::size_t>(((at.x - low.x) * 2 >> level) + 3 * ((at.y - low.y) * 2 >> level) + 9 * ((at.z - low.z) * 2 >> level));
    };
    TransitionCell<T> cell(tree_, phi_, leaf, low);
    if (!cell.is_cut()) return join_nodes(cell, numbered, listed);
    CellSimplices simplices;
    cell.for_each_tetrahedron([&](const ValuedTetrahedron& corners) {
      std::array<std::size_t, 4> slots;
      std::array<bool, 4> inside;
      for (std::size_t c = 0; c < 4; ++c) slots[c] = slot_of(corners[c].at), inside[c] = corners[c].phi >= 0;
      simplices.add_tetrahedron(slots, inside);
    });
    std::array<NumberedNode, kSlots> nodes;
    for (std::uint32_t rest = simplices.used(); rest != 0; rest &= rest - 1) {
      const int slot = std::countr_zero(rest);
      const int half = 1 << level;
      const LatticeNode at{low.x + slot % 3 * half / 2, low.y + slot / 3 % 3 * half / 2, low.z + slot / 9 * half / 2};
      nodes[static_cast<std::size_t>(slot)] = numbered(at);
    }
    simplices.list([&](std::size_t slot) { return nodes[slot].number; }, listed.simplices);
    join_slots(simplices, nodes, listed);
  }

  // Of the node as far as it is known yet.
  std::uint64_t component(const NumberedNode& node) const {
    return node.is_stored() ? std::uint64_t{id(node.leaf, node.place)} : Listed::kUnstored | node.number;
  }

  // All nodes of a cell that is not cut.
  void join_nodes(TransitionCell<T>& cell, const NodeNumbers& numbered, Listed& listed) const {
    std::optional<std::uint64_t> first;
    cell.for_each_node([&](const ValuedNode& n) {
      const NumberedNode node = numbered(n.at);
      if (!node.is_stored()) listed.unstored.push_back(2 * node.number + (n.phi >= 0));
      if (first) listed.join_any(*first, component(node));
      else first = component(node);
    });
  }

  void join_slots(const CellSimplices& simplices, const std::array<NumberedNode, kSlots>& nodes, Listed& listed) const {
    std::uint32_t rest = simplices.used();
    while (rest != 0) {
      const auto first = static_cast<std::size_t>(std::countr_zero(rest));
      const std::uint32_t all = simplices.joined_to(first);
      for (std::uint32_t others = all; others != 0; others &= others - 1) {
        const auto slot = static_cast<std::size_t>(std::countr_zero(others));
        if (!nodes[slot].is_stored()) listed.unstored.push_back(2 * nodes[slot].number + simplices.is_inside(slot));
        if (slot != first) listed.join_any(component(nodes[first]), component(nodes[slot]));
      }
      rest &= ~all;
    }
  }

  // [T-TOPO-3]
  LevelSetTopology summary(std::int64_t euler, const Listed& listed) const {
    const std::size_t stored = inside_.size(), count = stored + listed.unstored.size();
    UnionFind sets(count);
    for (const std::uint64_t pair : listed.joined) sets.unite(static_cast<std::uint32_t>(pair >> 32), static_cast<std::uint32_t>(pair));
    const auto component = [&](std::uint64_t any) {
      if (!(any & Listed::kUnstored)) return static_cast<std::uint32_t>(any);
      const auto place = std::lower_bound(listed.unstored.begin(), listed.unstored.end(), 2 * (any & ~Listed::kUnstored));
      return static_cast<std::uint32_t>(stored + static_cast<std::size_t>(place - listed.unstored.begin()));
    };
    for (const auto& [a, b] : listed.joined_unstored) sets.unite(component(a), component(b));
    LevelSetTopology result;
    for (std::uint32_t c = 0; c < count; ++c) {
      if (!sets.is_representative(c)) continue;
      const bool inside = c < stored ? inside_[c] != 0 : listed.unstored[c - stored] & 1;
      ++(inside ? result.inside_components : result.outside_components);
    }
    result.surface_components = result.inside_components + result.outside_components - 1;
    result.euler_characteristic = euler;
    result.genus = static_cast<std::int64_t>(result.surface_components) - euler / 2;
    return result;
  }

  const Octree& tree_;
  const Field<T>& phi_;
  const LeafSides sides_;
  std::vector<std::uint32_t> slot_;    // leaf -> its labels
  LargeArray<Labels> labels_;          // of leaves with nodes on both sides
  std::vector<std::uint32_t> first_;   // leaf -> its first component
  std::vector<std::uint8_t> inside_;   // of components, before they are joined
};

}  // namespace

template <class T>
LevelSetTopology level_set_topology(const BasicLevelSet<T>& set, Progress& progress) {
  return Topology<T>(set).run(progress);
}

template LevelSetTopology level_set_topology(const BasicLevelSet<float>&, Progress&);
template LevelSetTopology level_set_topology(const BasicLevelSet<double>&, Progress&);

}  // namespace burnish
