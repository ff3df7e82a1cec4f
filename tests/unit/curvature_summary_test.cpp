#include "curvature_summary.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// Of a torus with the radii 1 and 0.4 about z.
FrontCurvature on_torus(const Vec3& p, double cell) {
  FrontCurvature c;
  const double around = std::hypot(p.x, p.y);
  c.k1 = cell / 0.4;
  c.k2 = cell * (1 - 1 / around) / 0.4;
  c.order = 4;
  c.converged = true;
  return c;
}

TEST(CurvatureSummary, IntegralsConvergeWithSecondOrder) {
  double mean_error[2], gaussian_error[2];
  for (const int level : {0, 1}) {
    const TriangleSoup surface = torus(48 << level, 24 << level);
    std::vector<FrontCurvature> at;
    for (const Vec3& p : surface.points) at.push_back(on_torus(p, 0.25));
    const CurvatureSummary s = summarize_curvature(surface, at, 0.25, CurvatureOrder::fourth, CurvaturePoints::surface, false);
    EXPECT_EQ(s.determined, surface.points.size());
    EXPECT_EQ(s.euler_characteristic, 0);
    EXPECT_NEAR(s.area, area(surface), 1e-12 * s.area);
    EXPECT_NEAR(s.convex->radius, 0.4, 1e-12);
    EXPECT_NEAR(s.concave->radius, 0.6, 1e-12);
    EXPECT_NEAR(std::hypot(s.concave->position.x, s.concave->position.y), 0.6, 1e-12);
    EXPECT_NEAR(s.k1->p50(), 2.5, 1e-12);
    mean_error[level] = std::abs(*s.mean_integral - 2 * std::numbers::pi * std::numbers::pi);
    gaussian_error[level] = std::abs(*s.gaussian_integral);
  }
  EXPECT_GT(mean_error[0] / mean_error[1], 3.5);
  EXPECT_LT(mean_error[1], 0.03);
  EXPECT_TRUE(gaussian_error[1] < 1e-9 || gaussian_error[0] / gaussian_error[1] > 3.5) << gaussian_error[0] << ", " << gaussian_error[1];
}

TEST(CurvatureSummary, LeavesOutWhatHasNoCurvature) {
  const TriangleSoup surface = icosphere(2);
  std::vector<FrontCurvature> at(surface.points.size());
  std::size_t determined = 0;
  for (std::size_t p = 0; p < at.size(); ++p) {
    at[p].k1 = at[p].k2 = p % 3 == 0 ? 1e9 : 1;
    at[p].converged = p % 3 != 0;
    at[p].order = p % 3 == 1 ? 2 : 4;
    determined += at[p].converged;
  }
  const CurvatureSummary s = summarize_curvature(surface, at, 1, CurvatureOrder::fourth, CurvaturePoints::surface, false);
  EXPECT_EQ(s.determined, determined);
  EXPECT_EQ(s.lower_order, (at.size() + 1) / 3);
  EXPECT_LT(*s.determined_area, s.area);
  EXPECT_EQ(s.mean.max, 1);
  EXPECT_NEAR(*s.mean_integral, *s.determined_area, 1e-12);
  EXPECT_FALSE(s.concave);
  EXPECT_EQ(s.euler_characteristic, 2);
  // Without a facet there is no Euler characteristic; by the mean alone no principal curvatures.
  EXPECT_FALSE(summarize_curvature(without_facets(surface, {0}), at, 1, CurvatureOrder::fourth, CurvaturePoints::surface, true).euler_characteristic);
  EXPECT_FALSE(summarize_curvature(surface, at, 1, CurvatureOrder::fourth, CurvaturePoints::surface, true).k1);
}

// Many small facets have 1, a large one 2: it has ten times the area of all of them.
TEST(CurvatureSummary, PercentilesAreByArea) {
  TriangleSoup surface;
  std::vector<FrontCurvature> at;
  const auto add = [&](double size, double k) {
    const auto first = static_cast<std::uint32_t>(surface.points.size());
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{size, 0, 0}, Vec3{0, size, 0}}) surface.points.push_back(p);
    surface.facets.push_back({first, first + 1, first + 2});
    for (int i = 0; i < 3; ++i) at.emplace_back(), at.back().k1 = at.back().k2 = k, at.back().converged = true;
  };
  for (int i = 0; i < 90; ++i) add(1, 1);
  add(30, 2);  // 900 times the area of one of the others
  const CurvatureSummary s = summarize_curvature(surface, at, 1, CurvatureOrder::second, CurvaturePoints::surface, false);
  EXPECT_EQ(s.mean.percentiles[1], 1);  // 5 %
  EXPECT_EQ(s.mean.p50(), 2);
  EXPECT_NEAR(s.mean.mean, (90 + 2 * 900) / 990.0, 1e-12);
}

// The input's vertices are samples: each counts once, and nothing is integrated.
TEST(CurvatureSummary, VerticesOfTheInputHaveNoIntegrals) {
  const TriangleSoup surface = icosphere(1);
  std::vector<FrontCurvature> at(surface.points.size());
  for (std::size_t p = 0; p < at.size(); ++p) at[p].k1 = at[p].k2 = p == 0 ? 3 : 1, at[p].converged = true;
  const CurvatureSummary s = summarize_curvature(surface, at, 1, CurvatureOrder::fourth, CurvaturePoints::vertices, false);
  EXPECT_FALSE(s.mean_integral || s.gaussian_integral || s.determined_area || s.euler_characteristic);
  EXPECT_NEAR(s.mean.mean, 1 + 2.0 / static_cast<double>(at.size()), 1e-12);
}

TEST(CompareCurvatures, LooksAtWhatBothHave) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {2, 0, 0}};
  std::vector<FrontCurvature> a(3), b(3);
  for (std::size_t i = 0; i < 3; ++i) {
    a[i].converged = true, b[i].converged = i != 0;
    a[i].k1 = 2, a[i].k2 = 1;
    b[i].k1 = 2, b[i].k2 = 1 - 0.1 * static_cast<double>(i);
  }
  const CurvatureCheck check = compare_curvatures(points, a, b, 0.5);
  EXPECT_EQ(check.points, 2u);
  EXPECT_NEAR(check.max, 0.4, 1e-12);
  EXPECT_NEAR(check.rms, std::sqrt((0.04 + 0.16) / 4), 1e-12);
  EXPECT_NEAR(check.rms_curvature, std::sqrt((16 + 4) / 2.0), 1e-12);
  EXPECT_EQ(check.worst, points[2]);
}

}  // namespace
}  // namespace burnish
