#include "burnish/surface/compare.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/exact_distance.h"
#include "burnish/surface/triangle_index.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

TEST(Compare, ASurfaceIsNowhereFromItself) {
  const TriangleSoup soup = torus(40, 20);
  const OneSidedDistance d = one_sided_distance(soup, TriangleIndex(soup));
  EXPECT_LE(d.max, 1e-15);
  EXPECT_EQ(d.samples, 60'000u + soup.points.size());
}

TEST(Compare, ConcentricCubesAreAFaceDistanceApart) {
  const TriangleSoup small = moved(scaled(cube(), 2), {-1, -1, -1}), large = moved(scaled(cube(), 3), {-1.5, -1.5, -1.5});
  const OneSidedDistance out = one_sided_distance(small, TriangleIndex(large));
  EXPECT_NEAR(out.max, 0.5, 1e-15);
  EXPECT_NEAR(out.mean, 0.5, 1e-12);
  EXPECT_NEAR(out.rms, 0.5, 1e-12);
  // The other way round corners are farther than faces; vertices are samples.
  const OneSidedDistance in = one_sided_distance(large, TriangleIndex(small));
  EXPECT_NEAR(in.max, 0.5 * std::sqrt(3.0), 1e-15);
  EXPECT_GT(in.mean, 0.5);
  EXPECT_GT(in.rms, in.mean);
}

// Points of a tilted square at distance x of a plane, x uniform in [0, 1]: mean 1/2, rms 1/sqrt 3.
TEST(Compare, MeansAreAreaWeighted) {
  TriangleSoup tilted, flat;
  tilted.points = {{0, 0, 0}, {1, 0, 1}, {1, 1, 1}, {0, 1, 0}, {0.01, 0.01, 0.01}};
  tilted.facets = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};  // cut unevenly
  flat.points = {{-9, -9, 0}, {9, -9, 0}, {0, 20, 0}};
  flat.facets = {{0, 1, 2}};
  const OneSidedDistance d = one_sided_distance(tilted, TriangleIndex(flat));
  EXPECT_NEAR(d.max, 1, 1e-15);
  EXPECT_NEAR(d.mean, 0.5, 1e-3);
  EXPECT_NEAR(d.rms, 1 / std::sqrt(3.0), 1e-3);
}

TEST(Compare, SameBitsForAnyNumberOfThreads) {
  const TriangleSoup from = icosphere(4);
  const TriangleIndex to(scaled(torus(50, 20), 0.7));
  const auto measure = [&](int threads) {
    const ThreadLimit limit(threads);
    return one_sided_distance(from, to);
  };
  const OneSidedDistance one = measure(1), four = measure(4);
  EXPECT_EQ(one.max, four.max);
  EXPECT_EQ(one.mean, four.mean);
  EXPECT_EQ(one.rms, four.rms);
}

TEST(Compare, NothingIsNoDistance) {
  EXPECT_EQ(one_sided_distance(TriangleSoup{}, TriangleIndex(cube())).samples, 0u);
  EXPECT_EQ(one_sided_distance(cube(), TriangleIndex(TriangleSoup{})).samples, 0u);
}

TEST(Compare, FindsMissingComponents) {
  const TriangleSoup large = icosphere(2), small = moved(scaled(icosphere(1), 0.1), {3, 0, 0});
  const TriangleSoup both = merged(large, small);
  const MissingComponents missing = missing_components(both, TriangleIndex(large), 0.01);
  EXPECT_EQ(missing.count, 1u);
  EXPECT_NEAR(missing.area, area(small), 1e-12);
  EXPECT_NEAR(norm(missing.largest_at - Vec3{3, 0, 0}), 0.1, 1e-6);
  EXPECT_EQ(missing_components(both, TriangleIndex(both), 0.01).count, 0u);
}

// A square 5 above a sphere, of area 4: the samples on it are far, say how far and on which facet, and stand for its area.
TEST(Compare, ListsFarSamples) {
  const TriangleSoup near = icosphere(3);
  TriangleSoup square;
  square.points = {{-1, -1, 6}, {1, -1, 6}, {1, 1, 6}, {-1, 1, 6}};
  square.facets = {{0, 1, 2}, {0, 2, 3}};
  const TriangleSoup both = merged(near, square);
  std::vector<FarSample> far;
  const OneSidedDistance d = one_sided_distance(both, TriangleIndex(near), {.far_beyond = 1}, &far);
  double stands_for = 0;
  std::size_t points = 0;
  for (const FarSample& sample : far) {
    EXPECT_EQ(sample.at.z, 6);
    EXPECT_GE(sample.facet, near.facets.size());
    EXPECT_NEAR(sample.distance, norm(sample.at) - 1, 0.01);
    stands_for += sample.area;
    points += sample.area == 0;
  }
  EXPECT_EQ(points, 4u);
  EXPECT_NEAR(stands_for, 4, 0.01);
  EXPECT_NEAR(d.max, std::sqrt(38.0) - 1, 0.01);
}

