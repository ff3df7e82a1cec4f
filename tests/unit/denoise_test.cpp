#include "burnish/surface/denoise.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <random>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

std::vector<Vec3> unit_normals_of_points(const TriangleSoup& soup) {
  std::vector<Vec3> normals(soup.points.size());
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) normals[p] += facet_normal_2a(soup, f);
  for (Vec3& n : normals) n *= 1 / norm(n);
  return normals;
}

// White noise along the normals, `edges` mean edges strong.
TriangleSoup noisy(const TriangleSoup& clean, double edges, unsigned seed = 1) {
  TriangleSoup soup = clean;
  std::mt19937 random(seed);
  std::normal_distribution<double> normal(0, edges * mean_edge_length(clean));
  const std::vector<Vec3> along = unit_normals_of_points(clean);
  for (std::size_t p = 0; p < soup.points.size(); ++p) soup.points[p] += along[p] * normal(random);
  return soup;
}

// Mean angle between facets' normals, degrees.
double mean_angle(const TriangleSoup& a, const TriangleSoup& b) {
  double sum = 0;
  for (std::size_t f = 0; f < a.facets.size(); ++f) {
    const Vec3 m = facet_normal_2a(a, f), n = facet_normal_2a(b, f);
    sum += std::acos(std::clamp(dot(m, n) / (norm(m) * norm(n)), -1.0, 1.0));
  }
  return sum / static_cast<double>(a.facets.size()) * 180 / std::numbers::pi;
}

template <class Measure>
double rms(const std::vector<Vec3>& points, Measure&& measure) {
  double sum = 0;
  for (const Vec3& p : points) sum += measure(p) * measure(p);
  return std::sqrt(sum / static_cast<double>(points.size()));
}

TriangleSoup denoised(const TriangleSoup& soup, double edges) { return denoise(soup, {.sigma = edges * mean_edge_length(soup)}).soup; }

TEST(Denoise, SphereGetsItsNormalsAndItsRadiusBack) {
  const TriangleSoup clean = icosphere(5), rough = noisy(clean, 0.3), smooth = denoised(rough, 0.3);
  const double edge = mean_edge_length(clean);
  const auto off = [](const Vec3& p) { return norm(p) - 1; };
  EXPECT_GT(mean_angle(rough, clean), 20);
  EXPECT_LT(mean_angle(smooth, clean), 1.2);
  EXPECT_LT(rms(smooth.points, off), 0.05 * edge);   // a sixth of the noise
  double mean = 0;
  for (const Vec3& p : smooth.points) mean += norm(p);
  EXPECT_NEAR(mean / static_cast<double>(smooth.points.size()), 1, 0.02 * edge);
}

TEST(Denoise, ClosedSurfacesKeepTheirVolume) {
  for (const TriangleSoup& clean : {icosphere(4), torus(100, 40), box({1, 1, 1}, 20, 20, 20)}) {
    const TriangleSoup rough = noisy(clean, 0.3);
    EXPECT_NEAR(signed_volume(denoised(rough, 0.3)) / signed_volume(rough), 1, 1e-8);
  }
}

TEST(Denoise, TorusLosesNineTenthsOfTheError) {
  const TriangleSoup clean = torus(160, 64), rough = noisy(clean, 0.3), smooth = denoised(rough, 0.3);
  EXPECT_LT(mean_angle(smooth, clean), 0.15 * mean_angle(rough, clean));
  const auto off = [](const Vec3& p) { return std::hypot(std::hypot(p.x, p.y) - 1, p.z) - 0.4; };
  EXPECT_LT(rms(smooth.points, off), 0.25 * rms(rough.points, off));
}

// Faces come back flat, and points on the twelve edges come back to them: a crease is neither rounded nor moved.
TEST(Denoise, CubeKeepsItsCreases) {
  const int n = 24;
  const TriangleSoup clean = box({1, 1, 1}, n, n, n), rough = noisy(clean, 0.3), smooth = denoised(rough, 0.3);
  const double edge = mean_edge_length(clean);
  EXPECT_LT(mean_angle(smooth, clean), 2);
  double creases = 0, at_creases = 0;
  for (std::size_t p = 0; p < clean.points.size(); ++p) {
    double off = 0;
    int faces = 0;
    for (int axis = 0; axis < 3; ++axis)
      if (clean.points[p][axis] == 0 || clean.points[p][axis] == 1) off = std::max(off, std::abs(smooth.points[p][axis] - clean.points[p][axis])), ++faces;
    if (faces < 2) continue;
    creases += off * off;
    ++at_creases;
    EXPECT_LT(off, 0.5 * edge) << p;
  }
  EXPECT_LT(std::sqrt(creases / at_creases), 0.12 * edge);
}

