#include "burnish/surface/noise.h"

#include <gtest/gtest.h>

#include <cmath>

#include "burnish/surface/outliers.h"
#include "burnish/surface/weld.h"
#include "support/noise.h"
#include "support/repetitions.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// A blob: a ball with random waves, longer than ten edges.
TriangleSoup random_blob(Random& random) {
  const Vec3 k = random.in_ball() * 6, shift = random.in_ball() * 3;
  const double height = random.uniform(0, 0.15);
  return mapped(icosphere(5), [&](const Vec3& p) { return p * (1 + height * std::sin(dot(k, p) + shift.x) * std::sin(3 * p.y + shift.y)); });
}

// A rotation by a random angle about a random axis.
TriangleSoup turned(const TriangleSoup& soup, Random& random) {
  const Vec3 axis = random.in_ball(), a = axis / norm(axis);
  const double angle = random.uniform(0, 6.28), c = std::cos(angle), s = std::sin(angle);
  return mapped(soup, [&](const Vec3& p) { return p * c + cross(a, p) * s + a * (dot(a, p) * (1 - c)); });
}

TEST(Noise, OfRandomBlobsIsWithinTenPercent) {
  for (std::uint64_t seed = 1; seed <= repetitions(8, 2); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const TriangleSoup blob = random_blob(random);
    const double edges = random.uniform(0.05, 0.7), sigma = edges * mean_edge_length(blob);
    const TriangleSoup noisy = with_noise(blob, edges, seed);
    const NoiseEstimate noise = estimate_noise(noisy);
    EXPECT_NEAR(noise.sigma, sigma, 0.1 * sigma) << edges << " edges";
    EXPECT_FALSE(noise.creased());
    EXPECT_FALSE(estimate_noise(blob).noisy());
    EXPECT_TRUE(find_outliers(blob, estimate_noise(blob)).empty());
    // Neither where the model stands nor how its points are numbered matters, but for which of them are looked at.
    EXPECT_NEAR(estimate_noise(turned(noisy, random)).sigma, noise.sigma, 1e-6 * sigma);
    EXPECT_NEAR(estimate_noise(weld(shuffled(unwelded(noisy), seed))).sigma, noise.sigma, 0.04 * sigma);
  }
}

TEST(Noise, IsEstimatedDespiteHolesFlipsAndSlivers) {
  for (std::uint64_t seed = 1; seed <= repetitions(4, 1); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    const double edges = random.uniform(0.1, 0.5);
    const TriangleSoup noisy = with_noise(icosphere(5), edges, seed);
    const double sigma = edges * mean_edge_length(icosphere(5));
    for (const TriangleSoup& damaged : {without_random_facets(noisy, 0.01, seed), with_random_flips(noisy, 0.01, seed), with_random_copies(noisy, 0.01, seed),
                                        with_slivers(noisy, 0.01, seed), with_round_hole(noisy, 0.05, seed)}) {
      const NoiseEstimate noise = estimate_noise(damaged);
      EXPECT_NEAR(noise.sigma, sigma, 0.12 * sigma);
      EXPECT_LT(noise.outlier_share, 0.002);
    }
  }
}

// Points anywhere, facets between any of them: nothing to find, and nothing to fall over.
TEST(Noise, OfRandomSoupsIsFinite) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Random random(seed);
    TriangleSoup soup;
    const std::size_t points = 3 + random.below(400), facets = random.below(1500);
    for (std::size_t p = 0; p < points; ++p) soup.points.push_back(seed % 3 == 0 ? Vec3{std::round(random.uniform(0, 3)), std::round(random.uniform(0, 3)), 0} : random.in_ball());
    const auto any = [&] { return static_cast<std::uint32_t>(random.below(points)); };
    for (std::size_t f = 0; f < facets; ++f) soup.facets.push_back({any(), any(), any()});
    const NoiseEstimate noise = estimate_noise(soup);
    for (const double value : {noise.sigma, noise.residual, noise.correlation, noise.evenness, noise.outlier_share, noise.crease_share, noise.crease_bending}) EXPECT_TRUE(std::isfinite(value));
    for (const Outlier& o : find_outliers(soup, noise)) EXPECT_TRUE(is_finite(o.fitted));
    for (const std::uint32_t f : find_fragments(soup)) EXPECT_LT(f, soup.facets.size());
  }
}

}  // namespace
}  // namespace burnish
