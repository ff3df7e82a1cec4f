#include "burnish/surface/outliers.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <set>

#include "burnish/core/parallel.h"
#include "support/noise.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr std::uint64_t kSeed = 21;

// Every `step`-th point moved by `edges` mean edges along its normal, outwards and inwards by turns.
std::set<std::uint32_t> add_impulses(TriangleSoup& soup, const std::vector<Vec3>& normals, double edge, std::uint32_t step, double edges) {
  std::set<std::uint32_t> moved;
  for (std::uint32_t p = step; p < soup.points.size(); p += step) {
    soup.points[p] += normals[p] * (edge * (moved.size() % 2 ? edges : -edges));
    moved.insert(p);
  }
  return moved;
}

std::set<std::uint32_t> points_of(const std::vector<Outlier>& outliers) {
  std::set<std::uint32_t> points;
  for (const Outlier& o : outliers) points.insert(o.point);
  return points;
}

TEST(Outliers, ImpulsesAreFoundExactlyAndMovedBack) {
  for (const double noise_edges : {0.0, 0.05, 0.1}) {
    SCOPED_TRACE(testing::Message() << "noise " << noise_edges << " seed " << kSeed);
    const TriangleSoup ball = icosphere(5);
    const double edge = mean_edge_length(ball);
    TriangleSoup soup = with_noise(ball, noise_edges, kSeed);
    const auto impulses = add_impulses(soup, point_normals(ball), edge, 401, 2.5);
    const auto outliers = find_outliers(soup, estimate_noise(soup));
    EXPECT_EQ(points_of(outliers), impulses);
    for (const Outlier& o : outliers) {
      EXPECT_EQ(o.position, soup.points[o.point]);
      EXPECT_NEAR(o.distance, 2.5 * edge, 0.5 * edge);
    }
    clamp_outliers(outliers, soup);
    for (const std::uint32_t p : impulses) EXPECT_NEAR(norm(soup.points[p]), 1, (0.01 + 2 * noise_edges) * edge);
    EXPECT_TRUE(find_outliers(soup, estimate_noise(soup)).empty());
  }
}

TEST(Outliers, AreLeftOutOfSigma) {
  const TriangleSoup ball = icosphere(5);
  const double edge = mean_edge_length(ball);
  TriangleSoup soup = with_noise(ball, 0.1, kSeed);
  const auto impulses = add_impulses(soup, point_normals(ball), edge, 31, 2.5);
  const NoiseEstimate noise = estimate_noise(soup);
  EXPECT_NEAR(noise.sigma, 0.1 * edge, 0.015 * edge);
  EXPECT_NEAR(noise.outlier_share, static_cast<double>(impulses.size()) / static_cast<double>(soup.points.size()), 0.003);
}

TEST(Outliers, CornersCreasesAndTipsAreNone) {
  for (const TriangleSoup& part : {cube(), box({1, 1, 1}, 3, 3, 3), box({1, 1, 1}, 8, 8, 8), box({1, 0.7, 0.02}, 40, 28, 1), box({1, 0.7, 0.5}, 40, 28, 20)})
    EXPECT_TRUE(find_outliers(part, estimate_noise(part)).empty()) << part.facets.size() << " facets";
  // A cone over the unit square's middle, tall enough for a needle.
  for (const double height : {0.5, 2.0, 5.0}) {
    const auto cone = height_field(40, [&](int i, int j) { return height * std::max(0.0, 1 - std::hypot(i - 20, j - 20) / 18); });
    EXPECT_TRUE(find_outliers(cone, estimate_noise(cone)).empty()) << height;
  }
  const TriangleSoup ball = icosphere(4), ring = torus(40, 12);
  EXPECT_TRUE(find_outliers(ball, estimate_noise(ball)).empty());
  EXPECT_TRUE(find_outliers(ring, estimate_noise(ring)).empty());
}

TEST(Outliers, CornersOfNoisyPartsAreNone) {
  const TriangleSoup part = box({1, 0.7, 0.5}, 40, 28, 20);
  for (const double edges : {0.1, 0.2, 0.3, 0.5}) {
    const TriangleSoup noisy = with_noise(part, edges, kSeed);
    EXPECT_LE(find_outliers(noisy, estimate_noise(noisy)).size(), 1u) << "noise " << edges << " seed " << kSeed;
  }
}

