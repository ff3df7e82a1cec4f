#include "burnish/levelset/offset.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burnish/core/error.h"
#include "burnish/levelset/volume.h"
#include "support/analytic_level_set.h"

namespace burnish {
namespace {

using namespace test;

double volume_of_ball(double radius) { return 4.0 / 3 * std::numbers::pi * radius * radius * radius; }

Ball<float> sparse_ball(double radius, double band) {
  Ball<float> ball = analytic_ball<float>(radius, {0.3, 0.7, 0.1}, band);
  ball.set = stored_near_surface(ball.set, band);
  return ball;
}

TEST(Offset, OfBallsAreBalls) {
  for (const double by : {2.5, -2.5, 4.25, -4.25, 0.0}) {
    Ball<float> ball = sparse_ball(20, 8);
    offset(ball.set, by);
    EXPECT_EQ(ball.set.band, 8 - std::abs(by));
    const auto limit = static_cast<float>(ball.set.band);
    for (const float phi : ball.set.phi.values()) ASSERT_LE(std::abs(phi), limit);
    for_each_near_node(ball.set, [&](const Vec3& p, float& phi) {
      ASSERT_NEAR(phi, std::clamp(20 + by - norm(p - ball.center), -ball.set.band, ball.set.band), 5e-6);
    });
    EXPECT_NEAR(enclosed_volume(ball.set) / volume_of_ball(20 + by), 1, 0.7 / ((20 + by) * (20 + by))) << by;  // of second order
  }
}

TEST(Offset, ThereAndBackIsTheSame) {
  Ball<float> ball = sparse_ball(20, 12);
  const double before = enclosed_volume(ball.set);
  offset(ball.set, 3);
  offset(ball.set, -3);
  EXPECT_NEAR(enclosed_volume(ball.set) / before, 1, 1e-6);
}

TEST(Hollow, LeavesAWallOfEvenThickness) {
  for (const double wall : {4.5, -4.5}) {
    Ball<float> ball = sparse_ball(20, 9);
    hollow(ball.set, wall);
    const double outer = std::max(20.0, 20 - wall), inner = std::min(20.0, 20 - wall);
    for_each_near_node(ball.set, [&](const Vec3& p, float& phi) {
      const double r = norm(p - ball.center);
      ASSERT_NEAR(phi, std::clamp(std::min(outer - r, r - inner), -ball.set.band, ball.set.band), 5e-6);
    });
    EXPECT_NEAR(enclosed_volume(ball.set) / (volume_of_ball(outer) - volume_of_ball(inner)), 1, 5e-3);
  }
}

TEST(Offset, NeedsABand) {
  Ball<float> ball = sparse_ball(12, 5);
  EXPECT_THROW(offset(ball.set, 2), Error);
  EXPECT_THROW(offset(ball.set, -2), Error);
  EXPECT_THROW(hollow(ball.set, 3), Error);
  EXPECT_NO_THROW(offset(ball.set, 1.9));
}

}  // namespace
}  // namespace burnish
