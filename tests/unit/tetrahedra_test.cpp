#include "tetrahedra.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <map>
#include <random>
#include <set>
#include <utility>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "transition_cells.h"
#include "support/repetitions.h"

namespace burnish::detail {
namespace {

// A surface vertex: the tetrahedron's corners it lies between, twice the same for a corner on the surface.
using Label = std::pair<int, int>;
using LabelledFacet = std::array<Label, 3>;
using Corners = std::array<Vec3, 4>;

constexpr Corners kCorners{{{0, 0, 0}, {1, 0.2, 0.1}, {0.1, 1, 0.3}, {0.2, -0.1, 1}}};
constexpr std::array<double, 4> kMagnitudes{0.3, 1.7, 0.9, 0.6};

std::size_t index(int i) { return static_cast<std::size_t>(i); }

double determinant(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  return dot(b - a, cross(c - a, d - a));
}

std::vector<LabelledFacet> facets_of(const std::array<Side, 4>& side, bool opposite_out, bool along_first) {
  std::vector<LabelledFacet> facets;
  cut_tetrahedron(
      side,
      [&](int i, int j) {
        if (side[index(i)] == kOn) return Label{i, i};
        if (side[index(j)] == kOn) return Label{j, j};
        return Label{std::min(i, j), std::max(i, j)};
      },
      [&](int) { return opposite_out; }, [&](auto...) { return along_first; },
      [&](const Label& a, const Label& b, const Label& c) { facets.push_back({a, b, c}); });
  return facets;
}

Vec3 position(const Label& v, const std::array<Side, 4>& side) {
  const auto [i, j] = v;
  if (i == j) return kCorners[index(i)];
  const double p = side[index(i)] * kMagnitudes[index(i)], q = side[index(j)] * kMagnitudes[index(j)];
  return kCorners[index(i)] + p / (p - q) * (kCorners[index(j)] - kCorners[index(i)]);
}

template <class Body>
void for_all_sides(Body&& body) {
  for (int n = 0; n < 81; ++n) {
    std::array<Side, 4> side{};
    for (int i = 0, rest = n; i < 4; ++i, rest /= 3) side[index(i)] = static_cast<Side>(rest % 3 - 1);
    SCOPED_TRACE(::testing::Message() << "sides " << +side[0] << ' ' << +side[1] << ' ' << +side[2] << ' ' << +side[3]);
    body(side);
  }
}

std::size_t count(const std::array<Side, 4>& sides, Side side) {
  return static_cast<std::size_t>(std::count(sides.begin(), sides.end(), side));
}

TEST(CutTetrahedron, FacetsSeparateInsideFromOutside) {
  ASSERT_GT(determinant(kCorners[0], kCorners[1], kCorners[2], kCorners[3]), 0);
  for_all_sides([](const std::array<Side, 4>& side) {
    const std::size_t in = count(side, kIn), out = count(side, kOut), on = count(side, kOn);
    for (const bool opposite_out : {false, true})
      for (const bool along_first : {false, true}) {
        const auto facets = facets_of(side, opposite_out, along_first);
        const std::size_t expected = in == 2 && out == 2                  ? 2
                                     : in > 0 && out > 0                  ? 1
                                     : in == 1 && on == 3 && opposite_out ? 1
                                                                          : 0;
        ASSERT_EQ(facets.size(), expected);
        for (const LabelledFacet& facet : facets) {
          const Vec3 a = position(facet[0], side), b = position(facet[1], side), c = position(facet[2], side);
          const Vec3 n = cross(b - a, c - a);
          ASSERT_GT(norm(n), 1e-3);
          for (int i = 0; i < 4; ++i) {
            const double above = dot(n, kCorners[index(i)] - a) / norm(n);
            if (side[index(i)] == kIn) { EXPECT_LT(above, -1e-3) << "corner " << i; }
            if (side[index(i)] == kOut) { EXPECT_GT(above, 1e-3) << "corner " << i; }
            if (side[index(i)] == kOn) { EXPECT_NEAR(above, 0, 1e-12) << "corner " << i; }
          }
        }
      }
  });
}

TEST(CutTetrahedron, QuadrilateralIsCutAlongTheDiagonalAskedFor) {
  const std::array<Side, 4> side{kIn, kIn, kOut, kOut};
  std::set<std::set<Label>> diagonals;
  for (const bool along_first : {false, true}) {
    const auto facets = facets_of(side, false, along_first);
    std::set<Label> shared;
    for (const Label& v : facets[0])
      if (std::find(facets[1].begin(), facets[1].end(), v) != facets[1].end()) shared.insert(v);
    ASSERT_EQ(shared.size(), 2u);
    diagonals.insert(shared);
  }
  EXPECT_EQ(diagonals, (std::set<std::set<Label>>{{{0, 2}, {1, 3}}, {{0, 3}, {1, 2}}}));
}

using Segment = std::pair<std::set<int>, std::set<int>>;  // two vertices, each by the nodes it lies between

// The directed segments of the surface inside the face of nodes 0, 1, 2. Along an edge of the face, between two nodes on
// the surface, more than two tetrahedra meet: these do not count here.
std::multiset<Segment> segments_in_face(const std::array<Side, 4>& side, const std::array<int, 4>& nodes) {
  std::multiset<Segment> segments;
  for (const LabelledFacet& facet : facets_of(side, false, true))
    for (std::size_t k = 0; k < 3; ++k) {
      const auto nodes_of = [&](const Label& v) { return std::set<int>{nodes[index(v.first)], nodes[index(v.second)]}; };
      const std::set<int> a = nodes_of(facet[k]), b = nodes_of(facet[(k + 1) % 3]);
      const bool in_face = !a.contains(3) && !b.contains(3);
      if (in_face && (a.size() == 2 || b.size() == 2)) segments.insert({a, b});
    }
  return segments;
}

// Two tetrahedra on a common face, in all ways to number their corners: what one's facets leave open there, the other's
// close, in the opposite direction.
TEST(CutTetrahedron, FitsItsNeighbourForAllSides) {
  std::vector<std::array<int, 4>> even, odd;  // orders of the nodes 0, 1, 2 of the face and the apex 3
  std::array<int, 4> order{0, 1, 2, 3};
  do {
    int inversions = 0;
    for (std::size_t i = 0; i < 4; ++i)
      for (std::size_t j = 0; j < i; ++j) inversions += order[j] > order[i];
    (inversions % 2 ? odd : even).push_back(order);
  } while (std::next_permutation(order.begin(), order.end()));
  for_all_sides([&](const std::array<Side, 4>& nodes) {
    for (const Side other_apex : {kIn, kOn, kOut}) {
      std::set<std::multiset<Segment>> below, above;
      for (const auto& o : even)
        below.insert(segments_in_face({nodes[index(o[0])], nodes[index(o[1])], nodes[index(o[2])], nodes[index(o[3])]}, o));
      const std::array<Side, 4> others{nodes[0], nodes[1], nodes[2], other_apex};
      for (const auto& o : odd) {
        std::multiset<Segment> reversed;
        for (const auto& [a, b] :
             segments_in_face({others[index(o[0])], others[index(o[1])], others[index(o[2])], others[index(o[3])]}, o))
          reversed.insert({b, a});
        above.insert(reversed);
      }
      ASSERT_EQ(below.size(), 1u);
      EXPECT_EQ(below, above);
    }
  });
}

Vec3 corner_position(int c) {
  return {static_cast<double>(c & 1), static_cast<double>(c >> 1 & 1), static_cast<double>(c >> 2 & 1)};
}

Vec3 to_vec(Step s) { return {static_cast<double>(s.x), static_cast<double>(s.y), static_cast<double>(s.z)}; }

TEST(Kuhn, TetrahedraArePositiveAndFollowTheirPath) {
  for (const KuhnTetrahedron& t : kKuhn) {
    const auto v = [&](std::size_t i) { return corner_position(t.corners[i]); };
    EXPECT_EQ(determinant(v(0), v(1), v(2), v(3)), 1);
    std::array<int, 4> sorted = t.corners;
    std::sort(sorted.begin(), sorted.end());
    EXPECT_EQ(sorted, t.path);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_EQ(t.path[i] & t.path[i + 1], t.path[i]) << "an edge that does not go upwards";
  }
}

TEST(Kuhn, TetrahedraFillTheCube) {
  std::mt19937 engine(5);
  for (int round = 0; round < 10'000; ++round) {
    const auto next = [&] { return static_cast<double>(engine()) * 0x1p-32; };
    const Vec3 p{next(), next(), next()};
    int holders = 0;
    for (const KuhnTetrahedron& t : kKuhn) {
      Corners v;
      for (std::size_t i = 0; i < 4; ++i) v[i] = corner_position(t.corners[i]);
      bool inside = true;
      for (std::size_t i = 0; i < 4; ++i) {
        Corners w = v;
        w[i] = p;
        inside = inside && determinant(w[0], w[1], w[2], w[3]) > 0;
      }
      holders += inside;
    }
    ASSERT_EQ(holders, 1);
  }
}

TEST(Kuhn, FacesMatchWithinTheCubeAndAcrossItsSides) {
  std::map<std::set<int>, int> uses;
  for (const KuhnTetrahedron& t : kKuhn)
    for (std::size_t skip = 0; skip < 4; ++skip) {
      std::set<int> face(t.corners.begin(), t.corners.end());
      face.erase(t.corners[skip]);
      ++uses[face];
    }
  for (int axis = 0; axis < 3; ++axis) {
    const int bit = 1 << axis;
    std::set<std::set<int>> low, high;
    for (const auto& [face, count] : uses) {
      const auto has_bit = [&](int c) { return (c & bit) != 0; };
      if (std::none_of(face.begin(), face.end(), has_bit)) {
        EXPECT_EQ(count, 1);
        low.insert(face);
      } else if (std::all_of(face.begin(), face.end(), has_bit)) {
        EXPECT_EQ(count, 1);
        std::set<int> shifted;
        for (const int c : face) shifted.insert(c & ~bit);
        high.insert(shifted);
      }
    }
    EXPECT_EQ(low.size(), 2u);
    EXPECT_EQ(low, high);
  }
  EXPECT_EQ(std::count_if(uses.begin(), uses.end(), [](const auto& use) { return use.second == 2; }), 6);
  EXPECT_EQ(uses.size(), 6u + 12u);
}

TEST(Kuhn, EdgeNumbersFollowTheSteps) {
  for (int a = 0; a < 8; ++a)
    for (int b = 0; b < 8; ++b) {
      if ((a & b) != a || a == b) continue;
      EXPECT_EQ(corner_position(b) - corner_position(a), to_vec(kEdgeSteps[index(edge_number(a, b))]));
    }
}

TEST(Star, TwentyFourTetrahedraAroundANode) {
  std::set<std::array<int, 3>> triangles;
  std::map<std::set<int>, int> edges;
  std::set<int> nodes;
  for (const StarTetrahedron& t : kStar) {
    Corners v;
    std::vector<int> link;
    for (std::size_t i = 0; i < 4; ++i) {
      v[i] = t[i] < 0 ? Vec3{} : to_vec(neighbor_step(t[i]));
      if (t[i] >= 0) link.push_back(t[i]);
    }
    EXPECT_EQ(determinant(v[0], v[1], v[2], v[3]), 1);
    ASSERT_EQ(link.size(), 3u);
    std::sort(link.begin(), link.end());
    triangles.insert({link[0], link[1], link[2]});
    nodes.insert(link.begin(), link.end());
    for (std::size_t i = 0; i < 3; ++i) ++edges[{link[i], link[(i + 1) % 3]}];
  }
  // The link is a sphere: 14 - 36 + 24 = 2, every edge between two triangles.
  EXPECT_EQ(triangles.size(), 24u);
  EXPECT_EQ(nodes.size(), static_cast<std::size_t>(kNeighbors));
  EXPECT_EQ(edges.size(), 36u);
  for (const auto& [edge, uses] : edges) EXPECT_EQ(uses, 2);
}

TEST(Star, NeighborNumbersAreTheirSteps) {
  for (int k = 0; k < kNeighbors; ++k) {
    EXPECT_EQ(neighbor_number(neighbor_step(k)), k);
    EXPECT_EQ(neighbor_number(negative(neighbor_step(k))), (k + 7) % 14);
  }
  EXPECT_EQ(neighbor_number({1, -1, 0}), -1);
}

struct CellOfLeaf {
  std::size_t leaf;
  LatticeNode cell;
};

// The cells of all levels that overlap a cube.
std::vector<CellOfLeaf> cells_in(const Octree& tree, int low, int high) {
  std::vector<CellOfLeaf> cells;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
      const LatticeNode cell = lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64);
      const int size = 1 << tree.level(leaf);
      if (std::min({cell.x, cell.y, cell.z}) + size > low && std::max({cell.x, cell.y, cell.z}) < high) cells.push_back({leaf, cell});
    }
  return cells;
}

