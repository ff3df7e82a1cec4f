// The yardstick itself: what analytic shapes say of themselves is consistent.
#include "support/analytic_shapes.h"

#include <gtest/gtest.h>

#include <cmath>

#include "support/level_sets.h"

namespace burnish {
namespace {

using namespace test;

TEST(AnalyticShapes, FeetNormalsAndCurvaturesAgreeWithTheDistance) {
  std::mt19937 random(1);
  for (const auto& shape : analytic_shapes()) {
    SCOPED_TRACE(shape->name());
    const PlacedShape placed = placed_at_random(*shape, 10, 5, random);
    std::uniform_real_distribution<double> any(0, 8.0 * (1 << placed.depth));
    double sharpest = 0;
    for (int found = 0; found < 2000;) {
      const Vec3 p{any(random), any(random), any(random)};
      const double d = placed.distance(p);
      if (!(std::abs(d) < 5)) continue;
      ++found;
      const SurfacePoint at = placed.closest(p);
      EXPECT_NEAR(placed.distance(at.foot), 0, 1e-11);
      EXPECT_NEAR(norm(p - at.foot), std::abs(d), 1e-9);
      EXPECT_NEAR(dot(p - at.foot, at.normal), -d, 1e-9);
      EXPECT_NEAR(norm(at.normal), 1, 1e-12);
      EXPECT_GE(at.k1, at.k2);
      sharpest = std::max({sharpest, at.k1, -at.k2});
      if (found > 100) continue;
      // The normal turns by k1 along direction1 and by k2 across it.
      constexpr double step = 1e-4;
      const Vec3 u = norm(at.direction1) > 0 ? at.direction1 / norm(at.direction1) : Vec3{};
      for (const auto& [along, k] : {std::pair{u, at.k1}, std::pair{cross(at.normal, u), at.k2}}) {
        const Vec3 turn = (placed.closest(at.foot + along * step).normal - placed.closest(at.foot - along * step).normal) / (2 * step);
        EXPECT_NEAR(norm(turn - along * k), 0, 1e-6);
      }
    }
    EXPECT_LE(sharpest, 0.1 + 1e-9);
    EXPECT_GE(sharpest, 0.09);
  }
}

TEST(AnalyticShapes, LevelSetsJumpThroughTheSurface) {
  std::mt19937 random(2);
  const auto shape = unit_sphere();
  const PlacedShape placed = placed_at_random(*shape, 20, 12, random);
  const BasicLevelSet<double> set = level_set_of_shape<double>(placed, 4, jump_through(placed));
  std::array<int, 2> cut{};
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    if (!set.phi.stores(leaf)) continue;
    const double* phi = set.phi.block(leaf);
    const auto [low, high] = std::minmax_element(phi, phi + kBlockNodes);
    if (*low < 0 && *high >= 0) ++cut.at(static_cast<std::size_t>(set.octree().level(leaf)));
  }
  EXPECT_GE(cut[0], 20);
  EXPECT_GE(cut[1], 8);
}

}  // namespace
}  // namespace burnish