TEST(Outliers, ASpikeOfOnePointIsFound) {
  TriangleSoup soup = height_field(30, [](int i, int j) { return i == 15 && j == 14 ? 1.0 : 0.0; });
  const auto outliers = find_outliers(soup, estimate_noise(soup));
  ASSERT_EQ(outliers.size(), 1u);
  EXPECT_NEAR(outliers[0].distance, 1, 1e-9);
  clamp_outliers(outliers, soup);
  for (const Vec3& p : soup.points) EXPECT_NEAR(p.z, 0, 1e-9);
}

// Rings of 3000 points around two apexes: rows longer than what is looked at of them.
TEST(Outliers, BesideFansOfThousandsOfFacets) {
  constexpr std::uint32_t kAround = 3000, kRings = 5;
  TriangleSoup soup;
  const auto at = [&](std::uint32_t ring, std::uint32_t i) { return ring * kAround + i % kAround; };
  for (std::uint32_t ring = 0; ring < kRings; ++ring)
    for (std::uint32_t i = 0; i < kAround; ++i) {
      const double angle = 2 * std::numbers::pi * i / kAround;
      soup.points.push_back({std::cos(angle), std::sin(angle), 2 * std::numbers::pi / kAround * ring});
    }
  const std::uint32_t bottom = kRings * kAround, top = bottom + 1;
  soup.points.push_back({0, 0, soup.points.front().z});
  soup.points.push_back({0, 0, soup.points[bottom - 1].z});
  for (std::uint32_t i = 0; i < kAround; ++i) {
    soup.facets.push_back({bottom, at(0, i + 1), at(0, i)});
    soup.facets.push_back({top, at(kRings - 1, i), at(kRings - 1, i + 1)});
    for (std::uint32_t ring = 0; ring + 1 < kRings; ++ring) {
      soup.facets.push_back({at(ring, i), at(ring, i + 1), at(ring + 1, i + 1)});
      soup.facets.push_back({at(ring, i), at(ring + 1, i + 1), at(ring + 1, i)});
    }
  }
  EXPECT_TRUE(find_outliers(soup, {}).empty());
  const std::uint32_t spike = at(2, 1000);
  soup.points[spike] = soup.points[spike] * 1.01;
  EXPECT_EQ(points_of(find_outliers(soup, {})), std::set<std::uint32_t>{spike});
}

TEST(Outliers, AreTheSameForAnyNumberOfThreadsAndScale) {
  const TriangleSoup ball = icosphere(5);
  TriangleSoup soup = with_noise(ball, 0.1, kSeed);
  add_impulses(soup, point_normals(ball), mean_edge_length(ball), 401, 2.5);
  const auto run = [](const TriangleSoup& s, int threads) {
    const ThreadLimit limit(threads);
    return find_outliers(s, estimate_noise(s));
  };
  const auto one = run(soup, 1), four = run(soup, 4), large = run(scaled(soup, 0x1p20), 4);
  ASSERT_EQ(one.size(), four.size());
  ASSERT_EQ(one.size(), large.size());
  for (std::size_t i = 0; i < one.size(); ++i) {
    EXPECT_EQ(one[i].fitted, four[i].fitted);
    EXPECT_EQ(one[i].fitted * 0x1p20, large[i].fitted);
    EXPECT_EQ(one[i].distance * 0x1p20, large[i].distance);
  }
}

TEST(Outliers, OfBrokenSoupsAreSafe) {
  EXPECT_TRUE(find_outliers({}, {}).empty());
  EXPECT_TRUE(find_outliers(unwelded(icosphere(3)), {}).empty());
  const auto line = mapped(icosphere(3), [](const Vec3& p) { return Vec3{p.x, 0, 0}; });
  for (const Outlier& o : find_outliers(line, estimate_noise(line))) EXPECT_TRUE(is_finite(o.fitted));
}

TEST(Fragments, AreSmallComponentsOnly) {
  const TriangleSoup ball = icosphere(4), crumb = moved(scaled(icosphere(0), 0.004), {1.5, 0, 0}), part = moved(scaled(icosphere(2), 0.1), {0, 1.5, 0});
  const TriangleSoup all = merged(merged(ball, crumb), part);
  const auto fragments = find_fragments(all);
  ASSERT_EQ(fragments.size(), crumb.facets.size());
  for (std::size_t i = 0; i < fragments.size(); ++i) EXPECT_EQ(fragments[i], ball.facets.size() + i);
  EXPECT_TRUE(find_fragments(ball).empty());
  EXPECT_TRUE(find_fragments(merged(crumb, crumb)).empty());
  EXPECT_TRUE(find_fragments({}).empty());
}

}  // namespace
}  // namespace burnish
