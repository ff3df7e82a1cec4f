#include "burnish/surface/weld.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <random>
#include <tuple>

#include "burnish/surface/edge_table.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

std::size_t open_edge_count(const TriangleSoup& soup) {
  const EdgeTable edges(soup);
  std::size_t count = 0;
  for (std::size_t e = 0; e < edges.size(); ++e) count += edges.is_open(e);
  return count;
}

TEST(Weld, JoinsEqualPointsInOrderOfFirstUse) {
  const TriangleSoup soup = unwelded(cube());
  const TriangleSoup welded = weld(soup);
  ASSERT_EQ(welded.points.size(), 8u);
  ASSERT_EQ(welded.facets.size(), 12u);
  std::uint32_t next = 0;
  for (std::size_t f = 0; f < 12; ++f)
    for (int i = 0; i < 3; ++i) {
      const std::uint32_t p = welded.facets[f][static_cast<std::size_t>(i)];
      ASSERT_LE(p, next);
      if (p == next) ++next;
      EXPECT_EQ(welded.corner(f, i), soup.corner(f, i));
    }
  EXPECT_DOUBLE_EQ(signed_volume(welded), 1);
}

TEST(Weld, MovedSoupGivesTheSame) {
  const TriangleSoup soup = unwelded(icosphere(2));
  const TriangleSoup a = weld(soup), b = weld(TriangleSoup(soup));
  EXPECT_EQ(a.points, b.points);
  EXPECT_EQ(a.facets, b.facets);
}

TEST(Weld, ZerosOfBothSignsAreEqual) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {-0.0, 0, -0.0}};
  soup.facets = {{0, 1, 2}, {3, 1, 2}};
  const TriangleSoup welded = weld(soup);
  EXPECT_EQ(welded.points.size(), 3u);
  EXPECT_EQ(welded.facets[0], welded.facets[1]);
}

TEST(Weld, NeighbouringDoublesStayApart) {
  TriangleSoup soup;
  soup.points = {{1, 0, 0}, {std::nextafter(1.0, 2.0), 0, 0}, {0, 1, 0}};
  soup.facets = {{0, 1, 2}};
  EXPECT_EQ(weld(soup).points.size(), 3u);
}

TEST(Weld, DropsUnusedPointsAndKeepsGroups) {
  TriangleSoup soup = without_facets(cube(), {0, 1, 4, 5, 8, 9});  // all facets around point 0
  soup.groups = {{"a", 0, 2}, {"b", 2, 4}};
  const TriangleSoup welded = weld(soup);
  EXPECT_EQ(welded.points.size(), 7u);
  EXPECT_EQ(welded.groups.size(), 2u);
  EXPECT_EQ(welded.groups[1].facet_count, 4u);
}

TEST(Weld, EmptySoup) {
  EXPECT_TRUE(weld(TriangleSoup{}).points.empty());
  EXPECT_EQ(EdgeTable(TriangleSoup{}).size(), 0u);
}

TEST(Weld, AgreesWithAnOrderedMapOnRandomSoups) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    TriangleSoup soup;
    for (std::uint32_t i = 0; i < 30000; ++i)
      soup.points.push_back({static_cast<double>(random() % 20) - 10, static_cast<double>(random() % 20) / 16,
                             std::ldexp(1.0, static_cast<int>(random() % 9))});
    for (std::uint32_t f = 0; f < 10000; ++f) soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
    const TriangleSoup welded = weld(soup);
    std::map<Vec3, std::uint32_t> numbers;
    for (std::size_t f = 0; f < soup.facets.size(); ++f)
      for (int i = 0; i < 3; ++i) {
        const auto next = static_cast<std::uint32_t>(numbers.size());
        const auto at = numbers.try_emplace(soup.corner(f, i), next).first;
        ASSERT_EQ(welded.facets[f][static_cast<std::size_t>(i)], at->second);
      }
    EXPECT_EQ(welded.points.size(), numbers.size());
  }
}

TEST(EdgeTable, ClosedShapeHasEachEdgeOnceInBothDirections) {
  const TriangleSoup soup = icosphere(3);
  const EdgeTable edges(soup);
  EXPECT_EQ(edges.size(), soup.facets.size() * 3 / 2);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    ASSERT_EQ(edges.uses(e).size(), 2u);
    ASSERT_NE(edges.uses(e)[0].forward, edges.uses(e)[1].forward);
    ASSERT_LT(edges.edge(e)[0], edges.edge(e)[1]);
    if (e > 0) { ASSERT_LT(edges.edge(e - 1), edges.edge(e)); }
    for (const EdgeUse& use : edges.uses(e)) {
      const std::uint32_t from = soup.facets[use.facet][use.side];
      const std::uint32_t to = soup.facets[use.facet][(use.side + 1u) % 3];
      ASSERT_EQ(edges.edge(e), (use.forward ? Edge{from, to} : Edge{to, from}));
    }
  }
}

