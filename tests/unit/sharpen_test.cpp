// Sharpening: solids with known edges come back with those edges.
#include "burnish/extract/sharpen.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "support/creased_shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kExact = 1e-9;  // cells

TriangleSoup tilted(const TriangleSoup& solid) {
  std::mt19937_64 engine(7);
  return mapped(solid, Rotation::random(engine));
}

void expect_valid(const Sharpened& x) {
  const Defects d = inspect(x.result.soup).defects;
  EXPECT_TRUE(d.valid_solid()) << d.self_intersecting_pairs << " intersections, " << d.open_edges << " open edges";
}

// The creases of the result, folded to triangles {a, b, b}.
TriangleSoup creases_of(const TriangleSoup& soup, double degrees) {
  TriangleSoup edges;
  for (const CreaseEdge& e : find_creases(soup, {.angle = degrees}).edges) {
    const auto first = static_cast<std::uint32_t>(edges.points.size());
    edges.points.insert(edges.points.end(), {soup.points[e.points[0]], soup.points[e.points[1]]});
    edges.facets.push_back({first, first + 1, first + 1});
  }
  return edges;
}

// The farthest that a place of a's creases is from b's, in cells.
double farthest_crease(const TriangleSoup& a, const TriangleSoup& b, double degrees) {
  const TriangleSoup from = creases_of(a, degrees);
  const TriangleIndex to(creases_of(b, degrees));
  double farthest = 0;
  for (std::size_t e = 0; e < from.facets.size(); ++e)
    for (int i = 0; i <= 64; ++i) {
      const Vec3 p = from.corner(e, 0) + (from.corner(e, 1) - from.corner(e, 0)) * (i / 64.0);
      farthest = std::max(farthest, std::sqrt(to.closest(p).squared_distance));
    }
  return farthest;
}

void expect_same_creases(const Sharpened& x, double within) {
  EXPECT_LT(farthest_crease(x.s, x.result.soup, 20), within);
  EXPECT_LT(farthest_crease(x.result.soup, x.s, 20), within);
}

void expect_all_corners(const Sharpened& x) {
  std::size_t corners = 0;
  for (std::size_t v = 0; v < x.result.kind.size(); ++v) {
    if (x.result.kind[v] != SharpenedKind::corner) continue;
    ++corners;
    double nearest = std::numeric_limits<double>::infinity();
    for (const std::uint32_t c : x.creases.corners) nearest = std::min(nearest, norm(x.s.points[c] - x.result.soup.points[v]));
    EXPECT_LT(nearest, kExact);
  }
  EXPECT_EQ(corners, x.creases.corners.size());
}

double relative_volume(const Sharpened& x) { return signed_volume(x.result.soup) / signed_volume(x.s) - 1; }

double farthest_from_reference(const Sharpened& x, const TriangleSoup& soup) {
  const TriangleIndex s(x.s);
  double farthest = 0;
  for (const Vec3& p : soup.points) farthest = std::max(farthest, std::sqrt(s.closest(p).squared_distance));
  return farthest;
}

TEST(Sharpen, ABoxGetsItsEdgesAndCornersBack) {
  const Sharpened x = sharpened(tilted(box({3, 2, 1}, 6, 4, 2)), 1.0 / 16);
  expect_valid(x);
  EXPECT_EQ(x.creases.corners.size(), 8u);
  expect_all_corners(x);
  expect_same_creases(x, kExact);
  EXPECT_LT(farthest_from_reference(x, x.result.soup), kExact);
  EXPECT_NEAR(relative_volume(x), 0, 1e-12);
  EXPECT_EQ(x.result.kept, 0u);
}

TEST(Sharpen, ConcaveEdgesAndCornersWhereBothKindsMeet) {
  const Sharpened x = sharpened(tilted(cubes({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})), 1.0 / 12);
  expect_valid(x);
  expect_all_corners(x);
  expect_same_creases(x, kExact);
  EXPECT_NEAR(relative_volume(x), 0, 1e-12);
}

TEST(Sharpen, APrismOfFiveSides) {
  const Sharpened x = sharpened(tilted(prism(regular_polygon(5, 0.6), 1)), 1.0 / 32);
  expect_valid(x);
  EXPECT_EQ(x.creases.corners.size(), 10u);
  expect_all_corners(x);
  expect_same_creases(x, kExact);
  EXPECT_NEAR(relative_volume(x), 0, 1e-12);
}

// Before an edge of angle a a solid is thinner than a cell for 1 / (2 tan a/2) cells: 0.9 for 60 degrees, 2.8 for 20. The lattice tears that into
// fingers and crumbs. Most of the edge comes back; where it cannot, M stays.
TEST(Sharpen, SharpWedgesAreValidAtLeast) {
  for (const double degrees : {60.0, 20.0}) {
    const Sharpened x = sharpened_and_settled(tilted(wedge(degrees)), 1.0 / 60);
    SCOPED_TRACE(degrees);
    expect_valid(x);
    EXPECT_EQ(x.stuck, 0u);
    EXPECT_NEAR(relative_volume(x), 0, degrees == 60 ? 1e-3 : 2e-2);
  }
}

