// Names and colours on another surface of the same model.
#include "burnish/surface/transfer.h"

#include <gtest/gtest.h>

#include <array>
#include <string>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using test::cube;
using test::icosphere;
using test::merged;
using test::moved;
using test::scaled;

constexpr Color kRed = color_of(255, 0, 0), kBlue = color_of(0, 0, 255);

// The unit cube and its neighbour in x, which share a wall.
TriangleSoup two_boxes() {
  TriangleSoup soup = merged(cube(), moved(cube(), {1, 0, 0}));
  soup.groups = {{"left", 0, 12}, {"right", 12, 12}};
  soup.colors.assign(12, kRed);
  soup.colors.resize(24, kBlue);
  return soup;
}

// Each facet cut into four, the last facet first.
TriangleSoup finer_and_reversed(const TriangleSoup& soup) {
  TriangleSoup result;
  for (std::size_t f = soup.facets.size(); f-- > 0;) {
    const Vec3 a = soup.corner(f, 0), b = soup.corner(f, 1), c = soup.corner(f, 2);
    const Vec3 ab = (a + b) / 2.0, bc = (b + c) / 2.0, ca = (c + a) / 2.0;
    for (const auto& t :
         {std::array{a, ab, ca}, std::array{ab, b, bc}, std::array{ca, bc, c}, std::array{ab, bc, ca}}) {
      const auto first = static_cast<std::uint32_t>(result.points.size());
      result.points.insert(result.points.end(), t.begin(), t.end());
      result.facets.push_back({first, first + 1, first + 2});
    }
  }
  return result;
}

double centroid_x(const TriangleSoup& soup, std::size_t f) {
  return (soup.corner(f, 0).x + soup.corner(f, 1).x + soup.corner(f, 2).x) / 3;
}

TEST(Transfer, EachFacetTakesNameAndColourOfItsPlace) {
  const TriangleSoup from = two_boxes();
  TriangleSoup to = finer_and_reversed(from);
  const double volume = signed_volume(to);
  transfer_attributes(from, TriangleIndex(from), to);
  ASSERT_EQ(to.groups.size(), 2u);
  EXPECT_EQ(to.groups[0].name, "left");
  EXPECT_EQ(to.groups[1].name, "right");
  EXPECT_EQ(to.groups[1].first_facet, to.groups[0].facet_count);
  EXPECT_EQ(to.groups[0].facet_count + to.groups[1].facet_count, 96u);
  EXPECT_NEAR(signed_volume(to), volume, 1e-12);
  for (std::size_t f = 0; f < to.facets.size(); ++f) {
    const bool is_left = f < to.groups[0].facet_count;
    EXPECT_EQ(to.colors[f], is_left ? kRed : kBlue);
    const double x = centroid_x(to, f);
    EXPECT_TRUE(x == 1 || is_left == (x < 1)) << x;  // the wall belongs to either
  }
}

TEST(Transfer, FacetsOfAGroupKeepTheirOrder) {
  const TriangleSoup from = two_boxes();
  TriangleSoup to = finer_and_reversed(from);
  transfer_attributes(from, TriangleIndex(from), to);
  for (const FacetGroup& g : to.groups)
    for (std::uint32_t f = g.first_facet + 1; f < g.first_facet + g.facet_count; ++f)
      EXPECT_LT(to.facets[f - 1][0], to.facets[f][0]);
}

TEST(Transfer, KnownSourcesAreNotAskedFor) {
  const TriangleSoup from = two_boxes();
  TriangleSoup to = moved(cube(), {1, 0, 0});
  std::vector<std::uint32_t> sources(12, kNoFacet);
  sources[5] = 3;  // of the left box
  transfer_attributes(from, TriangleIndex(from), to, sources);
  ASSERT_GE(to.groups.size(), 1u);
  EXPECT_EQ(to.groups[0].name, "left");
  bool found = false;
  for (std::uint32_t f = 0; f < to.groups[0].facet_count; ++f)
    found |= to.facets[f] == moved(cube(), {1, 0, 0}).facets[5];
  EXPECT_TRUE(found);
  EXPECT_EQ(to.colors[0], kRed);
  EXPECT_EQ(to.colors[11], kBlue);
}

