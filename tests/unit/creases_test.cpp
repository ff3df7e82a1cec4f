// Creases: what is sharp, how chains run, and what noise does to them.
#include "burnish/surface/creases.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burnish/surface/weld.h"
#include "support/noise.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

// A prism over a regular polygon of radius 1, height 2, axis z; sides in two facets each, ends as fans about their middles.
TriangleSoup prism(int n) {
  TriangleSoup soup;
  for (const double z : {0.0, 2.0})
    for (int i = 0; i < n; ++i) {
      const double a = 2 * std::numbers::pi * i / n;
      soup.points.push_back({std::cos(a), std::sin(a), z});
    }
  const auto count = static_cast<std::uint32_t>(n);
  soup.points.push_back({0, 0, 0});
  soup.points.push_back({0, 0, 2});
  for (std::uint32_t i = 0; i < count; ++i) {
    const std::uint32_t j = (i + 1) % count;
    soup.facets.insert(soup.facets.end(), {{i, j, count + j}, {i, count + j, count + i}, {2 * count, j, i}, {2 * count + 1, count + i, count + j}});
  }
  return soup;
}

double length(const TriangleSoup& soup, const Creases& creases) {
  double sum = 0;
  for (const CreaseEdge& e : creases.edges) sum += norm(soup.points[e.points[1]] - soup.points[e.points[0]]);
  return sum;
}

TEST(Creases, OfABoxAreItsTwelveEdgesBetweenEightCorners) {
  const TriangleSoup box = test::box({3, 2, 1}, 6, 4, 2);
  const Creases creases = find_creases(box);
  EXPECT_EQ(creases.corners.size(), 8u);
  EXPECT_EQ(creases.chains.size(), 12u);
  EXPECT_DOUBLE_EQ(length(box, creases), 4 * (3 + 2 + 1));
  for (const auto& chain : creases.chains) EXPECT_NE(chain.front(), chain.back());
}

TEST(Creases, KnowTheFacetsOnBothSides) {
  const TriangleSoup box = test::cube();
  for (const CreaseEdge& e : find_creases(box).edges) {
    const auto runs = [&](std::uint32_t f, std::uint32_t a, std::uint32_t b) {
      for (std::size_t i = 0; i < 3; ++i)
        if (box.facets[f][i] == a && box.facets[f][(i + 1) % 3] == b) return true;
      return false;
    };
    EXPECT_TRUE(runs(e.facets[0], e.points[0], e.points[1]));
    EXPECT_TRUE(runs(e.facets[1], e.points[1], e.points[0]));
  }
}

TEST(Creases, OfACylinderAreTwoClosedChains) {
  const TriangleSoup cylinder = prism(32);
  const Creases creases = find_creases(cylinder);
  ASSERT_EQ(creases.chains.size(), 2u);
  EXPECT_TRUE(creases.corners.empty());
  for (const auto& chain : creases.chains) {
    EXPECT_EQ(chain.size(), 33u);
    EXPECT_EQ(chain.front(), chain.back());
  }
}

TEST(Creases, TurnsOfMoreThanThirtyDegreesAreCorners) {
  EXPECT_EQ(find_creases(prism(11)).corners.size(), 22u);  // turns of 32.7 degrees
  EXPECT_EQ(find_creases(prism(13)).corners.size(), 0u);   // 27.7
}

TEST(Creases, ShallowEdgesCountWhereFacetsReachFarEnough) {
  const TriangleSoup drum = prism(32);  // sides 0.196 wide that meet at 11.25 degrees
  const double side = 2 * std::sin(std::numbers::pi / 32);
  EXPECT_EQ(find_creases(drum, {.resolved_angle = 5, .resolved = 0.9 * side}).edges.size(), 32u * 3);
  EXPECT_EQ(find_creases(drum, {.resolved_angle = 5, .resolved = 1.1 * side}).edges.size(), 32u * 2);
  EXPECT_EQ(find_creases(drum, {.resolved_angle = 12, .resolved = 0.9 * side}).edges.size(), 32u * 2);
}

TEST(Creases, OpenNonManifoldAndMisorientedEdgesAreNone) {
  const TriangleSoup sheet = test::height_field(2, [](int i, int) { return i == 1 ? 1.0 : 0.0; });
  EXPECT_EQ(find_creases(sheet).edges.size(), 2u);
  TriangleSoup box = test::cube();
  const std::size_t all = find_creases(box).edges.size();
  box.facets.push_back(box.facets[0]);
  EXPECT_LT(find_creases(box).edges.size(), all);
  EXPECT_LT(find_creases(test::with_flipped_facet(test::cube(), 0)).edges.size(), all);
}

