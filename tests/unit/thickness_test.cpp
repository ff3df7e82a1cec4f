#include "burnish/surface/thickness.h"

#include <gtest/gtest.h>

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