TEST(Transfer, GroupsWithoutFacetsAreLeftOut) {
  TriangleSoup from = two_boxes();
  from.groups = {{"none", 0, 0}, {"left", 0, 12}, {"none", 12, 0}, {"right", 12, 12}, {"none", 24, 0}};
  TriangleSoup to = moved(scaled(cube(), 0.5), {1.5, 0.25, 0.25});
  transfer_attributes(from, TriangleIndex(from), to);
  ASSERT_EQ(to.groups.size(), 1u);
  EXPECT_EQ(to.groups[0].name, "right");
  EXPECT_EQ(to.groups[0].facet_count, 12u);
  EXPECT_EQ(to.facets, cube().facets);
}

TEST(Transfer, OneWithoutTheOtherAndNothingAtAll) {
  TriangleSoup from = two_boxes();
  from.groups.clear();
  TriangleSoup to = finer_and_reversed(from);
  const std::vector<Facet> before = to.facets;
  transfer_attributes(from, TriangleIndex(from), to);
  EXPECT_TRUE(to.groups.empty());
  EXPECT_EQ(to.facets, before);
  EXPECT_EQ(to.colors.front(), kBlue);
  EXPECT_EQ(to.colors.back(), kRed);
  from = two_boxes();
  from.colors.clear();
  transfer_attributes(from, TriangleIndex(from), to);
  EXPECT_TRUE(to.colors.empty());
  EXPECT_EQ(to.groups.size(), 2u);
  const TriangleSoup kept = to;
  from.groups.clear();
  transfer_attributes(from, TriangleIndex(from), to);
  EXPECT_EQ(to.groups.size(), 2u);
  EXPECT_EQ(to.facets, kept.facets);
}

TEST(Transfer, SameBitsForAnyNumberOfThreads) {
  TriangleSoup from = icosphere(4);
  const auto n = static_cast<std::uint32_t>(from.facets.size());
  for (std::uint32_t g = 0; g < 16; ++g) from.groups.push_back({std::to_string(g), n / 16 * g, n / 16});
  for (std::uint32_t f = 0; f < n; ++f) from.colors.push_back(color_of(f & 255, f >> 8, 7));
  const TriangleIndex index(from);
  TriangleSoup one = scaled(icosphere(5), 1.01), many = one;
  {
    const ThreadLimit limit(1);
    transfer_attributes(from, index, one);
  }
  {
    const ThreadLimit limit(4);
    transfer_attributes(from, index, many);
  }
  EXPECT_EQ(one.facets, many.facets);
  EXPECT_EQ(one.colors, many.colors);
  ASSERT_EQ(one.groups.size(), 16u);
  for (std::size_t g = 0; g < 16; ++g) EXPECT_EQ(one.groups[g].first_facet, many.groups[g].first_facet);
}

TEST(Transfer, CapsAreAGroupOfTheirOwnWithoutColour) {
  TriangleSoup open = test::without_facets(cube(), {0, 1});
  open.groups = {{"box", 0, 10}};
  open.colors.assign(10, kRed);
  const CappedSoup capped = cap_boundary(open);
  ASSERT_EQ(capped.soup.groups.size(), 2u);
  EXPECT_EQ(capped.soup.groups[1].first_facet, 10u);
  EXPECT_EQ(capped.soup.groups[1].facet_count, capped.soup.facets.size() - 10);
  ASSERT_EQ(capped.soup.colors.size(), capped.soup.facets.size());
  EXPECT_EQ(capped.soup.colors.back(), kNoColor);
}

}  // namespace
}  // namespace burnish
