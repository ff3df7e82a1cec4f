#include "burnish/surface/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// Noise in all directions, as scanners have it.
TriangleSoup shaken(TriangleSoup soup, double sigma, std::mt19937& random) {
  std::normal_distribution<double> normal(0, sigma);
  for (Vec3& p : soup.points) {
    const double x = normal(random), y = normal(random), z = normal(random);
    p += {x, y, z};
  }
  return soup;
}

TriangleSoup any_shape(std::mt19937& random) {
  switch (random() % 4) {
    case 0: return icosphere(4);
    case 1: return torus(80, 32);
    case 2: return box({1, 1, 1}, 14, 14, 14);
    default: return box({0.5, 2, 1}, 8, 30, 16);
  }
}

Vec3 turned(const Vec3& p, double angle) {
  const Vec3 q{p.x * std::cos(angle) - p.y * std::sin(angle), p.x * std::sin(angle) + p.y * std::cos(angle), p.z};
  return {q.y, q.z * std::cos(angle) - q.x * std::sin(angle), q.z * std::sin(angle) + q.x * std::cos(angle)};
}

class DenoiseProperty : public testing::TestWithParam<unsigned> {};

TEST_P(DenoiseProperty, ErrorDropsVolumeAndFacetsStay) {
  std::mt19937 random(GetParam());
  const TriangleSoup clean = any_shape(random);
  const double edge = mean_edge_length(clean), sigma = edge * std::uniform_real_distribution<double>(0.1, 0.3)(random);
  const TriangleSoup rough = shaken(clean, sigma, random);
  const DenoiseResult result = denoise(rough, {.sigma = sigma});
  EXPECT_EQ(result.soup.facets, rough.facets);
  EXPECT_NEAR(signed_volume(result.soup) / signed_volume(rough), 1, 1e-8);
  double before = 0, after = 0;
  for (std::size_t f = 0; f < clean.facets.size(); ++f) {
    const Vec3 n = facet_normal_2a(clean, f) / norm(facet_normal_2a(clean, f)), a = facet_normal_2a(rough, f), b = facet_normal_2a(result.soup, f);
    before += std::acos(std::clamp(dot(a, n) / norm(a), -1.0, 1.0));
    after += std::acos(std::clamp(dot(b, n) / norm(b), -1.0, 1.0));
  }
  EXPECT_LT(after, 0.5 * before);
}

// A rigid motion of the input moves the result with it. Where a choice between patches or fits is close, rounding may decide it differently.
TEST_P(DenoiseProperty, RigidMotionsCommute) {
  std::mt19937 random(GetParam());
  const TriangleSoup clean = any_shape(random);
  const double edge = mean_edge_length(clean), sigma = 0.2 * edge, angle = std::uniform_real_distribution<double>(0.1, 6)(random);
  const TriangleSoup rough = shaken(clean, sigma, random);
  const auto move = [&](const Vec3& p) { return turned(p, angle) + Vec3{1, -2, 3}; };
  const TriangleSoup a = mapped(denoise(rough, {.sigma = sigma}).soup, move), b = denoise(mapped(rough, move), {.sigma = sigma}).soup;
  double sum = 0;
  std::size_t equal = 0;
  for (std::size_t p = 0; p < a.points.size(); ++p) {
    const double off = norm(a.points[p] - b.points[p]);
    sum += off * off;
    equal += off < 1e-3 * edge;
  }
  EXPECT_LT(std::sqrt(sum / static_cast<double>(a.points.size())), 1e-3 * edge);
  EXPECT_GT(equal, a.points.size() * 99 / 100);
}

INSTANTIATE_TEST_SUITE_P(Seeds, DenoiseProperty, testing::Range(1u, 9u));

}  // namespace
}  // namespace burnish
