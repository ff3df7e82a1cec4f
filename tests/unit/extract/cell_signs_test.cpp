// Single cells, with all signs that their nodes can have: what one cell leaves open on a face is what its neighbours close there.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstdint>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "burnish/surface/edge_table.h"
#include "burnish/surface/weld.h"
#include "support/level_sets.h"
#include "transition_cells.h"

namespace burnish::detail {
namespace {

using test::to_vec;

using Segment = std::pair<Vec3, Vec3>;
using Segments = std::vector<Segment>;  // sorted

Segments sorted(Segments segments) {
  std::sort(segments.begin(), segments.end());
  return segments;
}

Segments reversed(Segments segments) {
  for (auto& [a, b] : segments) std::swap(a, b);
  return sorted(std::move(segments));
}

struct Cell {
  std::size_t leaf;
  LatticeNode low;
  int size;
};

// The cell that holds the finest cell at `at`.
Cell cell_at(const Octree& tree, const LatticeNode& at) {
  const auto block = [](int x) { return static_cast<std::uint32_t>(x) / kBlockSide; };
  const std::uint32_t leaf = tree.find({block(at.x), block(at.y), block(at.z)});
  const int size = 1 << tree.level(leaf);
  return {leaf, {at.x / size * size, at.y / size * size, at.z / size * size}, size};
}

TriangleSoup cut(const Octree& tree, const Field<double>& phi, const Cell& cell) {
  TriangleSoup soup;
  cut_transition_cell(tree, phi, {}, cell.leaf, cell.low, soup);
  return soup;
}

// The directed edges of a cell's facets whose reverse is none.
Segments open_segments(const TriangleSoup& soup) {
  Segments all, open;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (int i = 0; i < 3; ++i) all.emplace_back(soup.corner(f, i), soup.corner(f, (i + 1) % 3));
  std::sort(all.begin(), all.end());
  for (const auto& [a, b] : all)
    if (!std::binary_search(all.begin(), all.end(), Segment{b, a})) open.emplace_back(a, b);
  return open;
}

Segments on_plane(const Segments& segments, int axis, int at) {
  Segments some;
  for (const Segment& s : segments)
    if (s.first[axis] == at && s.second[axis] == at) some.push_back(s);
  return some;
}

int along(const LatticeNode& n, int axis) { return axis == 0 ? n.x : axis == 1 ? n.y : n.z; }

// No facet comes twice or is flat by its points, no edge has two facets that run it alike, and the facets end on the cell's faces.
void expect_sound(const TriangleSoup& soup, const Cell& cell) {
  const TriangleSoup welded = weld(soup);
  std::set<Facet> facets;
  for (Facet f : welded.facets) {
    ASSERT_FALSE(repeats_point(f));
    std::sort(f.begin(), f.end());
    ASSERT_TRUE(facets.insert(f).second) << "a facet comes twice";
  }
  const EdgeTable edges(welded);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    ASSERT_FALSE(edges.is_non_manifold(e) || edges.is_misoriented(e));
    if (!edges.is_open(e)) continue;
    const Vec3 &a = welded.points[edges.edge(e)[0]], &b = welded.points[edges.edge(e)[1]];
    bool on_face = false;
    for (int axis = 0; axis < 3; ++axis)
      for (const int at : {along(cell.low, axis), along(cell.low, axis) + cell.size}) on_face = on_face || (a[axis] == at && b[axis] == at);
    ASSERT_TRUE(on_face) << "open within the cell";
  }
}

// The cells across a face of a cell: one, or those of a quarter of its size.
std::vector<Cell> cells_across(const Octree& tree, const Cell& cell, int axis, bool upper) {
  std::vector<Cell> cells;
  for (int v = 0; v < cell.size; ++v)
    for (int u = 0; u < cell.size; ++u) {
      std::array<int, 3> at{cell.low.x, cell.low.y, cell.low.z};
      at[static_cast<std::size_t>(axis)] += upper ? cell.size : -1;
      at[static_cast<std::size_t>((axis + 1) % 3)] += u;
      at[static_cast<std::size_t>((axis + 2) % 3)] += v;
      const Cell other = cell_at(tree, {at[0], at[1], at[2]});
      const auto is_same = [&](const Cell& c) { return to_vec(c.low) == to_vec(other.low); };
      if (std::none_of(cells.begin(), cells.end(), is_same)) cells.push_back(other);
    }
  return cells;
}

// On a face, the neighbours' facets end where this cell's do, run the other way.
void expect_fits(const Octree& tree, const Field<double>& phi, const Cell& cell, int axis, bool upper) {
  const int at = along(cell.low, axis) + (upper ? cell.size : 0);
  Segments theirs;
  for (const Cell& other : cells_across(tree, cell, axis, upper)) {
    const Segments open = on_plane(open_segments(cut(tree, phi, other)), axis, at);
    theirs.insert(theirs.end(), open.begin(), open.end());
  }
  const Segments ours = on_plane(open_segments(cut(tree, phi, cell)), axis, at);
  ASSERT_EQ(ours, reversed(theirs)) << "axis " << axis << (upper ? " upper" : " lower");
}

// Values that some leaf stores at the nodes of a cell, half a cell apart, with their places 0..26.
struct StoredValue {
  int slot;
  double* value;
};

std::vector<StoredValue> stored_values(const Octree& tree, Field<double>& phi, const Cell& cell) {
  std::vector<StoredValue> stored;
  for (int slot = 0; slot < 27; ++slot) {
    const std::array<int, 3> half{slot % 3, slot / 3 % 3, slot / 9};
    if (cell.size == 1 && (half[0] == 1 || half[1] == 1 || half[2] == 1)) continue;
    const LatticeNode at{cell.low.x + half[0] * cell.size / 2, cell.low.y + half[1] * cell.size / 2, cell.low.z + half[2] * cell.size / 2};
    const Cell holder = cell_at(tree, at);
    if (to_vec(holder.low) != to_vec(at)) continue;  // no leaf stores it
    const LatticeNode first = lattice_node(tree, holder.leaf, 0, 0, 0);
    stored.push_back({slot, phi.block(holder.leaf) + node_index((at.x - first.x) / holder.size, (at.y - first.y) / holder.size, (at.z - first.z) / holder.size)});
  }
  return stored;
}

class Values {
 public:
  explicit Values(std::uint64_t seed) : random_(seed) {}