TEST(EdgeTable, TransposeIsTheReverse) {
  TriangleSoup soup = torus(12, 7);
  soup.facets.push_back({0, 0, 1});
  const EdgeTable edges(soup);
  const auto of_facets = edges.edges_of_facets();
  for (std::uint32_t e = 0; e < edges.size(); ++e)
    for (const EdgeUse& use : edges.uses(e)) EXPECT_EQ(of_facets[use.facet][use.side], e);
  EXPECT_EQ(of_facets.back()[0], EdgeTable::kNoEdge);
}

TEST(WeldBoundaries, ClosesACrackAndMovesNothingElse) {
  // Two halves of a sphere, one shifted by less than the tolerance.
  const TriangleSoup sphere = icosphere(3);
  std::vector<std::size_t> upper, lower;
  for (std::size_t f = 0; f < sphere.facets.size(); ++f)
    (sphere.corner(f, 0).z + sphere.corner(f, 1).z + sphere.corner(f, 2).z > 0 ? upper : lower).push_back(f);
  const TriangleSoup halves = weld(
      merged(without_facets(sphere, lower), moved(without_facets(sphere, upper), {1e-4, -2e-4, 3e-4})));
  ASSERT_GT(open_edge_count(halves), 0u);
  const WeldedNear tight = weld_boundaries(halves, 1e-5);
  EXPECT_EQ(tight.points_moved, 0u);
  EXPECT_EQ(open_edge_count(tight.soup), open_edge_count(halves));
  const WeldedNear closed = weld_boundaries(halves, 1e-3);
  EXPECT_EQ(open_edge_count(closed.soup), 0u);
  EXPECT_EQ(closed.points_moved, halves.points.size() - closed.soup.points.size());
  EXPECT_EQ(closed.soup.points.size(), sphere.points.size());
}

TEST(WeldBoundaries, NeverCollapsesAFacet) {
  const TriangleSoup open = weld(without_facets(icosphere(2), {3, 70, 71}));
  const WeldedNear result = weld_boundaries(open, 10);  // far larger than any facet
  EXPECT_GT(result.points_moved, 0u);
  for (const Facet& facet : result.soup.facets) EXPECT_FALSE(repeats_point(facet));
}

TEST(WeldBoundaries, JoinedPointsLieWithinTheToleranceOfTheirLeader) {
  // A row of separate facets whose tips are 0.6 apart: a chain must not pull all to the first.
  TriangleSoup soup;
  for (std::uint32_t i = 0; i < 10; ++i) {
    const double x = 0.6 * i;
    soup.points.insert(soup.points.end(), {{x, 0, 0}, {x, 100, 50.0 * i}, {x, 100, 50.0 * i + 20}});
    soup.facets.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  const WeldedNear result = weld_boundaries(weld(soup), 1.0);
  EXPECT_EQ(result.points_moved, 5u);
  for (std::size_t f = 0; f < 10; ++f) EXPECT_LE(norm(result.soup.corner(f, 0) - soup.corner(f, 0)), 1.0);
}

TEST(WeldBoundaries, ClosedSoupsAndZeroToleranceAreLeftAlone) {
  EXPECT_EQ(weld_boundaries(weld(cube()), 10).points_moved, 0u);
  EXPECT_EQ(weld_boundaries(weld(without_facets(cube(), {0})), 0).points_moved, 0u);
}

TEST(DropFacets, DegenerateDuplicateAndGroups) {
  TriangleSoup soup = cube();
  soup.points.push_back({0.5, 0, 0});
  soup.facets.insert(soup.facets.begin() + 1, {2, 2, 3});  // repeated point
  soup.facets.push_back({0, 8, 1});                        // collinear
  soup.facets.push_back({3, 2, 0});                        // the first facet, turned around
  soup.facets.push_back({0, 8, 1});                        // degenerate, not a duplicate
  soup.groups = {{"first", 0, 2}, {"second", 2, 11}, {"rest", 13, 3}};
  const CleanedFacets cleaned = drop_degenerate_and_duplicate_facets(weld(soup));
  EXPECT_EQ(cleaned.degenerate, 3u);
  EXPECT_EQ(cleaned.duplicate, 1u);
  EXPECT_EQ(cleaned.soup.facets.size(), 12u);
  EXPECT_EQ(cleaned.soup.points.size(), 8u);
  ASSERT_EQ(cleaned.soup.groups.size(), 3u);
  const std::uint32_t counts[] = {1, 11, 0}, firsts[] = {0, 1, 12};
  for (std::size_t g = 0; g < 3; ++g) {
    EXPECT_EQ(cleaned.soup.groups[g].facet_count, counts[g]);
    EXPECT_EQ(cleaned.soup.groups[g].first_facet, firsts[g]);
  }
}

TEST(DropFacets, CollinearIsDecidedExactly) {
  // (0.1, 0.2, 0.3) doubled is exact; one bit more is not collinear.
  const Vec3 p{0.1, 0.2, 0.3};
  for (const double nudge : {0.0, 1e-300}) {
    TriangleSoup soup;
    soup.points = {{0, 0, 0}, p, p * 2};
    soup.points[0].x = nudge;
    soup.facets = {{0, 1, 2}};
    EXPECT_EQ(drop_degenerate_and_duplicate_facets(soup).degenerate, nudge == 0 ? 1u : 0u);
  }
}

}  // namespace
}  // namespace burnish
