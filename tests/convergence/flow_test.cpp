#include "burnish/levelset/smooth/mean_curvature_flow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <numbers>
#include <optional>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/levelset/volume.h"
#include "support/analytic_level_set.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;

// The largest relative error of a ball's mean radius at t = 0.05 R^2, over random offsets against the lattice.
double worst_radius_error(double radius, int offsets) {
  std::mt19937 random(1);
  const double time = 0.05 * radius * radius, exact = std::sqrt(radius * radius - 4 * time);
  double worst = 0;
  for (int i = 0; i < offsets; ++i) {
    auto [set, center] = analytic_ball<double>(radius, random_offset(random), kFlowBand + (radius - exact));
    const FlowResult flow = mean_curvature_flow(set, time);
    EXPECT_DOUBLE_EQ(flow.time, time);
    EXPECT_GE(flow.steps, static_cast<int>(std::ceil(6 * time - 1e-9)));
    worst = std::max(worst, std::abs(mean_radius(set, center) - exact) / exact);
  }
  return worst;
}

TEST(MeanCurvatureFlow, BallsShrinkAsTheyShould) {
  const double coarse = worst_radius_error(8, 10), fine = worst_radius_error(16, 10);
  const double order = std::log2(coarse / fine);
  RecordProperty("error_8", std::to_string(coarse));
  RecordProperty("error_16", std::to_string(fine));
  RecordProperty("order", std::to_string(order));
  EXPECT_LE(fine, 0.003);
  EXPECT_GE(order, 1.5) << coarse << " -> " << fine;
}

// A wave A cos(k x) on a plane; lattice nodes from 0 to 63 and continued by their neighbours' values, so that the wave is
// symmetric about -1/2 and 63 1/2 and stays one under the flow.
TEST(MeanCurvatureFlow, AttenuatesWavesTenfoldInTheTimeForTheirLength) {
  for (const double wavelength : {8.0, 16.0}) {
    const double k = 2 * kPi / wavelength, amplitude = 0.02 * wavelength;
    const auto wave = [&](const Vec3& p) { return amplitude * std::cos(k * (p.x + 0.5)); };
    BasicLevelSet<double> set = analytic_level_set<double>(3, kFlowBand + 2, [&](const Vec3& p) { return 32.3 + wave(p) - p.z; });
    mean_curvature_flow(set, flow_time_for(FlowMode::mcf, wavelength));
    // Amplitude by projection on the middle two wavelengths, from crossings of vertical edges.
    double sum = 0, count = 0;
    for (const Vec3& x : edge_crossings(set)) {
      if (x.x != std::floor(x.x) || x.y != std::floor(x.y) || std::abs(x.x + 0.5 - 32) > wavelength || x.y < 16 || x.y >= 48) continue;
      sum += (x.z - 32.3) * std::cos(k * (x.x + 0.5));
      ++count;
    }
    const double left = 2 * sum / count / amplitude;
    RecordProperty("left_of_" + std::to_string(std::lround(wavelength)), std::to_string(left));
    EXPECT_NEAR(left, 0.1, 0.025) << "wavelength " << wavelength;
  }
}

TEST(MeanCurvatureFlow, TimeForALength) {
  for (const double length : {1.0, 3.0, 20.0}) {
    EXPECT_NEAR(std::exp(-std::pow(2 * kPi / length, 2) * flow_time_for(FlowMode::mcf, length)), 0.1, 1e-12);
    EXPECT_GE(room_for_smoothing(FlowMode::mcf, length), 2 * std::sqrt(flow_time_for(FlowMode::mcf, length)));
  }
}

TEST(MeanCurvatureFlow, PlanesAndZeroTimesDoNothing) {
  BasicLevelSet<double> set = analytic_level_set<double>(3, 5, [](const Vec3& p) { return 32.3 - p.z; });
  mean_curvature_flow(set, 3);
  for (const Vec3& x : edge_crossings(set)) EXPECT_NEAR(x.z, 32.3, 1e-6);
  const Field<double> before = set.phi;
  EXPECT_EQ(mean_curvature_flow(set, 0).steps, 0);
  EXPECT_EQ(set.phi.values(), before.values());
}

