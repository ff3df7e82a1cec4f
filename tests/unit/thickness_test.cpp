#include "burnish/surface/thickness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "burnish/surface/sheet_block.h"
#include "burnish/surface/shells.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

TEST(Thickness, OfAPlateIsItsThickness) {
  const std::vector<double> walls = wall_thicknesses(box({1, 1, 0.05}, 8, 8, 1), 1000);
  ASSERT_GT(walls.size(), 900u);
  EXPECT_NEAR(walls.front(), 0.05, 1e-6);
  EXPECT_NEAR(walls[walls.size() / 2], 0.05, 1e-6);
}

TEST(Thickness, OfABallIsItsDiameter) {
  const std::vector<double> walls = wall_thicknesses(icosphere(4), 1000);
  EXPECT_EQ(walls.size(), 1000u);
  EXPECT_NEAR(walls[500], 2, 0.02);
}

std::pair<double, double> range_of(const TriangleSoup& soup, std::size_t more = 2000) {
  double least = 1e300, most = 0;
  for (const ThicknessSample& s : thickness_samples(soup, more)) least = std::min(least, s.thickness), most = std::max(most, s.thickness);
  return {least, most};
}

// Edges at right angles are not thin.
TEST(ThicknessMap, OfABoxIsTheWayToTheOppositeFace) {
  for (const ThicknessSample& s : thickness_samples(box({1, 2, 0.25}, 4, 5, 2), 500)) {
    const double expected = s.at.x < 1e-12 || s.at.x > 1 - 1e-12 ? 1 : s.at.y < 1e-12 || s.at.y > 2 - 1e-12 ? 2 : 0.25;
    EXPECT_NEAR(s.thickness, expected, 1e-8);
  }
  for (const double t : thickness_at_points(cube())) EXPECT_NEAR(t, 1, 1e-8);
}

TEST(ThicknessMap, OfAShellBetweenSpheresIsTheDifferenceOfRadii) {
  const auto [least, most] = range_of(merged(icosphere(4), flipped(scaled(icosphere(4), 0.8))));
  EXPECT_NEAR(least, 0.2, 0.004);
  EXPECT_NEAR(most, 0.2, 0.004);
}

TEST(ThicknessMap, OfATorusIsTheTubesDiameter) {
  const auto [least, most] = range_of(torus(96, 48));
  EXPECT_NEAR(least, 0.8, 0.02);
  EXPECT_NEAR(most, 0.8, 0.02);
}

// A wedge with its edge along y at the origin, between z = 0 and z = x / 2: the ball that touches the floor at x touches the roof, too.
TEST(ThicknessMap, OfAWedgeGrowsWithTheDistanceFromItsEdge) {
  TriangleSoup wedge{{{0, 0, 0}, {4, 0, 0}, {4, 0, 2}, {0, 3, 0}, {4, 3, 0}, {4, 3, 2}}, {{0, 1, 2}, {3, 5, 4}, {0, 3, 4}, {0, 4, 1}, {0, 2, 5}, {0, 5, 3}, {1, 4, 5}, {1, 5, 2}}, {}};
  const double slope = 2 * std::tan(std::atan(0.5) / 2);
  std::size_t seen = 0;
  for (const ThicknessSample& s : thickness_samples(wedge, 3000)) {
    if (s.at.z > 1e-12 || s.at.x > 2) continue;
    EXPECT_NEAR(s.thickness, slope * s.at.x, 0.01 * slope * s.at.x);
    ++seen;
  }
  EXPECT_GT(seen, 100u);
}

TEST(ThicknessMap, TurnsAndGrowsWithTheModel) {
  const TriangleSoup part = bracket(6);
  const double c = std::cos(0.7), s = std::sin(0.7);
  const auto a = thickness_samples(part, 200);
  const auto b = thickness_samples(mapped(part, [&](const Vec3& p) { return Vec3{3 * (c * p.x - s * p.z) + 50, 3 * p.y, 3 * (s * p.x + c * p.z) - 7}; }), 200);
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) EXPECT_NEAR(b[i].thickness, 3 * a[i].thickness, 0.03 * a[i].thickness);
}

TEST(ThicknessMap, ThinPlacesAreListedByThickness) {
  const TriangleSoup soup = merged(merged(box({1, 1, 0.1}, 3, 3, 1), moved(box({1, 1, 0.05}, 3, 3, 1), {5, 0, 0})), moved(cube(), {10, 0, 0}));
  // Both sides of a wall are one place.
  const ThicknessSummary t = summary_of(soup, thickness_samples(soup, 1000), 0.2);
  ASSERT_EQ(t.places.size(), 2u);
  EXPECT_NEAR(t.minimum, 0.05, 1e-8);
  EXPECT_NEAR(t.places[0].thickness, 0.05, 1e-8);
  EXPECT_NEAR(t.places[1].thickness, 0.1, 1e-8);
  EXPECT_NEAR(t.places[0].area, 2, 1e-9);
  EXPECT_NEAR(t.thin_area, 4, 1e-9);
  EXPECT_GT(t.places[0].position.x, 4.9);
  EXPECT_TRUE(summary_of(soup, thickness_samples(soup, 1000), 0.04).places.empty());
}

TriangleSoup wavy_sheet(int n) {
  return height_field(n, [](int i, int j) { return 0.1 * ((i * 7 + j * 3) % 5); });
}

// Between the sheet and its floor stands the volume below the sheet; what is added goes on outwards by `outwards`.
TEST(SheetBlock, ClosesATerrainUnderneath) {
  const TriangleSoup sheet = wavy_sheet(4);
  const auto block = close_as_block(sheet, 0.01, 0.5);
  ASSERT_TRUE(block);
  const Shells shells = find_shells(block->soup);
  ASSERT_EQ(shells.shells.size(), 1u);
  EXPECT_TRUE(shells.shells[0].closed);
  EXPECT_GT(shells.shells[0].volume, 0.5);
  EXPECT_LT(shells.shells[0].volume, 1.02 * 1.02 * (0.5 + 0.4) + 0.3);
  for (std::size_t f = 0; f < sheet.facets.size(); ++f) EXPECT_EQ(block->soup.facets[f], sheet.facets[f]);
}

TEST(SheetBlock, IsNotForClosedOrFoldedSurfaces) {
  EXPECT_FALSE(close_as_block(icosphere(2), 0.1, 0.1));
  EXPECT_FALSE(close_as_block(without_facets(icosphere(2), {0}), 0.1, 0.1));
}

}  // namespace
}  // namespace burnish
