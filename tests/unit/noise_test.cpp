#include "burnish/surface/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"
#include "support/noise.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr std::uint64_t kSeed = 20;

// A ball with bumps of about a third of its radius across.
TriangleSoup bumpy_sphere(int level) {
  return mapped(icosphere(level), [](const Vec3& p) { return p * (1 + 0.03 * std::sin(9 * p.x) * std::sin(8 * p.y + 1) * std::sin(10 * p.z)); });
}

struct Shape {
  const char* name;
  TriangleSoup soup;
};

std::vector<Shape> shapes() {
  std::vector<Shape> all;
  all.push_back({"ball", icosphere(5)});
  all.push_back({"bumpy ball", bumpy_sphere(5)});
  all.push_back({"torus", torus(160, 64)});
  all.push_back({"box", box({1, 0.7, 0.5}, 40, 28, 20)});
  return all;
}

TEST(Noise, SigmaIsThatOfTheNoiseWithinTenPercent) {
  for (const Shape& shape : shapes())
    for (const double edges : {0.05, 0.1, 0.2, 0.3, 0.5, 0.7}) {
      SCOPED_TRACE(testing::Message() << shape.name << " noise " << edges << " seed " << kSeed);
      const NoiseEstimate noise = estimate_noise(with_noise(shape.soup, edges, kSeed));
      EXPECT_NEAR(noise.sigma, edges * mean_edge_length(shape.soup), 0.1 * edges * mean_edge_length(shape.soup));
      EXPECT_TRUE(noise.noisy());
      EXPECT_GE(noise.evenness, 0.62);
      EXPECT_LT(noise.outlier_share, 1e-3);
    }
}

TEST(Noise, OfACleanSurfaceIsNone) {
  for (const Shape& shape : shapes()) {
    SCOPED_TRACE(shape.name);
    const NoiseEstimate noise = estimate_noise(shape.soup);
    EXPECT_LT(noise.sigma, 0.005 * noise.mean_edge);
    EXPECT_EQ(noise.outlier_share, 0);
    EXPECT_FALSE(noise.noisy());
    EXPECT_TRUE(noise.has_neighborhoods());
  }
}

// A prism's walls are needles between creases: no neighbourhood is smooth, and none is noisy.
TEST(Noise, OfACoarselyFacetedPartIsExactlyZero) {
  TriangleSoup gears;
  for (int i = 0; i < 10; ++i) gears = merged(std::move(gears), moved(torus(24, 6), {3.0 * i, 0, 0}));
  EXPECT_EQ(estimate_noise(gears).sigma, 0);
  EXPECT_EQ(estimate_noise(box({20, 10, 5}, 12, 2, 1)).sigma, 0);
  const NoiseEstimate cube_noise = estimate_noise(cube());
  EXPECT_EQ(cube_noise.sigma, 0);
  EXPECT_FALSE(cube_noise.has_neighborhoods());
}

// Ripples with a wavelength of five edges, as deep as noise: the same at every point, but not random.
TEST(Noise, DetailIsNone) {
  const TriangleSoup ball = icosphere(5);
  const double edge = mean_edge_length(ball), wave = 2 * std::numbers::pi / (5 * edge);
  const auto rippled = mapped(ball, [&](const Vec3& p) { return p * (1 + 0.2 * edge * std::sin(wave * p.x) * std::sin(wave * p.y + 1) * std::sin(wave * p.z)); });
  const NoiseEstimate noise = estimate_noise(rippled);
  EXPECT_FALSE(noise.noisy());
  EXPECT_GT(noise.residual, 0.005 * edge);
}

TEST(Noise, OfNoiseIsUncorrelatedAndOfShapeIsNot) {
  EXPECT_NEAR(estimate_noise(with_noise(icosphere(5), 0.2, kSeed)).correlation, 0, 0.04);
  EXPECT_GT(estimate_noise(bumpy_sphere(4)).correlation, 0.1);
}