const CreaseOptions kResolved{.angle = 40, .resolved_angle = 5, .resolved = 1};

TEST(Sharpen, ACylinderHasTwoRims) {
  const Sharpened x = sharpened(tilted(prism(regular_polygon(64, 1), 1)), 1.0 / 24);
  expect_valid(x);
  EXPECT_TRUE(x.creases.corners.empty());
  // Points of the rims lie on them; edges between cut what bends by 5.6 degrees, half an edge to both sides, edges of 1.5 cells at most.
  expect_same_creases(x, 0.75 * std::tan(std::numbers::pi / 64));
  EXPECT_NEAR(relative_volume(x), 0, 5e-4);
}

TEST(Sharpen, ACylinderThatIsAPrismIfAskedTo) {
  const Sharpened x = sharpened(tilted(prism(regular_polygon(64, 1), 1)), 1.0 / 24, kResolved);
  expect_valid(x);
  expect_all_corners(x);
  EXPECT_NEAR(relative_volume(x), 0, 1e-4);
}

TEST(Sharpen, AConeHasOneRimAndATip) {
  const Sharpened x = sharpened_and_settled(tilted(cone(96)), 1.0 / 24);
  expect_valid(x);
  EXPECT_LT(points_on_m(x), x.m.points.size() / 20);
  EXPECT_NEAR(relative_volume(x), 0, 3e-3);
}

TEST(Sharpen, ARidgeThatFadesOutEndsWithinACell) {
  const Sharpened x = sharpened(tilted(block_with_fading_ridge(8, 0.9)), 1.0 / 24, {.angle = 40});
  expect_valid(x);
  expect_all_corners(x);
  EXPECT_LT(farthest_from_reference(x, x.result.soup), kExact);
  const TriangleIndex sharp(creases_of(x.result.soup, 30));
  for (const CreaseEdge& e : x.creases.edges)
    EXPECT_LT(std::sqrt(sharp.closest((x.s.points[e.points[0]] + x.s.points[e.points[1]]) * 0.5).squared_distance), 0.05);
}

TEST(Sharpen, WithoutCreasesVerticesGoToTheirClosestPoints) {
  const Sharpened x = sharpened(icosphere(4), 1.0 / 16);
  EXPECT_TRUE(x.creases.empty());
  expect_valid(x);
  EXPECT_EQ(x.result.cut, 0u);
  EXPECT_LT(farthest_from_reference(x, x.result.soup), kExact);
  EXPECT_GT(farthest_from_reference(x, x.m), 1e-3);
}

TEST(Sharpen, WhatStaysIsNotTouched) {
  const TriangleSoup solid = tilted(box({1, 1, 1}, 2, 2, 2));
  const std::size_t count = sharpened(solid, 1.0 / 16).m.points.size();
  const std::vector<std::uint8_t> all(count, 1);
  const Sharpened x = sharpened(solid, 1.0 / 16, {}, all);
  EXPECT_EQ(x.result.soup.points, x.m.points);
  EXPECT_EQ(x.result.soup.facets, x.m.facets);
  EXPECT_EQ(x.result.kept, count);
}

TEST(Sharpen, VerticesThatStayKeepTheirPlacesAndEdges) {
  const TriangleSoup solid = tilted(box({1, 1, 1}, 2, 2, 2));
  const Sharpened whole = sharpened(solid, 1.0 / 16);
  std::vector<std::uint8_t> half(whole.m.points.size());
  const Vec3 middle = bounding_box(whole.m).center();
  for (std::size_t v = 0; v < half.size(); ++v) half[v] = whole.m.points[v].x < middle.x;
  const Sharpened x = sharpened(solid, 1.0 / 16, {}, half);
  expect_valid(x);
  std::vector<std::uint32_t> place(half.size(), kNoFacet);
  for (std::uint32_t v = 0; v < x.result.parents.size(); ++v)
    if (x.result.parents[v][0] == x.result.parents[v][1]) place[x.result.parents[v][0]] = v;
  const EdgeTable edges(x.result.soup);
  std::vector<Edge> there;
  for (std::size_t e = 0; e < edges.size(); ++e) there.push_back(edges.edge(e));
  for (const Facet& f : x.m.facets)
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t u = f[i], v = f[(i + 1) % 3];
      if (!half[u]) continue;
      ASSERT_NE(place[u], kNoFacet);
      EXPECT_EQ(x.result.soup.points[place[u]], x.m.points[u]);
      ASSERT_NE(place[v], kNoFacet) << "a neighbour is gone";
      EXPECT_TRUE(std::binary_search(there.begin(), there.end(), Edge{std::min(place[u], place[v]), std::max(place[u], place[v])}));
    }
}