TEST(Denoise, PlaneBecomesFlatAndItsRimStays) {
  const int n = 60;
  std::mt19937 random(3);
  std::normal_distribution<double> normal(0, 0.3 / n);
  const TriangleSoup rough = height_field(n, [&](int, int) { return normal(random); });
  const TriangleSoup smooth = denoise(rough, {.sigma = 0.3 / n}).soup;
  EXPECT_LT(rms(smooth.points, [](const Vec3& p) { return p.z; }), 0.06 / n);
  double inwards = 0;  // of the rim's points, on average
  for (std::size_t p = 0; p < rough.points.size(); ++p) {
    const Vec3 &from = rough.points[p], d = smooth.points[p] - from;
    EXPECT_LT(std::hypot(d.x, d.y), 0.5 / n) << p;
    inwards += (from.x == 0) * d.x - (from.x == 1) * d.x + (from.y == 0) * d.y - (from.y == 1) * d.y;
  }
  EXPECT_LT(std::abs(inwards) / (4 * n), 0.02 / n);
}

TEST(Denoise, ImpulsesAreNotSpreadOverTheirNeighbours) {
  const TriangleSoup clean = icosphere(5);
  const double edge = mean_edge_length(clean);
  TriangleSoup rough = noisy(clean, 0.1);
  std::mt19937 random(7);
  for (std::size_t p = 0; p < rough.points.size(); ++p)
    if (random() % 20 == 0) rough.points[p] *= 1 + 1.5 * edge;
  const TriangleSoup smooth = denoised(rough, 0.3);
  EXPECT_LT(mean_angle(smooth, clean), 3);
  // One in twenty lifts the mean by 0.075 edges, which the volume keeps; nothing else of the impulses is left.
  EXPECT_LT(rms(smooth.points, [&](const Vec3& p) { return norm(p) - 1 - 0.075 * edge; }), 0.1 * edge);
}

TEST(Denoise, SurfaceWithoutNoiseComesBackBitForBit) {
  for (const TriangleSoup& clean : {icosphere(4), torus(100, 40), box({1, 2, 3}, 12, 24, 36)}) {
    EXPECT_EQ(denoise(clean, {.sigma = 0}).soup.points, clean.points);
    EXPECT_EQ(denoise(clean).soup.points, clean.points);
  }
}

TEST(Denoise, NoiseIsEstimatedWhenNothingIsSaid) {
  const TriangleSoup clean = icosphere(5), rough = noisy(clean, 0.3);
  const DenoiseResult result = denoise(rough);
  EXPECT_NEAR(result.sigma, 0.3 * mean_edge_length(clean), 0.05 * mean_edge_length(clean));
  EXPECT_NEAR(result.rms_moved, 0.3 * mean_edge_length(clean), 0.05 * mean_edge_length(clean));
  EXPECT_LT(mean_angle(result.soup, clean), 1.2);
}

TEST(Denoise, PointsThatMayNotMoveKeepTheirBits) {
  const TriangleSoup rough = noisy(icosphere(4), 0.3);
  DenoiseOptions options{.sigma = 0.3 * mean_edge_length(rough), .mobility = std::vector<float>(rough.points.size(), 1)};
  for (std::size_t p = 0; p < rough.points.size(); ++p)
    if (rough.points[p].z > 0) options.mobility[p] = 0;
  const DenoiseResult result = denoise(rough, options);
  std::size_t moved = 0;
  for (std::size_t p = 0; p < rough.points.size(); ++p) {
    if (rough.points[p].z > 0) ASSERT_EQ(result.soup.points[p], rough.points[p]);
    else moved += result.soup.points[p] != rough.points[p];
  }
  EXPECT_GT(moved, rough.points.size() / 3);
}

// What is held back does not make the noise seem less: a tenth of the surface gets as smooth as all of it does.
TEST(Denoise, ASmallRegionGetsAsSmoothAsTheWhole) {
  const TriangleSoup clean = icosphere(5), rough = noisy(clean, 0.3);
  DenoiseOptions options{.mobility = std::vector<float>(rough.points.size(), 0)};
  for (std::size_t p = 0; p < rough.points.size(); ++p)
    if (clean.points[p].z > 0.8) options.mobility[p] = 1;
  const DenoiseResult whole = denoise(rough), part = denoise(rough, options);
  EXPECT_NEAR(part.sigma, whole.sigma, 0.1 * whole.sigma);
  double sum_of_whole = 0, sum_of_part = 0;
  for (std::size_t f = 0; f < clean.facets.size(); ++f) {
    if ((clean.corner(f, 0).z + clean.corner(f, 1).z + clean.corner(f, 2).z) / 3 < 0.9) continue;
    const auto angle = [&](const TriangleSoup& soup) {
      const Vec3 n = facet_normal_2a(soup, f), truth = facet_normal_2a(clean, f);
      return std::acos(std::clamp(dot(n, truth) / (norm(n) * norm(truth)), -1.0, 1.0));
    };
    sum_of_whole += angle(whole.soup);
    sum_of_part += angle(part.soup);
  }
  EXPECT_LT(sum_of_part, 1.3 * sum_of_whole);
}

