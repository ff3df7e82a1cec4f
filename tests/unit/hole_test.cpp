#include "burnish/surface/hole.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace burnish {
namespace {

constexpr double kPi = std::numbers::pi;

TEST(Hole, ASquareWithUnevenEdges) {
  const Hole hole = measure_hole({{0, 0, 1}, {0.25, 0, 1}, {2, 0, 1}, {2, 2, 1}, {0, 2, 1}});
  EXPECT_EQ(hole.edges, 5u);
  EXPECT_DOUBLE_EQ(hole.perimeter, 8);
  EXPECT_DOUBLE_EQ(hole.area, 4);
  EXPECT_NEAR(norm(hole.position - Vec3{1, 1, 1}), 0, 1e-15) << "points close together must not count for more";
  EXPECT_FALSE(hole.filled);
}

// The width is the diameter of a circle.
TEST(Hole, ACircle) {
  std::vector<Vec3> loop;
  constexpr int n = 1000;
  for (int i = 0; i < n; ++i) loop.push_back({5 + 0.3 * std::cos(2 * kPi * i / n), 0.3 * std::sin(2 * kPi * i / n), 0});
  const Hole hole = measure_hole(loop);
  EXPECT_NEAR(hole.width(), 0.6, 1e-5);
  EXPECT_NEAR(hole.area, kPi * 0.09, 1e-5);
  EXPECT_NEAR(norm(hole.position - Vec3{5, 0, 0}), 0, 1e-12);
}

// The area is that of the projection along the vector area: for a square folded along its diagonal, cos of half the fold.
TEST(Hole, ABentLoop) {
  const double s = std::sqrt(0.5), fold = 0.4;
  const Hole hole = measure_hole({{s, 0, 0}, {0, s * std::cos(fold), s * std::sin(fold)}, {-s, 0, 0}, {0, -s * std::cos(fold), s * std::sin(fold)}});
  EXPECT_NEAR(hole.perimeter, 4, 1e-12);
  EXPECT_NEAR(hole.area, std::cos(fold), 1e-12);
}

TEST(Hole, NextToNothing) {
  EXPECT_EQ(measure_hole({}).perimeter, 0);
  const Hole point = measure_hole({{1, 2, 3}, {1, 2, 3}});
  EXPECT_EQ(point.perimeter, 0);
  EXPECT_EQ(point.position, (Vec3{1, 2, 3}));
}

}  // namespace
}  // namespace burnish