TEST(Sharpen, FarVerticesStay) {
  const TriangleSoup solid = tilted(box({1, 1, 1}, 2, 2, 2));
  const GridFrame frame = make_frame(bounding_box(solid), 1.0 / 16, 8);
  const TriangleSoup m = extract_surface(level_set_from_triangles(solid, frame).level_set).soup;
  const TriangleSoup s = moved(to_lattice(solid, frame), {1000, 0, 0});
  const SharpenedSurface result = sharpen(m, ReferenceSurface(s, find_creases(s)));
  EXPECT_EQ(result.soup.points, m.points);
  EXPECT_EQ(result.moved, 0u);
}

TEST(Sharpen, ParentsAreVerticesOrEdgesOfTheInput) {
  const Sharpened x = sharpened(tilted(cubes({{0, 0, 0}, {1, 0, 0}})), 1.0 / 12);
  const EdgeTable table(x.m);
  std::vector<Edge> edges;
  for (std::size_t e = 0; e < table.size(); ++e) edges.push_back(table.edge(e));
  ASSERT_EQ(x.result.parents.size(), x.result.soup.points.size());
  for (std::size_t v = 0; v < x.result.parents.size(); ++v) {
    const auto [a, b] = x.result.parents[v];
    EXPECT_TRUE(a == b || std::binary_search(edges.begin(), edges.end(), Edge{std::min(a, b), std::max(a, b)}));
    EXPECT_LT(std::min(norm(x.m.points[a] - x.result.soup.points[v]), norm(x.m.points[b] - x.result.soup.points[v])), 3);
  }
}

TEST(Sharpen, FacetsAreWellShaped) {
  const Sharpened x = sharpened(tilted(cubes({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}})), 1.0 / 24);
  std::size_t thin = 0;
  for (std::size_t f = 0; f < x.result.soup.facets.size(); ++f) {
    double least = 180;
    for (int i = 0; i < 3; ++i) {
      const Vec3 a = x.result.soup.corner(f, (i + 1) % 3) - x.result.soup.corner(f, i), b = x.result.soup.corner(f, (i + 2) % 3) - x.result.soup.corner(f, i);
      least = std::min(least, std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi);
    }
    thin += least < 10;
  }
  EXPECT_LE(thin, x.result.soup.facets.size() / 1000);
}

TEST(Sharpen, SameBitsOnOneThreadAndOnTwo) {
  const TriangleSoup solid = tilted(cubes({{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  const auto on = [&](int threads) {
    const ThreadLimit limit(threads);
    return sharpened(solid, 1.0 / 24).result;
  };
  const SharpenedSurface one = on(1), two = on(2);
  EXPECT_EQ(one.soup.points, two.soup.points);
  EXPECT_EQ(one.soup.facets, two.soup.facets);
  EXPECT_EQ(one.parents, two.parents);
  EXPECT_EQ(one.kind, two.kind);
}

TEST(ReferenceSurface, AWallIsSeenFromTheSideThatIsAsked) {
  const TriangleSoup plate = box({4, 4, 0.2}, 4, 4, 1);
  const ReferenceSurface s(plate, find_creases(plate));
  const ReferenceSurface::Foot up = s.closest({2.1, 2.1, 0.05}, 1, {0, 0, 1}), down = s.closest({2.1, 2.1, 0.05}, 1, {0, 0, -1});
  EXPECT_NEAR(up.point.z, 0.2, kExact);
  EXPECT_NEAR(down.point.z, 0, kExact);
  EXPECT_FALSE(s.closest({2.1, 2.1, 0.05}, 0.1, {0, 0, 1}).found());
}

TEST(ReferenceSurface, SheetsEndAtCreases) {
  const TriangleSoup cube = box({1, 1, 1}, 2, 2, 2);
  const ReferenceSurface s(cube, find_creases(cube));
  for (std::uint32_t f = 0; f < cube.facets.size(); ++f)
    for (std::uint32_t g = 0; g < cube.facets.size(); ++g)
      EXPECT_EQ(s.connected(f, g, {0.5, 0.5, 0.5}, 10), s.normal(f) == s.normal(g));
  // From corner to corner of a side, but not within a small ball about one of them.
  const std::uint32_t a = s.closest({0.01, 0.01, 1}, 1, {0, 0, 1}).facet, b = s.closest({0.99, 0.99, 1}, 1, {0, 0, 1}).facet;
  EXPECT_TRUE(s.connected(a, b, {0.5, 0.5, 1}, 0.8));
  EXPECT_FALSE(s.connected(a, b, {0, 0, 1}, 0.2));
}

}  // namespace
}  // namespace burnish