// Cells around a surface that have to be finest for smoothing.
double zone_for(double length) { return room_for_smoothing(FlowMode::mcf, length) + kFlowBand; }

SmoothingOptions smoothing(double length, std::optional<double> deviation = {}, bool keep_volume = true) {
  SmoothingOptions options;
  options.mode = FlowMode::mcf;
  options.length = length;
  options.deviation = deviation;
  options.keep_volume = keep_volume;
  return options;
}

// A ball with bumps of a wavelength of about `length` cells.
Ball<float> bumpy_ball(double radius, double length, double height, double band) {
  Ball<float> ball = analytic_ball<float>(radius, {0.31, 0.77, 0.13}, band);
  const double k = 2 * kPi / length;
  for_each_near_node(ball.set, [&](const Vec3& p, float& phi) {
    const Vec3 q = p - ball.center;
    const double bump = height * std::sin(k * q.x) * std::sin(k * q.y + 1) * std::sin(k * q.z + 2);
    phi = static_cast<float>(std::clamp(radius - norm(q) + bump, -band, band));
  });
  return ball;
}

TEST(SmoothByFlow, KeepsTheVolume) {
  for (const double length : {4.0, 10.0}) {
    SCOPED_TRACE(testing::Message() << "length " << length);
    Ball<float> ball = bumpy_ball(16, 6, 0.6, zone_for(length));
    const double before = enclosed_volume(ball.set);
    const SmoothingResult result = smooth(ball.set, smoothing(length));
    EXPECT_DOUBLE_EQ(result.volume_before, before);
    EXPECT_NEAR(enclosed_volume(ball.set) / before, 1, 1e-5);
    EXPECT_NEAR(result.volume_after / enclosed_volume(ball.set), 1, 1e-12);
    EXPECT_DOUBLE_EQ(result.time, flow_time_for(FlowMode::mcf, length));
  }
}

TEST(SmoothByFlow, WithoutKeepingVolumeABallShrinksByTheFlow) {
  const double length = 12, radius = 20;
  Ball<float> ball = analytic_ball<float>(radius, {0.2, 0.3, 0.4}, zone_for(length));
  const SmoothingResult result = smooth(ball.set, smoothing(length, {}, false));
  const double exact = std::pow(1 - 4 * flow_time_for(FlowMode::mcf, length) / (radius * radius), 1.5);
  EXPECT_NEAR(result.volume_after / result.volume_before, exact, 0.005);
}

TEST(SmoothByFlow, DeviationBoundsPhiAtEveryNode) {
  for (const bool keep_volume : {false, true}) {
    SCOPED_TRACE(testing::Message() << "keep volume " << keep_volume);
    Ball<float> ball = bumpy_ball(16, 8, 1.2, zone_for(12));
    const Field<float> before = ball.set.phi;
    const double bound = 0.3;
    smooth(ball.set, smoothing(12, bound, keep_volume));
    double worst = 0;
    for (std::size_t i = 0; i < before.values().size(); ++i)
      worst = std::max(worst, static_cast<double>(std::abs(ball.set.phi.values()[i] - before.values()[i])));
    EXPECT_LE(worst, bound + 1e-6);
    EXPECT_GE(worst, 0.9 * bound) << "the bound was never needed";
  }
}

TEST(SmoothByFlow, RemovesBumps) {
  Ball<float> ball = bumpy_ball(16, 6, 0.6, zone_for(8));
  const auto roughness = [&] {
    const double mean = mean_radius(ball.set, ball.center);
    double sum = 0, count = 0;
    for (const Vec3& x : edge_crossings(ball.set)) sum += std::pow(norm(x - ball.center) - mean, 2), ++count;
    return std::sqrt(sum / count);
  };
  const double before = roughness();
  smooth(ball.set, smoothing(8));
  EXPECT_LE(roughness(), 0.1 * before);
}

