// The thesis' test cases: facet counts, validity, topology, and that dirt is what was asked for.
#include "burnish/surface/example_shapes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <ostream>

#include "burnish/core/error.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"

namespace burnish {
namespace {

// Handles of a closed connected surface, by Euler's formula with E = 3F/2.
long long genus(const TriangleSoup& welded) {
  const auto points = static_cast<long long>(welded.points.size());
  const auto facets = static_cast<long long>(welded.facets.size());
  return (2 - (points - facets / 2)) / 2;
}

Defects defects_without_intersections(const TriangleSoup& soup) {
  return inspect(weld(soup), {.self_intersections = false}).defects;
}

bool same(const TriangleSoup& a, const TriangleSoup& b) {
  return a.points == b.points && a.facets == b.facets;
}

bool fits_float(const TriangleSoup& soup) {
  for (const Vec3& p : soup.points)
    for (int axis = 0; axis < 3; ++axis)
      if (static_cast<double>(static_cast<float>(p[axis])) != p[axis]) return false;
  return true;
}

// The volume of the sphere's 25-sided frusta and pyramids.
double faceted_sphere_volume() {
  constexpr int kSlices = 25, kStacks = 12;
  const double pi = std::acos(-1.0);
  const double polygon = 0.5 * kSlices * std::sin(2 * pi / kSlices);  // area at radius 1
  double volume = 0;
  for (int s = 0; s < kStacks; ++s) {
    const double a = pi * s / kStacks, b = pi * (s + 1) / kStacks;
    const double ra = std::sin(a), rb = std::sin(b);
    volume += polygon * (std::cos(a) - std::cos(b)) * (ra * ra + ra * rb + rb * rb) / 3;
  }
  return volume;
}

struct Expected {
  ExampleShape shape;
  std::size_t facets;
  long long genus;
};

void PrintTo(const Expected& e, std::ostream* out) { *out << e.facets << " facets"; }

class ClosedExample : public testing::TestWithParam<Expected> {};

TEST_P(ClosedExample, IsAValidSolidOfTheThesisFacetCount) {
  const Example example = make_example(GetParam().shape, {});
  EXPECT_EQ(example.dirty.facets.size(), GetParam().facets);
  EXPECT_EQ(example.dirty.points.size(), 3 * GetParam().facets);
  EXPECT_TRUE(fits_float(example.dirty));
  const TriangleSoup welded = weld(example.dirty);
  const Defects defects = inspect(welded).defects;
  EXPECT_TRUE(defects.valid_solid()) << defects.self_intersecting_pairs << " self-intersections";
  EXPECT_EQ(defects.components, 1u);
  EXPECT_EQ(genus(welded), GetParam().genus);
}

TEST_P(ClosedExample, EqualsItsTruth) {
  const Example example = make_example(GetParam().shape, {});
  EXPECT_EQ(example.truth.points.size(), weld(example.dirty).points.size());
  EXPECT_TRUE(same(weld(example.dirty), weld(example.truth)));
}

TEST_P(ClosedExample, RepeatsForASeedAndDiffersForAnother) {
  const ExampleOptions one{.noise = 0.1, .holes = 2, .seed = 1};
  const ExampleOptions two{.noise = 0.1, .holes = 2, .seed = 2};
  const Example a = make_example(GetParam().shape, one);
  EXPECT_TRUE(same(a.dirty, make_example(GetParam().shape, one).dirty));
  EXPECT_FALSE(same(a.dirty, make_example(GetParam().shape, two).dirty));
  EXPECT_TRUE(same(a.truth, make_example(GetParam().shape, two).truth));
}

TEST_P(ClosedExample, HasAsManyHolesAsAskedFor) {
  for (const std::uint64_t seed : {1, 2, 3, 4, 5}) {
    const Example example = make_example(GetParam().shape, {.holes = 3, .seed = seed});
    const Defects defects = defects_without_intersections(example.dirty);
    EXPECT_EQ(defects.open_loops, 3u) << "seed " << seed;
    EXPECT_EQ(defects.components, 1u);
    EXPECT_EQ(defects.non_manifold_edges + defects.non_manifold_points + defects.misoriented_edges, 0u);
    EXPECT_GT(area(example.dirty), 0.75 * area(example.truth));
  }
}

TEST_P(ClosedExample, IsAsNoisyAsAskedFor) {
  const Example example = make_example(GetParam().shape, {.noise = 0.1});
  const TriangleSoup noisy = weld(example.dirty);
  ASSERT_EQ(noisy.facets.size(), example.truth.facets.size());
  double sum = 0;
  for (std::size_t f = 0; f < noisy.facets.size(); ++f)
    for (int i = 0; i < 3; ++i) sum += squared_norm(noisy.corner(f, i) - example.truth.corner(f, i));
  const double rms = std::sqrt(sum / (3 * static_cast<double>(noisy.facets.size())));
  EXPECT_NEAR(rms / mean_edge_length(example.truth), 0.1, 0.01);
  EXPECT_EQ(defects_without_intersections(example.dirty).open_edges, 0u);
}

INSTANTIATE_TEST_SUITE_P(Shapes, ClosedExample,
                         testing::Values(Expected{ExampleShape::sphere, 550, 0},
                                         Expected{ExampleShape::vase, 1174, 0},
                                         Expected{ExampleShape::knot, 76'428, 1}));

TEST(ExampleSphere, HasTheVolumeOfItsFacets) {
  const Example example = make_example(ExampleShape::sphere, {});
  EXPECT_NEAR(signed_volume(example.dirty), faceted_sphere_volume(), 1e-6);
  for (const Vec3& p : example.dirty.points) EXPECT_NEAR(norm(p), 1, 1e-6);
}

TEST(ExampleNozzle, TruthIsAValidSolidWithOneHandle) {
  const Example example = make_example(ExampleShape::nozzle, {});
  EXPECT_TRUE(fits_float(example.truth));
  const TriangleSoup welded = weld(example.truth);
  const Defects defects = inspect(welded).defects;
  EXPECT_TRUE(defects.valid_solid()) << defects.self_intersecting_pairs << " self-intersections";
  EXPECT_EQ(defects.components, 1u);
  EXPECT_EQ(genus(welded), 1);
  EXPECT_NEAR(defects.box.extent().z, 6, 1e-6);
}

TEST(ExampleNozzle, ScanIsClosedAndHasStrayFragments) {
  for (const std::uint64_t seed : {1, 2}) {
    const Example example = make_example(ExampleShape::nozzle, {.seed = seed});
    EXPECT_EQ(example.dirty.facets.size(), 496'658u);
    EXPECT_TRUE(fits_float(example.dirty));
    const Defects defects = defects_without_intersections(example.dirty);
    EXPECT_TRUE(defects.closed_manifold());
    EXPECT_GE(defects.components, 49u);
    EXPECT_NEAR(defects.volume / signed_volume(example.truth), 1, 0.01);
  }
}

TEST(ExampleNozzle, HolesOpenTheWallNotTheFragments) {
  const Example example = make_example(ExampleShape::nozzle, {.holes = 12});
  const Defects defects = defects_without_intersections(example.dirty);
  EXPECT_GE(defects.open_loops, 12u);
  EXPECT_GE(defects.components, 49u);
  EXPECT_EQ(defects.non_manifold_edges + defects.non_manifold_points, 0u);
}

TEST(Example, HolesLeaveTheNoiseAsItIs) {
  const ExampleOptions noise{.noise = 0.1}, both{.noise = 0.1, .holes = 1};
  const TriangleSoup closed = make_example(ExampleShape::vase, noise).dirty;
  const TriangleSoup open = make_example(ExampleShape::vase, both).dirty;
  std::size_t f = 0;
  for (std::size_t g = 0; g < open.facets.size(); ++g, ++f)
    while (f < closed.facets.size() && closed.corner(f, 0) != open.corner(g, 0)) ++f;
  EXPECT_LE(f, closed.facets.size());
}

TEST(Example, EndsWithFewerHolesWhereNoMoreFit) {
  const Example example = make_example(ExampleShape::sphere, {.holes = 1000});
  const Defects defects = defects_without_intersections(example.dirty);
  EXPECT_GT(defects.open_loops, 3u);
  EXPECT_GT(defects.facets, 150u);
}

TEST(Example, RefusesNonsense) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(make_example(ExampleShape::sphere, {.noise = -1}), Error);
  EXPECT_THROW(make_example(ExampleShape::sphere, {.noise = nan}), Error);
  EXPECT_THROW(make_example(ExampleShape::sphere, {.holes = -1}), Error);
}

}  // namespace
}  // namespace burnish