  void set(double* value, bool inside) {
    const double size = 0.1 + 0.01 * static_cast<double>(random_() % 90);
    *value = inside ? size : -size;
  }
  bool draw() { return random_() % 2; }

 private:
  std::mt19937_64 random_;
};

// Facets look away from a corner that is inside alone, and towards one that is outside alone.
void expect_outwards(const TriangleSoup& soup, const Vec3& corner, bool inside) {
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const double away = dot(facet_normal_2a(soup, f), soup.corner(f, 0) - corner);
    ASSERT_GT(inside ? away : -away, 0);
  }
}

TEST(CellSigns, AllOfAKuhnCell) {
  const Octree tree = Octree::build(1, test::all_blocks(1));
  const Cell cell = cell_at(tree, {7, 7, 7});  // its corners are in all eight leaves
  Values values(1);
  for (unsigned signs = 0; signs < 256; ++signs) {
    SCOPED_TRACE(::testing::Message() << "signs " << signs);
    Field<double> phi(tree.size(), 0);
    for (double& v : phi.values()) values.set(&v, values.draw());
    const auto nodes = stored_values(tree, phi, cell);
    ASSERT_EQ(nodes.size(), 8u);
    for (std::size_t n = 0; n < 8; ++n) values.set(nodes[n].value, signs >> n & 1);
    const TriangleSoup soup = cut(tree, phi, cell);
    EXPECT_EQ(soup.facets.empty(), signs == 0 || signs == 255);
    expect_sound(soup, cell);
    for (int n = 0; n < 8; ++n)
      if (signs == 1u << n || signs == (255u & ~(1u << n)))
        expect_outwards(soup, to_vec(cell.low) + to_vec({n & 1, n >> 1 & 1, n >> 2}), signs == 1u << n);
    for (int axis = 0; axis < 3; ++axis)
      for (const bool upper : {false, true}) expect_fits(tree, phi, cell, axis, upper);
    if (HasFatalFailure()) return;
  }
}

// A leaf of level 1 whose cell at `corner` meets finer leaves: `finer` as bits (|dx| + 2 |dy| + 4 |dz|) - 1, from that corner on.
struct Split {
  Octree tree;
  Cell cell;
};

Split split(unsigned finer, unsigned corner) {
  std::vector<std::uint64_t> finest;
  for (unsigned toward = 1; toward < 8; ++toward) {
    const auto block = [&](unsigned axis) { return toward >> axis & 1 ? (corner >> axis & 1 ? 4u : 1u) : 2u; };
    if (finer >> (toward - 1) & 1) finest.push_back(morton::interleave({block(0), block(1), block(2)}));
  }
  Split made{Octree::build(3, finest), {}};
  const auto at = [&](unsigned axis) { return corner >> axis & 1 ? 30 : 16; };
  made.cell = cell_at(made.tree, {at(0), at(1), at(2)});
  return made;
}