TEST(SmoothByFlow, SameBitsForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    Ball<float> ball = bumpy_ball(12, 6, 0.6, zone_for(6));
    smooth(ball.set, smoothing(6, 0.4));
    return ball.set.phi.values();
  };
  const LargeArray<float> one = run(1), four = run(4);
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(float)), 0);
}

TEST(EnclosedVolume, OfBallsIsSecondOrder) {
  const auto worst = [](double radius, int offsets) {
    std::mt19937 random(2);
    const double exact = 4.0 / 3 * kPi * radius * radius * radius;
    double error = 0;
    for (int i = 0; i < offsets; ++i)
      error = std::max(error, std::abs(enclosed_volume(analytic_ball<double>(radius, random_offset(random), 3).set) / exact - 1));
    return error;
  };
  const double e8 = worst(8, 10), e16 = worst(16, 10), e32 = worst(32, 4);
  RecordProperty("error_32", std::to_string(e32));
  RecordProperty("order", std::to_string(std::log2(e16 / e32)));
  EXPECT_GE(std::log2(e8 / e16), 1.9);
  EXPECT_GE(std::log2(e16 / e32), 1.9);
  EXPECT_LE(e32, 1e-3);
}

TEST(EnclosedVolume, OfAPlanesHalfSpaceIsExact) {
  const BasicLevelSet<double> set = analytic_level_set<double>(2, 3, [](const Vec3& p) { return 15.75 - p.z; });
  EXPECT_NEAR(enclosed_volume(set), 32.0 * 32 * 15.75, 1e-9 * 32 * 32 * 32);
}

TEST(PositiveFraction, HasTheSymmetriesOfATetrahedron) {
  EXPECT_EQ(positive_fraction(1, 2, 3, 4), 1);
  EXPECT_EQ(positive_fraction(-1, -2, -3, -4), 0);
  EXPECT_NEAR(positive_fraction(1, -1, -1, -1), 1.0 / 8, 1e-15);
  EXPECT_NEAR(positive_fraction(1, 1, -1, -1), 1.0 / 2, 1e-15);
  EXPECT_NEAR(positive_fraction(1, 1, 1, -1), 7.0 / 8, 1e-15);
  EXPECT_NEAR(positive_fraction(1, -2, -3, -4), 1.0 / (3 * 4 * 5), 1e-15);
  std::mt19937 random(3);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int i = 0; i < 2000; ++i) {
    std::array<double, 4> v{any(random), any(random), any(random), any(random)};
    const double f = positive_fraction(v[0], v[1], v[2], v[3]);
    EXPECT_NEAR(f + positive_fraction(-v[0], -v[1], -v[2], -v[3]), 1, 1e-13);
    EXPECT_NEAR(positive_fraction(5 * v[0], 5 * v[1], 5 * v[2], 5 * v[3]), f, 1e-13);
    std::shuffle(v.begin(), v.end(), random);
    EXPECT_NEAR(positive_fraction(v[0], v[1], v[2], v[3]), f, 1e-13);
  }
}

TEST(PositiveFraction, AgreesWithMonteCarlo) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(-1, 1);
  std::exponential_distribution<double> weight;
  for (int i = 0; i < 20; ++i) {
    const std::array<double, 4> v{any(random), any(random), any(random), any(random)};
    const double f = positive_fraction(v[0], v[1], v[2], v[3]);
    constexpr int n = 100'000;
    int inside = 0;
    for (int s = 0; s < n; ++s) {
      double sum = 0;
      for (const double x : v) sum += x * weight(random);  // barycentric weights up to a positive factor
      inside += sum >= 0;
    }
    EXPECT_NEAR(static_cast<double>(inside) / n, f, 5 * std::sqrt(f * (1 - f) / n) + 1e-4) << "tetrahedron " << i;
  }
}

}  // namespace
}  // namespace burnish
