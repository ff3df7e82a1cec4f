#include "burnish/surface/local_repair.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <numbers>
#include <string>
#include <vector>

#include "burnish/surface/inspect.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/weld.h"
#include "support/damage.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

TriangleSoup without_facets_where(const TriangleSoup& soup, const std::function<bool(const Vec3&)>& drop) {
  std::vector<std::size_t> facets;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (drop((soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3)) facets.push_back(f);
  return weld(without_facets(soup, facets));
}

// A facet with a source has its corners, bit for bit and in the same order; no source has two.
void expect_sources_right(const TriangleSoup& before, const LocalRepairResult& after) {
  ASSERT_EQ(after.source.size(), after.soup.facets.size());
  ASSERT_EQ(after.fills_hole.size(), after.soup.facets.size());
  std::vector<char> taken(before.facets.size(), 0);
  for (std::size_t f = 0; f < after.source.size(); ++f) {
    const std::uint32_t source = after.source[f];
    if (source == kNoFacet) continue;
    ASSERT_FALSE(taken[source]++);
    ASSERT_FALSE(after.fills_hole[f]);
    for (int i = 0; i < 3; ++i) ASSERT_EQ(after.soup.corner(f, i), before.corner(source, i));
  }
}

std::size_t count_kept(const LocalRepairResult& r) {
  return r.source.size() - static_cast<std::size_t>(std::count(r.source.begin(), r.source.end(), kNoFacet));
}

std::size_t count_filling(const LocalRepairResult& r) { return static_cast<std::size_t>(std::count(r.fills_hole.begin(), r.fills_hole.end(), 1)); }

TEST(LocalRepair, ASolidStaysAsItIs) {
  const TriangleSoup soup = weld(bracket(4));
  const LocalRepairResult r = repair_locally(soup);
  ASSERT_EQ(r.refusal, "");
  expect_sources_right(soup, r);
  EXPECT_EQ(count_kept(r), soup.facets.size());
  EXPECT_EQ(r.soup.facets.size(), soup.facets.size());
  EXPECT_TRUE(r.holes.empty());
}

TEST(LocalRepair, ACubesFaceIsFilled) {
  const TriangleSoup soup = without_facets_where(cube(), [](const Vec3& p) { return p.z == 1; });
  const LocalRepairResult r = repair_locally(soup);
  ASSERT_EQ(r.refusal, "");
  expect_sources_right(soup, r);
  EXPECT_EQ(count_kept(r), 10u);
  EXPECT_EQ(count_filling(r), 2u);
  ASSERT_EQ(r.holes.size(), 1u);
  EXPECT_EQ(r.holes[0].edges, 4u);
  EXPECT_TRUE(r.holes[0].filled);
  EXPECT_NEAR(r.holes[0].area, 1, 1e-12);
  EXPECT_NEAR(r.holes[0].perimeter, 4, 1e-12);
  EXPECT_NEAR(norm(r.holes[0].position - Vec3{0.5, 0.5, 1}), 0, 1e-12);
  const Defects d = inspect(r.soup).defects;
  EXPECT_TRUE(d.valid_solid());
  EXPECT_NEAR(d.volume, 1, 1e-12);
}

// The hole's rim lies near a circle of height z: what fills it is a disc, and the cap above is missing.
TEST(LocalRepair, ASpheresCapIsReplacedByADisc) {
  const double z = 0.8, height = 1 - z, cap = kPi * height * height * (3 - height) / 3;
  const TriangleSoup sphere = icosphere(4), soup = without_facets_where(sphere, [&](const Vec3& p) { return p.z > z; });
  const LocalRepairResult r = repair_locally(soup);
  ASSERT_EQ(r.refusal, "");
  expect_sources_right(soup, r);
  EXPECT_EQ(count_kept(r), soup.facets.size());
  ASSERT_EQ(r.holes.size(), 1u);
  EXPECT_NEAR(r.holes[0].area / (kPi * (1 - z * z)), 1, 0.08);
  const Defects d = inspect(r.soup).defects;
  EXPECT_TRUE(d.valid_solid());
  EXPECT_NEAR(d.volume, signed_volume(sphere) - cap, 0.1 * cap);
}

// Two holes of known size, and a limit between them.
TEST(LocalRepair, HolesWiderThanTheLimitStayOpen) {
  const TriangleSoup soup = without_facets_where(icosphere(4), [](const Vec3& p) { return p.z > 0.9 || p.z < -0.6; });
  const LocalRepairResult r = repair_locally(soup, {.max_hole = 1.2});
  ASSERT_EQ(r.refusal, "");
  expect_sources_right(soup, r);
  ASSERT_EQ(r.holes.size(), 2u);
  EXPECT_FALSE(r.holes[0].filled);
  EXPECT_TRUE(r.holes[1].filled);
  // Rims zigzag along facets: longer than their circles.
  EXPECT_GT(r.holes[0].width(), 1.6);
  EXPECT_LT(r.holes[1].width(), 1.2);
  EXPECT_LT(r.holes[0].position.z, -0.5);
  const Defects d = inspect(r.soup).defects;
  EXPECT_TRUE(d.valid_sheet());
  EXPECT_EQ(d.open_loops, 1u);
  const LocalRepairResult none = repair_locally(soup, {.max_hole = 0});
  EXPECT_EQ(count_kept(none), none.soup.facets.size());
  EXPECT_EQ(inspect(none.soup).defects.open_loops, 2u);
}

// A point in the middle of an edge that only one side has, and a facet without an area in between.
TEST(LocalRepair, ANeedleIsFlippedAway) {
  TriangleSoup soup = cube();
  soup.points.push_back({0.5, 0, 0});
  soup.facets[4] = {8, 1, 5};
  soup.facets.insert(soup.facets.end(), {{0, 8, 5}, {0, 1, 8}});
  soup = weld(soup);
  ASSERT_EQ(inspect(soup).defects.degenerate_facets, 1u);
  const LocalRepairResult r = repair_locally(soup);
  ASSERT_EQ(r.refusal, "");
  expect_sources_right(soup, r);
  EXPECT_EQ(r.needles_flipped, 1u);
  EXPECT_EQ(count_kept(r), 12u) << "the needle and the facet across its long edge change, no other";
  const Defects d = inspect(r.soup).defects;
  EXPECT_TRUE(d.valid_solid());
  EXPECT_EQ(d.facets, 14u);
  EXPECT_NEAR(d.volume, 1, 1e-15);
}

// A point pushed aside over its neighbours' facets folds the surface over itself.
TEST(LocalRepair, IntersectingFacetsAreRemoved) {
  TriangleSoup soup = weld(icosphere(3));
  const double edge = mean_edge_length(soup);
  const Vec3 p = soup.points[100], aside = cross(p, Vec3{0.3, 0.5, 0.8});
  soup.points[100] = p * 0.97 + aside * (1.6 * edge / norm(aside));
  ASSERT_GT(inspect(soup).defects.self_intersecting_pairs, 0u);
  const LocalRepairResult r = repair_locally(soup);
  ASSERT_EQ(r.refusal, "");
  expect_sources_right(soup, r);
  EXPECT_GT(r.intersecting_pairs_removed, 0u);
  EXPECT_GT(count_kept(r), soup.facets.size() - 100);
  const Defects d = inspect(r.soup).defects;
  EXPECT_TRUE(d.valid_solid());
  EXPECT_NEAR(d.volume / signed_volume(icosphere(3)), 1, 0.01);
}

// What touches is moved apart by a thousandth of an edge, and no more.
TEST(LocalRepair, TouchingBodiesAreMovedApart) {
  for (const Vec3& by : {Vec3{1, 1, 0}, Vec3{1, 1, 1}}) {
    SCOPED_TRACE(by.z);
    const TriangleSoup soup = weld(merged(cube(), moved(cube(), by)));
    const LocalRepairResult r = repair_locally(soup);
    ASSERT_EQ(r.refusal, "");
    expect_sources_right(soup, r);
    EXPECT_EQ(r.points_split, by.z == 0 ? 2u : 1u);
    EXPECT_GT(r.largest_split, 0);
    EXPECT_LE(r.largest_split, 1.001e-3);
    EXPECT_GE(count_kept(r), 12u);
    const Defects d = inspect(r.soup).defects;
    EXPECT_TRUE(d.valid_solid());
    EXPECT_EQ(d.components, 2u);
    EXPECT_NEAR(d.volume, 2, 0.01);
  }
}

TEST(LocalRepair, SameResultEveryTime) {
  const TriangleSoup soup = orient(weld(without_random_facets(torus(40, 20), 0.05, 3))).soup;
  const LocalRepairResult a = repair_locally(soup), b = repair_locally(soup);
  ASSERT_EQ(a.refusal, "");
  EXPECT_EQ(a.soup.points, b.soup.points);
  EXPECT_EQ(a.soup.facets, b.soup.facets);
  EXPECT_EQ(a.source, b.source);
  expect_sources_right(soup, a);
  EXPECT_TRUE(inspect(a.soup).defects.valid_solid());
}

// A strip of squares with half a turn.
TriangleSoup moebius_strip(std::uint32_t n) {
  TriangleSoup soup;
  for (std::uint32_t i = 0; i < n; ++i) {
    const double t = 2 * kPi * i / n;
    for (const double s : {-0.3, 0.3}) {
      const double r = 1 + s * std::cos(t / 2);
      soup.points.push_back({r * std::cos(t), r * std::sin(t), s * std::sin(t / 2)});
    }
  }
  for (std::uint32_t i = 0; i < n; ++i) {
    const bool last = i + 1 == n;
    const std::uint32_t a = 2 * i, b = a + 1, c = last ? 1 : a + 2, d = last ? 0 : a + 3;
    soup.facets.push_back({a, c, b});
    soup.facets.push_back({c, d, b});
  }
  return soup;
}

TEST(LocalRepair, RefusesWhatItIsNotMadeForAndSaysWhy) {
  struct Refused {
    const char* what;
    TriangleSoup soup;
    const char* why;
  };
  const std::vector<Refused> all{
      {"a crumpled sheet", without_facets(jittered(icosphere(3), 1, 5), {0, 1, 2, 3}), "intersect"},
  };
  for (const Refused& r : all) {
    SCOPED_TRACE(r.what);
    const LocalRepairResult result = repair_locally(weld(r.soup), {.max_hole = 0.0, .float32 = false});
    EXPECT_NE(result.refusal.find(r.why), std::string::npos) << result.refusal;
    EXPECT_TRUE(result.soup.facets.empty());
  }
}

// Cut along its seam, whose two sides are moved apart, a one-sided strip is a two-sided one with a slit.
TEST(LocalRepair, OneSidedSurfacesAreCutAlongASeam) {
  const TriangleSoup strip = orient(moebius_strip(24)).soup;
  const LocalRepairResult r = repair_locally(strip, {.max_hole = 0});
  ASSERT_EQ(r.refusal, "");
  expect_sources_right(strip, r);
  EXPECT_EQ(r.points_split, 2u);
  const Defects d = inspect(r.soup).defects;
  EXPECT_TRUE(d.valid_sheet());
  EXPECT_EQ(d.facets, strip.facets.size());
  EXPECT_EQ(d.open_loops, 1u);
  EXPECT_NEAR(d.area / area(strip), 1, 1e-3);
}

}  // namespace
}  // namespace burnish
