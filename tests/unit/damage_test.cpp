// What the tests of the pipeline begin with: clean parts are clean, and damage does what it says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <set>

#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/damage.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

TEST(Parts, AreValidSolidsOfKnownVolume) {
  const Defects b = inspect(box({3, 2, 1}, 6, 4, 3)).defects, p = inspect(thin_plate()).defects;
  EXPECT_TRUE(b.valid_solid());
  EXPECT_NEAR(b.volume, 6, 1e-12);
  EXPECT_NEAR(b.area, 22, 1e-12);
  EXPECT_TRUE(p.valid_solid());
  EXPECT_NEAR(p.volume, 0.012, 1e-12);
}

TEST(Parts, BracketHasTwoHoles) {
  for (const int n : {2, 6}) {
    const Defects d = inspect(bracket(n)).defects;
    EXPECT_TRUE(d.valid_solid());
    EXPECT_EQ(d.components, 1u);
    EXPECT_EQ(static_cast<long>(d.points) - static_cast<long>(d.facets) / 2, -2);  // 2 - 2 x genus
    const double hole = 2 * n * 0.09 * std::sin(std::numbers::pi / (2 * n));       // a regular polygon of 4 n corners
    EXPECT_NEAR(d.volume, 1 + 2 * 0.25 * (1 - hole), 1e-12);
  }
}

TEST(DamageItself, JitteredFacetsShareNothing) {
  const TriangleSoup soup = weld(unwelded_and_jittered(icosphere(2), 0.02, 1));
  const Defects d = inspect(soup, {.self_intersections = false}).defects;
  EXPECT_EQ(d.points, 3 * d.facets);
  EXPECT_EQ(d.open_edges, 3 * d.facets);
  EXPECT_NEAR(d.area / area(icosphere(2)), 1, 0.01);
}

TEST(DamageItself, RoundHoleHasItsShareAndOneRim) {
  for (const double share : {0.01, 0.2, 0.5}) {
    const TriangleSoup soup = with_round_hole(icosphere(4), share, 3);
    EXPECT_NEAR(area(soup) / area(icosphere(4)), 1 - share, 0.001);
    EXPECT_EQ(inspect(weld(soup)).defects.open_loops, 1u);
  }
}

TEST(DamageItself, SlitsAreLoopsOfTwoBanks) {
  const Defects d = inspect(with_slits(icosphere(3), 3, 6, 0.1, 1)).defects;
  EXPECT_EQ(d.open_loops, 3u);
  EXPECT_EQ(d.open_edges, 3u * 2 * 6);
  EXPECT_EQ(d.self_intersecting_pairs, 0u);
}

// Two that meet at one edge leave a crack of four edges.
TEST(DamageItself, TJunctionsLeaveACrackOfThreeEdgesEach) {
  const TriangleSoup whole = icosphere(3), soup = with_t_junctions(whole, 0.05, 0.01, 1);
  const std::size_t cut = soup.facets.size() - whole.facets.size();
  EXPECT_GT(cut, 30u);
  const std::size_t open = inspect(weld(soup)).defects.open_edges;
  EXPECT_LE(open, 3 * cut);
  EXPECT_GE(open, 2 * cut + cut / 2);
}

TEST(DamageItself, FinStandsOnItsPath) {
  const Defects d = inspect(with_fin(icosphere(3), 5, 1, 1)).defects;
  EXPECT_EQ(d.non_manifold_edges, 5u);
  EXPECT_EQ(d.open_edges, 5u + 2);
}

TEST(DamageItself, SliversChangeNeitherVolumeNorArea) {
  const TriangleSoup whole = icosphere(3), soup = with_slivers(whole, 0.05, 1);
  EXPECT_GT(soup.facets.size(), whole.facets.size() + 100);
  EXPECT_NEAR(signed_volume(soup), signed_volume(whole), 1e-12);
  EXPECT_NEAR(area(soup), area(whole), 1e-12);
}

TEST(DamageItself, ShuffledFacetsAreTheSameOnes) {
  const TriangleSoup whole = box({1, 1, 1}, 3, 3, 3), soup = shuffled(whole, 1);
  EXPECT_NE(soup.facets, whole.facets);
  const auto cycles = [](const TriangleSoup& s) {
    std::multiset<Facet> sorted;
    for (Facet f : s.facets) {
      std::rotate(f.begin(), std::min_element(f.begin(), f.end()), f.end());
      sorted.insert(f);
    }
    return sorted;
  };
  EXPECT_EQ(cycles(soup), cycles(whole));
}

}  // namespace
}  // namespace burnish
