#include "burnish/surface/signed_deviation.h"
#include "burnish/surface/winding.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

std::vector<double> deviations(const std::vector<Vec3>& points, const TriangleSoup& to, SideRule rule) {
  const TriangleIndex index(to);
  const auto closest = [&](const Vec3& p) -> ClosestPoint {
    const TriangleIndex::Closest c = index.closest(p);
    return {c.point, c.squared_distance, c.facet};
  };
  return signed_deviation(points, to, index, closest, rule);
}

std::vector<double> deviations(const std::vector<Vec3>& points, const TriangleSoup& to) {
  return deviations(points, to, side_rule(to));
}

std::vector<Vec3> points_around(unsigned seed, double size, int count) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-size, size);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const double x = any(random), y = any(random), z = any(random);
    points.push_back({x, y, z});
  }
  return points;
}

TEST(SignedDeviation, ClosedChainsAreKnown) {
  EXPECT_TRUE(is_closed_chain(cube()));
  EXPECT_TRUE(is_closed_chain(flipped(cube())));
  EXPECT_FALSE(is_closed_chain(without_facets(cube(), {3})));
  EXPECT_FALSE(is_closed_chain(with_flipped_facet(cube(), 3)));
  EXPECT_FALSE(is_closed_chain({}));
  // Four facets at one edge, two of each cube.
  const TriangleSoup touching = weld(merged(cube(), moved(cube(), {1, 1, 0})));
  EXPECT_TRUE(is_closed_chain(touching));
}

TEST(SignedDeviation, OfACubeByItsFormula) {
  const TriangleSoup to = moved(scaled(cube(), 2), {-1, -1, -1});
  const std::vector<Vec3> points = points_around(1, 2, 2000);
  for (const TriangleSoup& turned : {to, flipped(to)}) {
    const std::vector<double> found = deviations(points, turned);
    for (std::size_t i = 0; i < points.size(); ++i) {
      const Vec3& p = points[i];
      const Vec3 over{std::abs(p.x) - 1, std::abs(p.y) - 1, std::abs(p.z) - 1};
      const double outside = norm(max(over, Vec3{})), inside = std::min(0.0, std::max({over.x, over.y, over.z}));
      ASSERT_NEAR(found[i], outside + inside, 1e-12) << i;
    }
  }
}

TEST(SignedDeviation, OnTheSurfaceIsZero) {
  for (const double d : deviations(cube().points, cube())) EXPECT_EQ(d, 0);
  for (const double d : deviations(cube().points, without_facets(cube(), {3}))) EXPECT_EQ(d, 0);
}

TEST(SignedDeviation, InsideOfEitherOfTwoBodies) {
  const TriangleSoup two = weld(merged(cube(), moved(cube(), {0.5, 0.5, 0.5})));
  const std::vector<double> found = deviations({{0.75, 0.75, 0.75}, {0.1, 0.2, 0.3}, {1.4, 1.3, 1.2}, {0.2, 1.2, 0.8}}, two);
  EXPECT_LT(found[0], 0) << "in both";
  EXPECT_LT(found[1], 0);
  EXPECT_LT(found[2], 0);
  EXPECT_GT(found[3], 0) << "in the box of both, in neither";
}

// Facets alone tell the same side as winding numbers do, at edges and corners, too: convex ones, and a torus.
TEST(SignedDeviation, BothRulesAgreeWhereBothApply) {
  for (const TriangleSoup& to : {moved(scaled(cube(), 2), {-1, -1, -1}), icosphere(2), torus(24, 12)}) {
    const std::vector<Vec3> points = points_around(2, 2, 2000);
    EXPECT_EQ(deviations(points, to, SideRule::winding_number), deviations(points, to, SideRule::closest_facet));
  }
}

TEST(SignedDeviation, AboveAndBelowASheet) {
  const TriangleSoup sheet = height_field(8, [](int i, int j) { return 0.1 * ((i + j) % 2); });
  EXPECT_EQ(side_rule(sheet), SideRule::closest_facet);
  std::vector<Vec3> above, below;
  for (const Vec3& p : points_around(3, 0.4, 500)) {
    above.push_back({p.x + 0.5, p.y + 0.5, 0.11 + std::abs(p.z)});
    below.push_back({p.x + 0.5, p.y + 0.5, -0.01 - std::abs(p.z)});
  }
  for (const double d : deviations(above, sheet)) EXPECT_GT(d, 0);
  for (const double d : deviations(below, sheet)) EXPECT_LT(d, 0);
}

TEST(SignedDeviation, SameBitsForAnyNumberOfThreads) {
  const std::vector<Vec3> points = points_around(4, 2, 3000);
  const auto measure = [&](int threads) {
    const ThreadLimit limit(threads);
    return deviations(points, torus(40, 20));
  };
  EXPECT_EQ(measure(1), measure(4));
}

}  // namespace
}  // namespace burnish