TEST(Compare, NothingIsFarFromItself) {
  const TriangleSoup soup = torus(20, 10);
  std::vector<FarSample> far;
  one_sided_distance(soup, TriangleIndex(soup), {.far_beyond = 1e-12}, &far);
  EXPECT_TRUE(far.empty());
  one_sided_distance(moved(soup, {10, 0, 0}), TriangleIndex(soup), {}, &far);
  EXPECT_TRUE(far.empty()) << "without a limit nothing is far";
}

ClosestQuery query(const TriangleIndex& index) {
  return [&index](const Vec3& p) -> ClosestPoint {
    const TriangleIndex::Closest c = index.closest(p);
    return {c.point, c.squared_distance, c.facet};
  };
}

ClosestQuery query(const ExactDistance& distances) {
  return [&distances](const Vec3& p) -> ClosestPoint {
    const ExactDistance::Closest c = distances.closest(p);
    return {c.point, c.squared_distance, c.facet};
  };
}

OneSidedComparison compared(const TriangleSoup& from, const TriangleSoup& to, const CompareOptions& options = {}) {
  const TriangleIndex index(to);
  return one_sided_comparison(from, to, query(index), options);
}

OneSidedComparison compared_exactly(const TriangleSoup& from, const TriangleSoup& to, const CompareOptions& options) {
  const ExactDistance distances(to);
  return one_sided_comparison(from, to, query(distances), options);
}

