#include "burnish/surface/compare.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "burnish/core/parallel.h"
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

}  // namespace
}  // namespace burnish