// Whether any leaf at a slot of a cell of level 1 is finer.
bool is_finer_at(const Octree& tree, const Cell& cell, int slot) {
  for (int n = 0; n < 8; ++n)
    if (cell_at(tree, {cell.low.x + slot % 3 - (n & 1), cell.low.y + slot / 3 % 3 - (n >> 1 & 1), cell.low.z + slot / 9 - (n >> 2)}).size == 1) return true;
  return false;
}

bool on_face(int slot, int axis, bool upper) {
  const std::array<int, 3> at{slot % 3, slot / 3 % 3, slot / 9};
  return at[static_cast<std::size_t>(axis)] == 2 * upper;
}

// Which face it is, which of its edges are split, whether it is itself, and which of its nodes are stored: what its triangles depend on.
std::array<unsigned, 3> face_state(const Split& made, const std::vector<StoredValue>& nodes, int axis, bool upper) {
  std::array<unsigned, 3> state{static_cast<unsigned>(2 * axis + upper), 0, 0};
  for (int slot = 0; slot < 27; ++slot)
    if (on_face(slot, axis, upper)) state[1] |= static_cast<unsigned>(is_finer_at(made.tree, made.cell, slot)) << slot;
  for (const StoredValue& n : nodes)
    if (on_face(n.slot, axis, upper)) state[2] |= 1u << n.slot;
  return state;
}

// Facets end on a face by its own nodes alone: every state that a face can have, once, with all signs of its nodes (up to 2^9).
TEST(CellSigns, AllOfEveryFaceOfATransitionCell) {
  std::set<std::array<unsigned, 3>> seen;
  std::size_t patterns = 0;
  for (unsigned corner = 0; corner < 8; ++corner)
    for (unsigned finer = 1; finer < 64; ++finer) {  // a finer leaf at the corner alone splits nothing
      const Split made = split(finer, corner);
      ASSERT_EQ(made.cell.size, 2);
      Field<double> phi(made.tree.size(), -1);
      const auto nodes = stored_values(made.tree, phi, made.cell);
      Values values(64 * corner + finer);
      for (int axis = 0; axis < 3; ++axis)
        for (const bool upper : {false, true}) {
          if (!seen.insert(face_state(made, nodes, axis, upper)).second) continue;
          std::vector<double*> own;
          for (const StoredValue& n : nodes)
            if (on_face(n.slot, axis, upper)) own.push_back(n.value);
          for (unsigned signs = 0; signs < 1u << own.size(); ++signs, ++patterns) {
            SCOPED_TRACE(::testing::Message() << "corner " << corner << " finer " << finer << " signs " << signs);
            for (const StoredValue& n : nodes) values.set(n.value, values.draw());
            for (std::size_t n = 0; n < own.size(); ++n) values.set(own[n], signs >> n & 1);
            expect_fits(made.tree, phi, made.cell, axis, upper);
            if (HasFatalFailure()) return;
          }
        }
    }
  EXPECT_EQ(seen.size(), 144u);
  EXPECT_GT(patterns, 6000u);
}

// The cell itself: all signs of its stored nodes where they are twelve at most; where they are more, up to twenty, a thousand are drawn.
TEST(CellSigns, OfATransitionCellAsAWhole) {
  constexpr std::size_t kAll = 12, kDrawn = 1000;
  std::size_t complete = 0;
  for (unsigned finer = 1; finer < 64; ++finer) {
    const Split made = split(finer, finer % 8);
    Field<double> phi(made.tree.size(), -1);
    const auto nodes = stored_values(made.tree, phi, made.cell);
    complete += nodes.size() <= kAll;
    const std::size_t count = nodes.size() <= kAll ? std::size_t{1} << nodes.size() : kDrawn;
    Values values(finer);
    for (std::size_t signs = 0; signs < count; ++signs) {
      SCOPED_TRACE(::testing::Message() << "finer " << finer << " signs " << signs << " seed " << finer);
      for (std::size_t n = 0; n < nodes.size(); ++n) values.set(nodes[n].value, nodes.size() <= kAll ? signs >> n & 1 : values.draw());
      expect_sound(cut(made.tree, phi, made.cell), made.cell);
      if (HasFatalFailure()) return;
    }
  }
  EXPECT_GE(complete, 15u);
}

}  // namespace
}  // namespace burnish::detail