TEST(Noise, CreasesStandOutOfIt) {
  const TriangleSoup part = box({1, 0.7, 0.5}, 40, 28, 20);
  // 12 edges of the box: 4 (40 + 28 + 20) of the 3/2 facets' sides.
  const double share = 4.0 * (40 + 28 + 20) / (1.5 * static_cast<double>(part.facets.size()));
  EXPECT_DOUBLE_EQ(estimate_noise(part).crease_share, share);
  EXPECT_NEAR(estimate_noise(part).crease_bending, 1, 1e-3);
  for (const double edges : {0.1, 0.3, 0.5}) {
    SCOPED_TRACE(testing::Message() << "noise " << edges << " seed " << kSeed);
    const NoiseEstimate noise = estimate_noise(with_noise(part, edges, kSeed));
    EXPECT_NEAR(noise.crease_share, share, 0.4 * share);
    EXPECT_TRUE(noise.creased());
    EXPECT_FALSE(estimate_noise(with_noise(bumpy_sphere(5), edges, kSeed)).creased());
  }
  EXPECT_FALSE(estimate_noise(bumpy_sphere(5)).creased());
  EXPECT_EQ(estimate_noise(icosphere(5)).crease_share, 0);
}

void expect_scaled(const NoiseEstimate& a, const NoiseEstimate& b, double by) {
  EXPECT_EQ(a.sigma * by, b.sigma);
  EXPECT_EQ(a.residual * by, b.residual);
  EXPECT_EQ(a.mean_edge * by, b.mean_edge);
  EXPECT_EQ(a.correlation, b.correlation);
  EXPECT_EQ(a.evenness, b.evenness);
  EXPECT_EQ(a.outlier_share, b.outlier_share);
  EXPECT_EQ(a.crease_share, b.crease_share);
  EXPECT_EQ(a.crease_bending, b.crease_bending);
  EXPECT_EQ(a.fits, b.fits);
}

TEST(Noise, ScalesWithTheModelBitForBit) {
  const TriangleSoup soup = with_noise(torus(80, 32), 0.2, kSeed);
  for (const double by : {0x1p-30, 0x1p-3, 0x1p40}) expect_scaled(estimate_noise(soup), estimate_noise(scaled(soup, by)), by);
}

TEST(Noise, HasTheSameBitsForAnyNumberOfThreads) {
  const TriangleSoup soup = with_noise(bumpy_sphere(5), 0.2, kSeed);
  const auto with = [&](int threads) {
    const ThreadLimit limit(threads);
    return estimate_noise(soup);
  };
  expect_scaled(with(1), with(4), 1);
}

bool is_finite(const NoiseEstimate& n) {
  return std::isfinite(n.sigma) && std::isfinite(n.residual) && std::isfinite(n.correlation) && std::isfinite(n.evenness) && std::isfinite(n.crease_bending);
}

TEST(Noise, OfOpenNonManifoldAndDegeneratePlacesIsLeftOut) {
  TriangleSoup soup = with_noise(height_field(60, [](int, int) { return 0.0; }), 0.2, kSeed);
  const double edge = mean_edge_length(soup), before = estimate_noise(soup).sigma;
  EXPECT_NEAR(before, 0.2 * mean_edge_length(height_field(60, [](int, int) { return 0.0; })), 0.02 * edge);
  const auto n = static_cast<std::uint32_t>(soup.points.size());
  soup.points.push_back({0.5, 0.5, 0.1});
  soup.facets.push_back({0, 0, 1});        // repeats a point
  soup.facets.push_back({100, 101, n});    // a fin
  soup.facets.push_back({300, 301, 302});  // on a line, but for the noise
  soup.facets.push_back({7, 8, 7});
  const NoiseEstimate noise = estimate_noise(soup);
  EXPECT_TRUE(is_finite(noise));
  EXPECT_NEAR(noise.sigma, before, 0.02 * before);
}

TEST(Noise, OfASoupWithoutSharedPointsIsNotToBeHad) {
  const NoiseEstimate noise = estimate_noise(unwelded(with_noise(icosphere(4), 0.2, kSeed)));
  EXPECT_EQ(noise.sigma, 0);
  EXPECT_FALSE(noise.has_neighborhoods());
  const NoiseEstimate nothing = estimate_noise({});
  EXPECT_EQ(nothing.sigma, 0);
  EXPECT_FALSE(nothing.has_neighborhoods());
  EXPECT_TRUE(is_finite(nothing));
}

TEST(Noise, OfPointsInOnePlaceOrOnOneLineIsZero) {
  const TriangleSoup ball = icosphere(3);
  for (const auto& flat : {mapped(ball, [](const Vec3&) { return Vec3{1, 2, 3}; }), mapped(ball, [](const Vec3& p) { return Vec3{p.x, 0, 0}; })}) {
    const NoiseEstimate noise = estimate_noise(flat);
    EXPECT_EQ(noise.sigma, 0);
    EXPECT_TRUE(is_finite(noise));
  }
}

}  // namespace
}  // namespace burnish
