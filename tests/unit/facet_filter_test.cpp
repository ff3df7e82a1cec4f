#include "burnish/surface/facet_filter.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <vector>

#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

void expect_sources_right(const TriangleSoup& before, const FilteredFacets& after) {
  ASSERT_EQ(after.source.size(), after.soup.facets.size());
  EXPECT_EQ(before.facets.size(), after.source.size() + after.degenerate + after.duplicate + after.walls);
  for (std::size_t f = 0; f < after.source.size(); ++f) {
    if (f > 0) {
      EXPECT_LT(after.source[f - 1], after.source[f]);
    }
    for (int i = 0; i < 3; ++i) EXPECT_EQ(after.soup.corner(f, i), before.corner(after.source[f], i));
  }
}

TEST(FacetFilter, NothingUselessNothingLeftOut) {
  const TriangleSoup soup = weld(cube());
  const FilteredFacets kept = filter_facets(soup, false);
  expect_sources_right(soup, kept);
  EXPECT_EQ(kept.soup.facets, soup.facets);
}

// Two cubes with a face in common: one body of 20 facets.
TEST(FacetFilter, TheWallBetweenTwoBodiesGoes) {
  const TriangleSoup soup = weld(merged(cube(), moved(cube(), {1, 0, 0})));
  const FilteredFacets kept = filter_facets(soup, true);
  expect_sources_right(soup, kept);
  EXPECT_EQ(kept.walls, 4u);
  EXPECT_EQ(kept.duplicate, 0u);
  const Defects d = inspect(kept.soup).defects;
  EXPECT_TRUE(d.valid_solid());
  EXPECT_NEAR(d.volume, 2, 1e-12);
}

// A face in common and both cubes facing the same way there: copies, of which the surface needs none, but which are no wall.
TEST(FacetFilter, CopiesThatFaceTheSameWayKeepOne) {
  const TriangleSoup once = weld(with_copied_facet(cube(), 7));
  const FilteredFacets kept = filter_facets(once, true);
  expect_sources_right(once, kept);
  EXPECT_EQ(kept.duplicate, 1u);
  EXPECT_TRUE(inspect(kept.soup).defects.valid_solid());
  for (const int copies : {2, 3}) {
    SCOPED_TRACE(copies);
    TriangleSoup soup = cube();
    for (int i = 1; i < copies; ++i) soup = merged(soup, cube());
    const FilteredFacets one = filter_facets(weld(soup), true);
    EXPECT_EQ(one.duplicate, 12u * static_cast<unsigned>(copies - 1));
    EXPECT_EQ(one.walls, 0u);
    EXPECT_TRUE(inspect(one.soup).defects.valid_solid());
  }
}

TEST(FacetFilter, AShellAndItsFlippedCopyKeepOne) {
  const TriangleSoup soup = weld(merged(icosphere(1), flipped(icosphere(1))));
  const FilteredFacets kept = filter_facets(soup, true);
  expect_sources_right(soup, kept);
  EXPECT_EQ(kept.duplicate, 80u);
  EXPECT_EQ(kept.walls, 0u);
  EXPECT_TRUE(inspect(kept.soup).defects.valid_solid());
}

// Facets back to back: by themselves, and standing on a cube's edge.
TEST(FacetFilter, SheetsThatFaceBothWaysGo) {
  for (const bool on_cube : {false, true}) {
    TriangleSoup soup = cube();
    const double x = on_cube ? 0 : 5;
    soup.points.insert(soup.points.end(), {{x, 0, 0}, {x, 0, 1}, {x - 1, -1, 0.5}});
    soup.facets.push_back({8, 9, 10});
    soup.facets.push_back({8, 10, 9});
    soup = weld(soup);
    const FilteredFacets kept = filter_facets(soup, true);
    expect_sources_right(soup, kept);
    EXPECT_EQ(kept.walls, 2u);
    EXPECT_EQ(kept.soup.facets.size(), 12u);
  }
}

// A facet turned over on top of itself, in a closed surface, is needed once.
TEST(FacetFilter, AFlippedCopyInAClosedSurfaceKeepsTheFirst) {
  TriangleSoup soup = weld(cube());
  soup.facets.push_back({soup.facets[5][0], soup.facets[5][2], soup.facets[5][1]});
  const FilteredFacets kept = filter_facets(soup, true);
  expect_sources_right(soup, kept);
  EXPECT_EQ(kept.duplicate, 1u);
  EXPECT_TRUE(inspect(kept.soup).defects.valid_solid());
}

// A needle that closes a T-junction in the middle of an edge, and a facet that repeats a point.
TEST(FacetFilter, CollinearFacetsStayIfAskedFor) {
  TriangleSoup soup = cube();
  soup.points.push_back({0.5, 0, 0});
  soup.facets[4] = {8, 1, 5};
  soup.facets.insert(soup.facets.end(), {{0, 8, 5}, {0, 1, 8}, {3, 3, 2}});
  soup = weld(soup);
  ASSERT_EQ(inspect(soup).defects.open_edges, 0u);
  const FilteredFacets with = filter_facets(soup, true), without = filter_facets(soup, false);
  expect_sources_right(soup, with);
  expect_sources_right(soup, without);
  EXPECT_EQ(with.degenerate, 1u);
  EXPECT_EQ(inspect(with.soup).defects.open_edges, 0u);
  EXPECT_EQ(without.degenerate, 2u);
  EXPECT_EQ(inspect(without.soup).defects.open_edges, 3u);
}

TEST(FacetFilter, GroupsFollow) {
  TriangleSoup soup = merged(cube(), moved(cube(), {1, 0, 0}));
  soup.groups = {{"left", 0, 12}, {"right", 12, 12}};
  const FilteredFacets kept = filter_facets(weld(soup), true);
  ASSERT_EQ(kept.soup.groups.size(), 2u);
  EXPECT_EQ(kept.soup.groups[0].name, "left");
  EXPECT_EQ(kept.soup.groups[0].facet_count, 10u);
  EXPECT_EQ(kept.soup.groups[1].first_facet, 10u);
  EXPECT_EQ(kept.soup.groups[1].facet_count, 10u);
}

}  // namespace
}  // namespace burnish
