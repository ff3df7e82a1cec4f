// Shape and topology of surfaces, against what is known of them by hand.
#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"
#include "burnish/surface/validate.h"
#include "burnish/surface/weld.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

TriangleSoup one_facet(const Vec3& a, const Vec3& b, const Vec3& c) { return {{a, b, c}, {{0, 1, 2}}, {}}; }

TEST(FacetShapes, EquilateralFacetHasSixtyDegreesAndRatioOne) {
  const FacetShapes s = facet_shapes(one_facet({0, 0, 0}, {2, 0, 0}, {1, std::sqrt(3.0), 0}));
  EXPECT_NEAR(s.smallest_angle, 60, 1e-12);
  EXPECT_NEAR(s.largest_angle, 60, 1e-12);
  EXPECT_NEAR(s.largest_ratio, 1, 1e-12);
  EXPECT_NEAR(s.mean_edge, 2, 1e-15);
  EXPECT_EQ(s.flat_facets, 0u);
}

// Sides 3, 4, 5: inradius 1, circumradius 5/2.
TEST(FacetShapes, RightFacet) {
  const FacetShapes s = facet_shapes(one_facet({0, 0, 0}, {3, 0, 0}, {0, 4, 0}));
  EXPECT_NEAR(s.largest_ratio, 1.25, 1e-14);
  EXPECT_NEAR(s.smallest_angle, std::atan(0.75) * 180 / std::numbers::pi, 1e-12);
  EXPECT_NEAR(s.largest_angle, 90, 1e-12);
  EXPECT_EQ(s.shortest_edge, 3);
  EXPECT_EQ(s.longest_edge, 5);
}

// A fan of facets with angles 1, 2, ... 1000 twentieths of a degree at its apex: percentiles by nearest rank.
TEST(FacetShapes, PercentilesOfKnownAngles) {
  TriangleSoup soup;
  for (std::uint32_t i = 1; i <= 1000; ++i) {
    const double angle = 0.05 * i * std::numbers::pi / 180;
    soup.points.insert(soup.points.end(), {{0, 0, 0}, {1, 0, 0}, {std::cos(angle), std::sin(angle), 0}});
    soup.facets.push_back({3 * i - 3, 3 * i - 2, 3 * i - 1});
  }
  const FacetShapes s = facet_shapes(soup);
  EXPECT_NEAR(s.smallest_angle, 0.05, 1e-9);
  EXPECT_NEAR(s.angle_of_thousandth, 0.1, 1e-5);
  EXPECT_NEAR(s.angle_of_hundredth, 0.55, 1e-5);
  EXPECT_NEAR(s.median_angle, 25.05, 1e-5);
  EXPECT_NEAR(s.share_below_10, 0.2, 1.01e-3);
  EXPECT_NEAR(s.share_below_25, 0.5, 1.01e-3);
}

TEST(FacetShapes, FlatFacetsAreCountedAndHaveNoRatio) {
  TriangleSoup soup = one_facet({0, 0, 0}, {1, 1, 1}, {2, 2, 2});
  soup.facets.push_back({0, 0, 1});
  const FacetShapes s = facet_shapes(soup);
  EXPECT_EQ(s.flat_facets, 2u);
  EXPECT_EQ(s.smallest_angle, 0);
  EXPECT_EQ(s.largest_ratio, 0);
  EXPECT_EQ(s.shortest_edge, 0);
  EXPECT_EQ(s.share_below_10, 1);
}

TEST(FacetShapes, SameBitsForAnyNumberOfThreads) {
  const TriangleSoup soup = icosphere(6);
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return facet_shapes(soup);
  };
  const FacetShapes one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.mean_edge, four.mean_edge);
  EXPECT_EQ(one.median_angle, four.median_angle);
  EXPECT_EQ(one.largest_ratio, four.largest_ratio);
}

TEST(SurfaceTopology, SphereTorusAndBoth) {
  const SurfaceTopology sphere = surface_topology(icosphere(2)), ring = surface_topology(torus(12, 8));
  ASSERT_EQ(sphere.components.size(), 1u);
  EXPECT_EQ(sphere.euler_characteristic, 2);
  EXPECT_EQ(sphere.genus, 0);
  EXPECT_EQ(ring.euler_characteristic, 0);
  EXPECT_EQ(ring.genus, 1);
  const SurfaceTopology both = surface_topology(merged(moved(icosphere(2), {5, 0, 0}), torus(12, 8)));
  ASSERT_EQ(both.components.size(), 2u);
  EXPECT_EQ(both.components[0].genus, 0);
  EXPECT_EQ(both.components[1].genus, 1);
  EXPECT_EQ(both.euler_characteristic, 2);
  EXPECT_EQ(both.genus, 1);
  EXPECT_EQ(both.cavities, 0u);
}

TEST(SurfaceTopology, HollowSphereHasACavity) {
  const SurfaceTopology t = surface_topology(merged(icosphere(2), flipped(scaled(icosphere(2), 0.5))));
  EXPECT_EQ(t.components.size(), 2u);
  EXPECT_EQ(t.cavities, 1u);
  EXPECT_TRUE(t.components[1].cavity);
  EXPECT_EQ(t.genus, 0);
}

TEST(SurfaceTopology, OpenSurfaceHasNoGenus) {
  const SurfaceTopology t = surface_topology(without_facets(icosphere(1), {3}));
  EXPECT_EQ(t.euler_characteristic, 1);
  EXPECT_FALSE(t.components[0].closed);
  EXPECT_FALSE(t.genus.has_value());
}

// Two cubes that share a corner: pulled apart there, each is a sphere.
TEST(SurfaceTopology, SharedPointCountsOnceAFan) {
  const SurfaceTopology t = surface_topology(weld(merged(cube(), moved(cube(), {1, 1, 1}))));
  ASSERT_EQ(t.components.size(), 2u);
  EXPECT_EQ(t.components[0].euler_characteristic, 2);
  EXPECT_EQ(t.components[1].euler_characteristic, 2);
  EXPECT_EQ(t.genus, 0);
}

TEST(Validation, FoldOfACubeIsNinetyDegrees) {
  EXPECT_NEAR(largest_fold(cube()), 90, 1e-12);
  const Validation v = validate(cube());
  EXPECT_TRUE(v.inspection.defects.valid_solid());
  EXPECT_EQ(v.topology.genus, 0);
  EXPECT_NEAR(v.shapes.smallest_angle, 45, 1e-12);
  EXPECT_NEAR(v.largest_fold, 90, 1e-12);
}

TEST(Validation, FoldOverIsNearAHundredAndEighty) {
  const TriangleSoup folded{{{0, 0, 0}, {1, 0, 0}, {0.5, 1, 0}, {0.5, 1, 0.001}}, {{0, 1, 2}, {1, 0, 3}}, {}};
  EXPECT_NEAR(largest_fold(folded), 180 - std::atan(0.001) * 180 / std::numbers::pi, 1e-9);
}

TEST(Validation, NothingOfNothing) {
  const Validation v = validate({});
  EXPECT_EQ(v.shapes.facets, 0u);
  EXPECT_TRUE(v.topology.components.empty());
  EXPECT_EQ(v.largest_fold, 0);
}

}  // namespace
}  // namespace burnish