// The nodes of one cell, half a cell apart, that some leaf stores: pointers to their values, corners first.
std::vector<double*> stored_nodes(const Octree& tree, Field<double>& phi, const LatticeNode& cell) {
  std::vector<double*> corners, hanging;
  for (int n = 0; n < 27; ++n) {
    const LatticeNode at{cell.x + n % 3, cell.y + n / 3 % 3, cell.z + n / 9};
    const auto block = [](int x) { return static_cast<std::uint32_t>(x) / kBlockSide; };
    const std::uint32_t leaf = tree.find({block(at.x), block(at.y), block(at.z)});
    const LatticeNode first = lattice_node(tree, leaf, 0, 0, 0);
    const int level = tree.level(leaf), x = at.x - first.x, y = at.y - first.y, z = at.z - first.z;
    if ((x | y | z) & ((1 << level) - 1)) continue;
    const bool is_corner = n % 3 != 1 && n / 3 % 3 != 1 && n / 9 != 1;
    (is_corner ? corners : hanging).push_back(phi.block(leaf) + node_index(x >> level, y >> level, z >> level));
  }
  corners.insert(corners.end(), hanging.begin(), hanging.end());
  return corners;
}

// Every set of finer leaves that a cell at a leaf's upper corner can meet, as bits (|dx| + 2 |dy| + 4 |dz|) - 1, with its corners in all
// 2^8 ways and signs of its hanging nodes drawn: closed, a manifold, oriented, whatever the cells around it are.
// Under sanitizers every fourth of the signs, others for each split.
TEST(TransitionCells, EverySplitWithEverySignOfItsCorners) {
  constexpr auto kStep = static_cast<unsigned>(test::repetitions(1, 4));
  std::size_t cut = 0;
  for (unsigned finer = 1; finer < 128; ++finer) {
    std::vector<std::uint64_t> finest;
    for (unsigned toward = 1; toward < 8; ++toward) {
      const auto block = [&](unsigned axis) { return toward >> axis & 1 ? 4u : 2u; };
      if (finer >> (toward - 1) & 1) finest.push_back(morton::interleave({block(0), block(1), block(2)}));
    }
    const Octree tree = Octree::build(3, finest);
    ASSERT_EQ(tree.level(tree.find({2, 2, 2})), 1);
    Field<double> phi(tree.size(), -1.0);
    const auto nodes = stored_nodes(tree, phi, {30, 30, 30});
    const auto cells = cells_in(tree, 28, 36);
    std::mt19937_64 random(finer);
    for (unsigned signs = finer % kStep; signs < 256; signs += kStep) {
      for (std::size_t n = 0; n < nodes.size(); ++n) {
        const double size = 0.1 + 0.01 * static_cast<double>(random() % 90);
        *nodes[n] = (n < 8 ? signs >> n & 1 : random() % 2) ? size : -size;
      }
      TriangleSoup cut_cells;
      for (const auto& [leaf, cell] : cells) cut_transition_cell(tree, phi, {}, leaf, cell, cut_cells);
      const TriangleSoup soup = weld(std::move(cut_cells));
      for (double* node : nodes) *node = -1;
      if (soup.facets.empty()) continue;
      ++cut;
      const Defects d = inspect(soup, {.self_intersections = false}).defects;
      ASSERT_TRUE(d.closed_manifold()) << "finer " << finer << " signs " << signs << " seed " << finer << " open " << d.open_edges;
      ASSERT_GT(d.volume, 0);
    }
  }
  EXPECT_GT(cut, 127u * (256 / kStep - 2));
}

}  // namespace
}  // namespace burnish::detail