TEST(Compare, ConcentricCubesInFull) {
  const TriangleSoup small = moved(scaled(cube(), 2), {-1, -1, -1}), large = moved(scaled(cube(), 3), {-1.5, -1.5, -1.5});
  const OneSidedComparison out = compared(small, large);
  EXPECT_NEAR(out.distance.max, 0.5, 1e-15);
  for (const double value : out.distance.percentiles) EXPECT_NEAR(value, 0.5, 1e-15);
  EXPECT_EQ(out.distance.samples, 60'008u);
  EXPECT_EQ(out.angle.samples, 60'000u);
  EXPECT_LE(out.angle.max, 1e-12);
  const OneSidedComparison in = compared(large, small);
  EXPECT_NEAR(in.distance.max, 0.5 * std::sqrt(3.0), 1e-15);
  EXPECT_NEAR(norm(in.farthest), 1.5 * std::sqrt(3.0), 1e-15);  // a corner, and the one opposite to it
  EXPECT_NEAR(norm(in.opposite - in.farthest / 1.5), 0, 1e-15);
}

TEST(Compare, AShiftedCube) {
  const TriangleSoup a = cube(), b = moved(cube(), {0.125, 0, 0});
  for (const auto& [from, to] : {std::pair{a, b}, std::pair{b, a}}) {
    const OneSidedComparison d = compared_exactly(from, to, {.area_samples = 500});
    EXPECT_EQ(d.distance.max, 0.125) << "no rounding at all";
    EXPECT_EQ(d.distance.percentiles.back(), 0.125);
    EXPECT_LE(d.distance.percentiles.front(), 1e-15) << "four faces of six have not moved";
  }
}

// Scaling moves a facet's plane by a tenth of its distance from the centre, and a point by a tenth of its own.
TEST(Compare, ConcentricSpheres) {
  const TriangleSoup small = icosphere(4), large = scaled(small, 1.1);
  double nearest_plane = 1, steepest = 0;
  for (std::size_t f = 0; f < small.facets.size(); ++f) {
    const Vec3 n = facet_normal_2a(small, f);
    nearest_plane = std::min(nearest_plane, dot(n, small.corner(f, 0)) / norm(n));
    steepest = std::max(steepest, std::acos(nearest_plane) * 180 / std::numbers::pi);
  }
  for (const auto& [from, to] : {std::pair{small, large}, std::pair{large, small}}) {
    const OneSidedComparison d = compared(from, to);
    EXPECT_LE(d.distance.max, 0.1 + 1e-15);
    EXPECT_GE(d.distance.percentiles.front(), 0.1 * nearest_plane - 1e-3);
    EXPECT_LE(d.angle.percentiles.front(), 1e-6) << "most samples face the same facet";
    EXPECT_LE(d.angle.max, 4 * steepest);
  }
}

TriangleSoup tilted_square(double degrees) {
  const double c = std::cos(degrees * std::numbers::pi / 180), s = std::sin(degrees * std::numbers::pi / 180);
  return {{{0, 0, 1}, {c, 0, 1 + s}, {c, 1, 1 + s}, {0, 1, 1}}, {{0, 1, 2}, {0, 2, 3}}, {}};
}

TEST(Compare, AnglesBetweenNormals) {
  const TriangleSoup flat{{{-9, -9, 0}, {9, -9, 0}, {0, 20, 0}}, {{0, 1, 2}}, {}};
  for (const double degrees : {1e-5, 1.0, 30.0, 60.0, 89.0}) {
    const TriangleSoup tilted = tilted_square(degrees);
    const Distribution there = compared(tilted, flat).angle, over = compared(flipped(tilted), flat).angle;
    for (const double value : {there.mean, there.rms, there.max, there.percentiles[0], there.percentiles[4]})
      EXPECT_NEAR(value, degrees, 1e-11);
    EXPECT_NEAR(over.mean, 180 - degrees, 1e-11);
  }
  // Facets without area have no normal, and do not count.
  const TriangleSoup line{{{-9, 0, 0}, {9, 0, 0}, {1, 0, 0}}, {{0, 1, 2}}, {}};
  EXPECT_EQ(compared(tilted_square(30), line).angle.samples, 0u);
  EXPECT_EQ(compared(line, flat).angle.samples, 0u);
  EXPECT_EQ(compared(line, flat).distance.samples, 3u);
}

// Heights over a plane, uniform in [1, 1.5]: percentiles are their own.
TEST(Compare, PercentilesOfAUniformDistribution) {
  const TriangleSoup flat{{{-9, -9, 0}, {9, -9, 0}, {0, 20, 0}}, {{0, 1, 2}}, {}};
  const Distribution d = compared(tilted_square(30), flat).distance;
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) EXPECT_NEAR(d.percentiles[i], 1 + 0.5 * kPercentiles[i] / 100, 1e-3);
  EXPECT_NEAR(d.max, 1.5, 1e-15);
  const Distribution one = compared(tilted_square(30), flat, {.area_samples = 1}).distance;
  for (const double value : one.percentiles) EXPECT_EQ(value, one.mean);
}

TEST(Compare, ExactAndRoundedQueriesAgree) {
  const TriangleSoup from = icosphere(2), to = moved(torus(12, 7), {0.1, 0.2, 0.3});
  const CompareOptions few{.area_samples = 300};
  const OneSidedComparison rounded = compared(from, to, few), exact = compared_exactly(from, to, few);
  EXPECT_NEAR(rounded.distance.max, exact.distance.max, 1e-14);
  EXPECT_NEAR(rounded.distance.rms, exact.distance.rms, 1e-14);
  for (std::size_t i = 0; i < kPercentiles.size(); ++i)
    EXPECT_NEAR(rounded.distance.percentiles[i], exact.distance.percentiles[i], 1e-14);
}

TEST(Compare, InFullWithTheSameBitsForAnyNumberOfThreads) {
  const TriangleSoup from = icosphere(3), to = scaled(torus(50, 20), 0.7);
  const auto measure = [&](int threads) {
    const ThreadLimit limit(threads);
    return compared(from, to);
  };
  const OneSidedComparison one = measure(1), four = measure(4);
  EXPECT_EQ(one.distance.rms, four.distance.rms);
  EXPECT_EQ(one.distance.percentiles, four.distance.percentiles);
  EXPECT_EQ(one.angle.rms, four.angle.rms);
  EXPECT_EQ(one.angle.percentiles, four.angle.percentiles);
  EXPECT_EQ(one.farthest, four.farthest);
  // The table that `clean` prints is about the same samples.
  const OneSidedDistance brief = one_sided_distance(from, TriangleIndex(to));
  EXPECT_EQ(brief.max, one.distance.max);
  EXPECT_NEAR(brief.mean, one.distance.mean, 1e-14);
  EXPECT_EQ(brief.samples, one.distance.samples);
}

}  // namespace
}  // namespace burnish
