// Unions against volumes known in closed form, and what must come out untouched.
#include "burnish/surface/solid_union.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

SolidUnion united(const TriangleSoup& soup) {
  const TriangleSoup welded = weld(soup);
  return unite(welded, self_intersecting_pairs(welded));
}

double volume_of_union(const TriangleSoup& soup) { return signed_volume(united(soup).soup); }

TEST(SolidUnion, OfTwoCubesHasTheVolumeOfBothButOnce) {
  for (const Vec3& by : {Vec3{0.5, 0.25, 0.125}, Vec3{0.5, 0, 0}, Vec3{0.5, 0.5, 0}, Vec3{0, 0, 0.75}, Vec3{0.3, -0.2, 0.1}}) {
    SCOPED_TRACE(by.x);
    const double overlap = (1 - std::abs(by.x)) * (1 - std::abs(by.y)) * (1 - std::abs(by.z));
    const SolidUnion u = united(merged(cube(), moved(cube(), by)));
    EXPECT_NEAR(signed_volume(u.soup), 2 - overlap, 1e-12);
    EXPECT_EQ(inspect(u.soup).defects.components, 1u);
  }
}

TEST(SolidUnion, OfACubeWithItselfIsTheCube) {
  EXPECT_NEAR(volume_of_union(merged(cube(), cube())), 1, 1e-12);
}

TEST(SolidUnion, OfThreeSpheresCountsNothingTwice) {
  // On a line at distances of one radius: two lenses, and no point in all three.
  const TriangleSoup ball = icosphere(4);
  const double faceted = signed_volume(ball) / (4.0 / 3 * std::numbers::pi);
  const double lens = std::numbers::pi * 5 / 12;
  const double expected = 3 * 4.0 / 3 * std::numbers::pi - 2 * lens;
  const double v = volume_of_union(merged(merged(ball, moved(ball, {1, 0.01, 0.02})), moved(ball, {2, 0.02, -0.01})));
  EXPECT_NEAR(v / (faceted * expected), 1, 0.005);
}

TEST(SolidUnion, WhatNothingTouchesComesOutBitForBit) {
  const TriangleSoup soup = weld(merged(icosphere(3), moved(icosphere(3), {1.2, 0.3, 0.1})));
  const auto pairs = self_intersecting_pairs(soup);
  const SolidUnion u = unite(soup, pairs);
  ASSERT_EQ(u.source.size(), u.soup.facets.size());
  std::size_t kept = 0;
  for (std::size_t f = 0; f < u.source.size(); ++f) {
    ASSERT_NE(u.parent[f], kNoFacet);
    if (u.source[f] == kNoFacet) continue;
    ++kept;
    for (int i = 0; i < 3; ++i) EXPECT_EQ(u.soup.corner(f, i), soup.corner(u.source[f], i));
  }
  EXPECT_GT(kept, soup.facets.size() / 2);
  EXPECT_GT(u.facets_cut, 0u);
  EXPECT_GT(u.facets_absorbed, 0u);
  const Defects d = inspect(u.soup).defects;
  EXPECT_EQ(d.open_edges, 0u);
  EXPECT_EQ(d.components, 1u);
}

TEST(SolidUnion, ACavityStaysWhereTheOtherBodyDoesNotReach) {
  const TriangleSoup hollow = merged(scaled(cube(), 4), flipped(moved(cube(), {0.5, 1.5, 1.5})));
  const double v = volume_of_union(merged(hollow, moved(scaled(cube(), 4), {3, 1, 1})));
  EXPECT_NEAR(v, 64 - 1 + 64 - 1 * 3 * 3, 1e-9);
}

}  // namespace
}  // namespace burnish