TEST(Creases, ShortFreeEndsAreDropped) {
  // A roof whose ridge ends in the middle of the plane.
  const TriangleSoup roof = test::height_field(8, [](int i, int j) { return i == 4 && j >= 5 ? 0.5 : 0.0; });
  const Creases all = find_creases(roof);
  EXPECT_FALSE(all.empty());
  const Creases longer = find_creases(roof, {.least_length = 10});
  for (const auto& chain : longer.chains)
    for (const std::uint32_t end : {chain.front(), chain.back()})
      EXPECT_GT(std::count_if(longer.edges.begin(), longer.edges.end(), [&](const CreaseEdge& e) { return e.points[0] == end || e.points[1] == end; }), 1);
}

// A needle of height 1e-9 along an edge of the box: the crease is still there, once.
TEST(Creases, NeedlesAlongACreaseDoNotBreakIt) {
  TriangleSoup box = test::cube();
  // Splits the facet on one side of every crease of length 1 near its middle, a hair off the edge.
  const Creases before = find_creases(box);
  const CreaseEdge e = before.edges.front();
  const Vec3 a = box.points[e.points[0]], b = box.points[e.points[1]];
  const std::uint32_t f = e.facets[0];
  Facet facet = box.facets[f];
  while (facet[0] != e.points[0]) std::rotate(facet.begin(), facet.begin() + 1, facet.end());
  const Vec3 c = box.points[facet[2]];
  const auto middle = static_cast<std::uint32_t>(box.points.size());
  box.points.push_back((a + b) * 0.5 + (c - (a + b) * 0.5) * 1e-9 + cross(b - a, c - a) * 1e-9);
  box.facets[f] = {facet[0], facet[1], middle};
  box.facets.push_back({facet[1], facet[2], middle});
  box.facets.push_back({facet[2], facet[0], middle});
  const Creases after = find_creases(box);
  EXPECT_EQ(after.corners.size(), 8u);
  EXPECT_EQ(after.chains.size(), 12u);
  EXPECT_NEAR(length(box, after), 12, 1e-6);
}

TEST(Creases, NoiseMakesNoneAndHidesNone) {
  const TriangleSoup ball = test::with_noise(test::icosphere(5), 0.3, 7);
  const double sigma = 0.3 * mean_edge_length(ball);
  EXPECT_GT(find_creases(ball).edges.size(), 1000u);
  EXPECT_LT(length(ball, find_creases(ball, {.least_length = 8 * mean_edge_length(ball), .sigma = sigma})), 0.01 * 4 * std::numbers::pi);
  const TriangleSoup clean = test::box({1, 1, 1}, 24, 24, 24), box = test::with_noise(clean, 0.2, 8);
  const Creases found = find_creases(box, {.least_length = 4.0 / 24, .sigma = 0.2 / 24});
  const double on_edges = static_cast<double>(std::count_if(found.edges.begin(), found.edges.end(), [&](const CreaseEdge& e) {
    const Vec3 p = clean.points[e.points[0]], q = clean.points[e.points[1]], m = (p + q) * 0.5;
    const auto on = [](double x) { return std::min(std::abs(x), std::abs(x - 1)) < 1.01 / 24 ? 1 : 0; };
    return on(m.x) + on(m.y) + on(m.z) >= 2;
  }));
  EXPECT_GT(on_edges, 0.9 * 12 * 24);
  EXPECT_GT(on_edges, 0.9 * static_cast<double>(found.edges.size()));
}

TEST(Creases, ScaleByPowersOfTwoBitForBit) {
  const TriangleSoup box = test::with_noise(test::box({3, 2, 1}, 12, 8, 4), 0.1, 9);
  const Creases a = find_creases(box, {.angle = 25, .resolved_angle = 10, .resolved = 0.1, .least_length = 0.5, .sigma = 0.01});
  const Creases b = find_creases(test::scaled(box, 1024), {.angle = 25, .resolved_angle = 10, .resolved = 102.4, .least_length = 512, .sigma = 10.24});
  EXPECT_EQ(a.chains, b.chains);
  EXPECT_EQ(a.corners, b.corners);
}

}  // namespace
}  // namespace burnish