TEST(Denoise, DeviationIsABound) {
  const TriangleSoup rough = noisy(icosphere(4), 0.3);
  const double limit = 0.1 * mean_edge_length(rough);
  const DenoiseResult result = denoise(rough, {.sigma = 3 * limit, .deviation = limit});
  double largest = 0;
  for (std::size_t p = 0; p < rough.points.size(); ++p) largest = std::max(largest, norm(result.soup.points[p] - rough.points[p]));
  EXPECT_LE(largest, limit);
  EXPECT_GT(largest, 0.99 * limit);
  EXPECT_EQ(largest, result.max_moved);
}

// Ripples along x, `edges` grid steps long, a quarter of a step high: what is left of their height away from the rim.
double ripples_left(double edges, double length_in_edges) {
  const int n = 90;
  const auto wave = [&](double i) { return 0.25 / n * std::sin(2 * std::numbers::pi * i / edges); };
  const TriangleSoup rippled = height_field(n, [&](int i, int) { return wave(i); });
  const TriangleSoup smooth = denoise(rippled, {.sigma = 0, .length = length_in_edges / n}).soup;
  double before = 0, after = 0;
  for (std::size_t p = 0; p < rippled.points.size(); ++p) {
    const Vec3& at = rippled.points[p];
    if (std::max(std::abs(at.x - 0.5), std::abs(at.y - 0.5)) > 0.3) continue;
    before += at.z * at.z;
    after += smooth.points[p].z * smooth.points[p].z;
  }
  return std::sqrt(after / before);
}

TEST(Denoise, WavesShorterThanTheLengthVanishAndLongOnesStay) {
  EXPECT_LT(ripples_left(6, 6), 0.15);
  EXPECT_LT(ripples_left(4, 6), 0.15);
  EXPECT_GT(ripples_left(30, 6), 0.8);
}

// A roof with 60 degrees between its sides in strong noise: a crease if that is more than the angle asked for, and blurred if it is less.
TEST(Denoise, CreaseAngleDecidesWhatStaysSharp) {
  const int n = 60;
  const double slope = std::tan(30 * std::numbers::pi / 180);
  std::mt19937 random(11);
  std::normal_distribution<double> normal(0, 0.3 / n);
  const auto roof = [&](int i, int) { return -slope * std::abs(i - n / 2) / n; };
  const TriangleSoup clean = height_field(n, roof), rough = height_field(n, [&](int i, int j) { return roof(i, j) + normal(random); });
  const auto angle = [&](double crease) { return mean_angle(denoise(rough, {.sigma = 0.3 / n, .crease_angle = crease}).soup, clean); };
  EXPECT_LT(angle(40), 2);
  EXPECT_LT(angle(40), 0.7 * angle(120));
}

TEST(Denoise, SameBitsForAnyNumberOfThreadsAndPowersOfTwo) {
  const TriangleSoup rough = noisy(torus(120, 50), 0.3);
  const double sigma = 0.3 * mean_edge_length(rough);
  std::vector<Vec3> serial;
  {
    const ThreadLimit limit(1);
    serial = denoise(rough, {.sigma = sigma}).soup.points;
  }
  const ThreadLimit two(2);
  EXPECT_EQ(denoise(rough, {.sigma = sigma}).soup.points, serial);
  for (const double by : {0x1p40, 0x1p-60}) {
    const TriangleSoup result = denoise(scaled(rough, by), {.sigma = sigma * by}).soup;
    EXPECT_EQ(scaled(result, 1 / by).points, serial);
  }
}

TEST(Denoise, SoupsOfAllKindsAreTaken) {
  EXPECT_TRUE(denoise(TriangleSoup{}).soup.facets.empty());
  TriangleSoup soup = noisy(icosphere(3), 0.3);
  soup.points.push_back({9, 9, 9});                                  // used by no facet
  soup.facets.push_back({0, 0, 1});                                  // repeats a point
  soup.facets.push_back(soup.facets[5]);                             // twice
  soup.facets.push_back({1, 2, 600});                                // on edges of others
  soup.points[7] = soup.points[8];                                   // facets without area
  const DenoiseResult result = denoise(soup, {.sigma = 0.05, .length = 0.1});
  EXPECT_EQ(result.soup.facets, soup.facets);
  EXPECT_EQ(result.soup.points.back(), (Vec3{9, 9, 9}));
  EXPECT_TRUE(std::all_of(result.soup.points.begin(), result.soup.points.end(), is_finite));
}

struct Stop : Progress {
  bool cancelled() const override { return true; }
};

TEST(Denoise, CanBeInterrupted) {
  Stop stop;
  EXPECT_THROW(denoise(noisy(icosphere(4), 0.3), {.sigma = 0.01}, stop), Error);
}

}  // namespace
}  // namespace burnish
