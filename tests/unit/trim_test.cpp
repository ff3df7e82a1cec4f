#include "burnish/extract/trim.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include "burnish/surface/edge_table.h"
#include "burnish/surface/inspect.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;
const Vec3 kUp = Vec3{1, 2, 3} / std::sqrt(14.0);
constexpr double kHeight = 0.31;

std::vector<double> heights(const TriangleSoup& soup) {
  std::vector<double> values;
  for (const Vec3& p : soup.points) values.push_back(dot(p, kUp) - kHeight);
  return values;
}

TEST(Trim, ASphereAbovePlaneIsACapWithOneRim) {
  std::vector<double> errors;
  for (const int level : {2, 3, 4, 5}) {
    SCOPED_TRACE(level);
    const TriangleSoup sphere = icosphere(level);
    const TriangleSoup cap = trim_negative(sphere, heights(sphere));
    const Defects d = inspect(cap).defects;
    EXPECT_TRUE(d.valid_sheet());
    EXPECT_EQ(d.open_loops, 1u);
    EXPECT_EQ(d.components, 1u);
    // The sphere's cap is 2 pi (1 - h), its rim a circle in the plane.
    errors.push_back(std::abs(d.area / (2 * kPi * (1 - kHeight)) - 1));
    const EdgeTable table(cap);
    const double edge = mean_edge_length(sphere);
    double rim = 0;
    std::size_t on_plane = 0, open = 0;
    for (std::size_t e = 0; e < table.size(); ++e) {
      if (!table.is_open(e)) continue;
      ++open;
      const Vec3 &a = cap.points[table.edge(e)[0]], &b = cap.points[table.edge(e)[1]];
      rim += norm(b - a);
      on_plane += std::abs(dot(a, kUp) - kHeight) < 1e-12;
      EXPECT_NEAR(dot(a, kUp), kHeight, 0.03 * edge) << "cuts are moved off points by 2 % of an edge";
      EXPECT_LE(norm(a), 1 + 1e-12);
      EXPECT_GE(norm(a), 1 - 0.25 * edge * edge);
    }
    EXPECT_GE(on_plane, open * 9 / 10);
    EXPECT_NEAR(rim / (2 * kPi * std::sqrt(1 - kHeight * kHeight)), 1, 0.3 * edge * edge + 1e-3);
  }
  for (std::size_t i = 1; i < errors.size(); ++i) EXPECT_LE(errors[i], errors[i - 1] / 3) << "not of second order";
  EXPECT_LE(errors.back(), 1e-3);
}

// Both parts together are the whole.
TEST(Trim, WhatOnePlaneLeavesTheOtherTakes) {
  const TriangleSoup soup = torus(40, 20);
  std::vector<double> values = heights(soup);
  const double above = area(trim_negative(soup, values));
  for (double& v : values) v = -v;
  EXPECT_NEAR(above + area(trim_negative(soup, values)), area(soup), 1e-2 * area(soup));
}

TEST(Trim, AllOrNothing) {
  const TriangleSoup soup = icosphere(1);
  const TriangleSoup all = trim_negative(soup, std::vector<double>(soup.points.size(), 1.0));
  EXPECT_EQ(area(all), area(soup));
  EXPECT_EQ(all.facets.size(), soup.facets.size());
  EXPECT_TRUE(trim_negative(soup, std::vector<double>(soup.points.size(), -1.0)).facets.empty());
  EXPECT_EQ(trim_negative(soup, std::vector<double>(soup.points.size(), 0.0)).facets.size(), soup.facets.size());
}

// Values that vanish at points or change sign wildly still give edges that both facets cut alike.
TEST(Trim, RoughValuesGiveAManifoldToo) {
  const TriangleSoup soup = icosphere(3);
  std::vector<double> values;
  for (std::size_t i = 0; i < soup.points.size(); ++i) values.push_back(i % 7 == 0 ? 0.0 : std::sin(1e3 * soup.points[i].x) * (i % 3 ? 1 : 1e-18));
  const Defects d = inspect(trim_negative(soup, values)).defects;
  EXPECT_GT(d.open_edges, 0u);
  EXPECT_EQ(d.non_manifold_edges + d.misoriented_edges + d.self_intersecting_pairs + d.degenerate_facets, 0u);
}

}  // namespace
}  // namespace burnish
