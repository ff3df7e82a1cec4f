#include "burnish/levelset/smooth/smoothing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstring>
#include <numbers>
#include <random>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/levelset/redistance.h"
#include "burnish/levelset/smooth/mean_curvature_flow.h"
#include "burnish/levelset/volume.h"
#include "support/analytic_level_set.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;
constexpr FlowMode kModes[] = {FlowMode::mcf, FlowMode::volume, FlowMode::filtered};

SmoothingOptions options_for(FlowMode mode, double length, bool keep_volume = false) {
  SmoothingOptions options;
  options.mode = mode;
  options.length = length;
  options.keep_volume = keep_volume;
  return options;
}

// The length for which mean-curvature flow takes this time.
double length_for(double time) { return std::sqrt(time / flow_time_for(FlowMode::mcf, 1)); }

double zone_for(FlowMode mode, double length) { return kFlowBand + room_for_smoothing(mode, length) + 1; }

Ball<float> ball_for(FlowMode mode, double radius, double length, const Vec3& offset = {0.31, 0.77, 0.13}) {
  Ball<float> ball = analytic_ball<float>(radius, offset, zone_for(mode, length));
  ball.set = stored_near_surface(ball.set, kFlowBand);
  return ball;
}

// Rms of the crossings' distances from the mean radius.
double roughness(const Ball<float>& ball) {
  const double mean = mean_radius(ball.set, ball.center);
  double sum = 0, count = 0;
  for (const Vec3& x : edge_crossings(ball.set)) sum += std::pow(norm(x - ball.center) - mean, 2), ++count;
  return std::sqrt(sum / count);
}

// White noise at the nodes, then distances again.
void add_noise(LevelSet& set, double sigma) {
  std::mt19937 random(7);
  std::normal_distribution<double> noise(0, sigma);
  for (float& phi : set.phi.values())
    if (std::abs(phi) < kFlowBand) phi = static_cast<float>(std::clamp(phi + noise(random), -kFlowBand, kFlowBand));
  redistance(set);
}

// As `worst_radius_error` of the explicit flow, at t = 0.05 R^2.
double worst_radius_error(double radius, int offsets) {
  std::mt19937 random(1);
  const double time = 0.05 * radius * radius, exact = std::sqrt(radius * radius - 4 * time);
  double worst = 0;
  for (int i = 0; i < offsets; ++i) {
    Ball<float> ball = analytic_ball<float>(radius, random_offset(random), kFlowBand + 1 + (radius - exact));
    ball.set = stored_near_surface(ball.set, kFlowBand);
    const SmoothingResult result = smooth(ball.set, options_for(FlowMode::mcf, length_for(time)));
    EXPECT_NEAR(result.time, time, 1e-9 * time);
    worst = std::max(worst, std::abs(mean_radius(ball.set, ball.center) - exact) / exact);
  }
  return worst;
}

TEST(Smooth, SpheresObeyTheLawOfMeanCurvatureFlow) {
  const double e32 = worst_radius_error(12.8, 10), e64 = worst_radius_error(25.6, 3), e128 = worst_radius_error(51.2, 1);
  RecordProperty("errors", std::to_string(e32) + " " + std::to_string(e64) + " " + std::to_string(e128));
  EXPECT_LE(e128, 1e-4);
  EXPECT_GE(std::log2(e32 / e64), 1.8) << e32 << " -> " << e64;
  EXPECT_GE(std::log2(e64 / e128), 1.8) << e64 << " -> " << e128;
}

// The same shape on lattices of different fineness: an ellipsoid whose axes are 1 : 1.3 : 1.6.
double worst_difference_to_explicit_steps(double radius) {
  const double time = 0.05 * radius * radius, zone = kFlowBand + 1.6 * radius * 0.15 + 2;
  int depth = 0;
  while (8 << depth < 2 * (1.6 * radius + zone) + 16) ++depth;
  const Vec3 center{(8 << depth) / 2.0 + 0.31, (8 << depth) / 2.0 + 0.77, (8 << depth) / 2.0 + 0.13};
  LevelSet stable = analytic_level_set<float>(depth, zone, [&](const Vec3& p) {
    const Vec3 q = p - center, scaled{q.x, q.y / 1.3, q.z / 1.6};
    return radius - norm(scaled);
  });
  stable = stored_near_surface(stable, kFlowBand);
  redistance(stable);
  LevelSet explicit_steps = stable;
  smooth(stable, options_for(FlowMode::mcf, length_for(time)));
  mean_curvature_flow(explicit_steps, time);
  double worst = 0;
  for (std::size_t i = 0; i < stable.phi.values().size(); ++i)
    if (std::abs(stable.phi.values()[i]) < 1) worst = std::max(worst, static_cast<double>(std::abs(stable.phi.values()[i] - explicit_steps.phi.values()[i])));
  return worst / radius;
}

TEST(Smooth, AgreesWithExplicitSteps) {
  const double coarse = worst_difference_to_explicit_steps(10), fine = worst_difference_to_explicit_steps(20);
  RecordProperty("differences", std::to_string(coarse) + " " + std::to_string(fine));
  EXPECT_LE(fine, 1e-3);
  EXPECT_GE(std::log2(coarse / fine), 1.5) << coarse << " -> " << fine;
}

TEST(Smooth, SpheresKeepTheirRadiusWithoutTheirVolumeBeingKept) {
  for (const FlowMode mode : {FlowMode::volume, FlowMode::filtered})
    for (const double radius : {12.8, 20.0}) {
      Ball<float> ball = ball_for(mode, radius, 16);
      const double before = mean_radius(ball.set, ball.center);
      smooth(ball.set, options_for(mode, 16));
      EXPECT_NEAR(mean_radius(ball.set, ball.center) / before, 1, radius < 20 ? 1e-3 : 1e-4) << name(mode) << ", radius " << radius;
    }
}

// What is left of a wave A cos(k x) on a plane, as in the tests of the explicit flow.
double left_of_wave(FlowMode mode, double wavelength) {
  const double k = 2 * kPi / wavelength, amplitude = 0.02 * wavelength;
  LevelSet set = stored_near_surface(
      analytic_level_set<float>(3, zone_for(mode, wavelength), [&](const Vec3& p) { return 32.3 + amplitude * std::cos(k * (p.x + 0.5)) - p.z; }), kFlowBand);
  smooth(set, options_for(mode, wavelength));
  double sum = 0, count = 0;
  for (const Vec3& x : edge_crossings(set)) {
    if (x.x != std::floor(x.x) || x.y != std::floor(x.y) || std::abs(x.x + 0.5 - 32) > wavelength || x.y < 16 || x.y >= 48) continue;
    sum += (x.z - 32.3) * std::cos(k * (x.x + 0.5));
    ++count;
  }
  return 2 * sum / count / amplitude;
}

TEST(Smooth, AttenuatesWavesOfTheLengthTenfold) {
  for (const FlowMode mode : kModes)
    for (const double wavelength : {8.0, 16.0}) EXPECT_NEAR(left_of_wave(mode, wavelength), 0.1, 0.02) << name(mode) << ", wavelength " << wavelength;
}

// Its diffusion dies down: what the header says of it.
TEST(Smooth, ExcessiveReinitialisationLeavesMore) { EXPECT_NEAR(left_of_wave(FlowMode::reinit, 8), 0.27, 0.05); }

TEST(Smooth, RemovesNoiseAndKeepsTheVolume) {
  for (const double radius : {20.0, 30.0}) {
    Ball<float> ball = ball_for(FlowMode::volume, radius, 16);
    add_noise(ball.set, 0.5);
    const double before = roughness(ball);
    const SmoothingResult result = smooth(ball.set, options_for(FlowMode::volume, 16, true));
    EXPECT_LE(roughness(ball), 0.1 * before) << "radius " << radius;
    EXPECT_NEAR(result.volume_after / result.volume_before, 1, 1e-6);
  }
}

TEST(Smooth, KeepsTheVolumeWhateverTheLength) {
  for (const FlowMode mode : kModes)
    for (const double length : {6.0, 28.0}) {
      Ball<float> ball = ball_for(mode, 16, length);
      const SmoothingResult result = smooth(ball.set, options_for(mode, length, true));
      EXPECT_NEAR(result.volume_after / result.volume_before, 1, 1e-6) << name(mode) << ", length " << length;
      EXPECT_EQ(result.volume_after, enclosed_volume(ball.set));
      EXPECT_NEAR(mean_radius(ball.set, ball.center), 16, 0.01);
    }
}

// Beside a ball of 12 cells a plate of 44 x 44 x 4, which vanishes: the ball is not blown up to make up for it.
TEST(Smooth, WhatIsLeftIsNotInflatedByWhatHasVanished) {
  const Vec3 ball{32.31, 32.77, 18.13}, plate{32, 32, 50.3};
  const auto distance = [&](const Vec3& p) {
    const Vec3 d = p - plate, out{std::abs(d.x) - 22, std::abs(d.y) - 22, std::abs(d.z) - 2};
    const Vec3 outside{std::max(out.x, 0.0), std::max(out.y, 0.0), std::max(out.z, 0.0)};
    return std::max(12 - norm(p - ball), -norm(outside) - std::min(0.0, std::max({out.x, out.y, out.z})));
  };
  const auto around_ball = [&](const LevelSet& set) {
    double sum = 0, count = 0;
    for (const Vec3& x : edge_crossings(set)) sum += norm(x - ball), ++count;
    return sum / count;
  };
  const double length = 10;
  LevelSet set = stored_near_surface(analytic_level_set<float>(3, zone_for(FlowMode::mcf, length), distance), kFlowBand), free = set;
  const SmoothingResult freely = smooth(free, options_for(FlowMode::mcf, length)), kept = smooth(set, options_for(FlowMode::mcf, length, true));
  const double radius = std::sqrt(144 - 4 * freely.time);
  ASSERT_NEAR(around_ball(free), radius, 0.05) << "the plate is still there";
  EXPECT_NEAR(around_ball(set), radius, 0.05);
  EXPECT_EQ(kept.volume_after, freely.volume_after);
  EXPECT_EQ(kept.volume_after, enclosed_volume(set));
  EXPECT_EQ(std::memcmp(set.phi.values().data(), free.phi.values().data(), set.phi.values().size() * sizeof(float)), 0);
}

TEST(Smooth, PlanesStayPlanes) {
  for (const FlowMode mode : kModes) {
    LevelSet set = analytic_level_set<float>(3, 6, [](const Vec3& p) { return 32.3 - p.z; });
    set = stored_near_surface(set, kFlowBand);
    smooth(set, options_for(mode, 12));
    for (const Vec3& x : edge_crossings(set)) ASSERT_NEAR(x.z, 32.3, 1e-5) << name(mode);
  }
}

TEST(Smooth, NothingMovesWhereMobilityIsZero) {
  Ball<float> ball = ball_for(FlowMode::mcf, 14, 10);
  add_noise(ball.set, 0.3);
  const std::vector<Vec3> before = edge_crossings(ball.set);
  Field<float> mobility = Field<float>::like(ball.set.phi, 0, 0);
  const double middle = ball.center.x;
  for (std::size_t leaf = 0; leaf < ball.set.octree().size(); ++leaf)
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
      mobility.block(leaf)[n] = static_cast<float>(std::clamp((lattice_node(ball.set.octree(), leaf, n % 8, n / 8 % 8, n / 64).x - middle) / 4, 0.0, 1.0));
  for (const bool keep_volume : {false, true}) {
    LevelSet set = ball.set;
    SmoothingOptions options = options_for(FlowMode::mcf, 10, keep_volume);
    options.mobility = &mobility;
    smooth(set, options);
    std::vector<Vec3> still, moved;
    for (const Vec3& x : before)
      if (x.x < middle - 1) still.push_back(x);
    for (const Vec3& x : edge_crossings(set))
      if (x.x < middle - 1) moved.push_back(x);
    ASSERT_EQ(still.size(), moved.size());
    for (std::size_t i = 0; i < still.size(); ++i) ASSERT_EQ(norm(still[i] - moved[i]), 0);
    EXPECT_NE(edge_crossings(set).size(), before.size()) << "nothing moved elsewhere";
  }
}

TEST(Smooth, DeviationIsBoundedAtEveryNode) {
  for (const FlowMode mode : kModes) {
    Ball<float> ball = ball_for(mode, 14, 12);
    add_noise(ball.set, 0.5);
    const Field<float> before = ball.set.phi;
    SmoothingOptions options = options_for(mode, 12, true);
    options.deviation = 0.3;
    smooth(ball.set, options);
    double worst = 0;
    for (std::size_t i = 0; i < before.values().size(); ++i)
      worst = std::max(worst, static_cast<double>(std::abs(ball.set.phi.values()[i] - before.values()[i])));
    EXPECT_LE(worst, 0.3 + 1e-6) << name(mode);
    EXPECT_GE(worst, 0.29) << name(mode);
  }
}

TEST(Smooth, EndsWhenTheSurfaceHasMovedFarEnough) {
  Ball<float> ball = ball_for(FlowMode::volume, 20, 20);
  add_noise(ball.set, 0.5);
  SmoothingOptions options = options_for(FlowMode::volume, 20);
  options.target_rms = 0.25;
  const SmoothingResult result = smooth(ball.set, options);
  EXPECT_TRUE(result.reached_target);
  EXPECT_NEAR(result.rms_moved, 0.25, 0.02);
  options.target_rms = 100;
  EXPECT_FALSE(smooth(ball.set, options).reached_target);
}

// A ball of 30 cells with a bump of radius 3 on its top, which rises 2 cells above it.
TEST(Smooth, OnlySmallRadiiOfCurvatureMove) {
  Ball<float> ball = ball_for(FlowMode::mcf, 30, 10);
  const Vec3 bump = ball.center + Vec3{0, 0, 29};
  for_each_near_node(ball.set, [&](const Vec3& p, float& phi) {
    phi = std::clamp(static_cast<float>(std::max(30 - norm(p - ball.center), 3 - norm(p - bump))), -5.0f, 5.0f);
  });
  const auto top = [&] {
    double highest = 0;
    for (const Vec3& x : edge_crossings(ball.set)) highest = std::max(highest, norm(x - ball.center));
    return highest - 30;
  };
  const double before = top();
  SmoothingOptions options = options_for(FlowMode::mcf, 12);
  options.curvature_radius = 12;
  smooth(ball.set, options);
  EXPECT_GE(before, 1.9);
  EXPECT_LE(top(), 0.25 * before);
  for (const Vec3& x : edge_crossings(ball.set))
    if (norm(x - bump) > 12) {
      ASSERT_NEAR(norm(x - ball.center), 30, 6e-3);
    }
  Ball<float> alone = ball_for(FlowMode::mcf, 30, 10);
  const double radius = mean_radius(alone.set, alone.center);
  smooth(alone.set, options);
  EXPECT_NEAR(mean_radius(alone.set, alone.center), radius, 1e-4);
}

TEST(Smooth, SameBitsForAnyNumberOfThreads) {
  for (const FlowMode mode : {FlowMode::mcf, FlowMode::volume, FlowMode::filtered, FlowMode::reinit}) {
    const auto run = [&](int threads) {
      const ThreadLimit limit(threads);
      Ball<float> ball = ball_for(mode, 12, 8);
      add_noise(ball.set, 0.4);
      SmoothingOptions options = options_for(mode, 8, true);
      options.target_rms = 0.3;
      smooth(ball.set, options);
      return ball.set.phi.values();
    };
    const LargeArray<float> one = run(1), two = run(2);
    EXPECT_EQ(std::memcmp(one.data(), two.data(), one.size() * sizeof(float)), 0) << name(mode);
  }
}

class Watched : public Progress {
 public:
  void update(double fraction) override { fractions.push_back(fraction); }
  bool cancelled() const override { return fractions.size() >= enough; }
  std::vector<double> fractions;
  std::size_t enough = 1000;
};

TEST(Smooth, ReportsItsStepsAndEndsWhenCancelled) {
  Ball<float> ball = ball_for(FlowMode::mcf, 12, 16);
  Watched all;
  const SmoothingResult result = smooth(ball.set, options_for(FlowMode::mcf, 16), all);
  ASSERT_EQ(all.fractions.size(), static_cast<std::size_t>(result.steps));
  EXPECT_TRUE(std::is_sorted(all.fractions.begin(), all.fractions.end()));
  EXPECT_EQ(all.fractions.back(), 1);
  Watched some;
  some.enough = 1;
  EXPECT_THROW(smooth(ball.set, options_for(FlowMode::mcf, 16), some), Error);
  EXPECT_EQ(some.fractions.size(), 1u);
}

// Its time is over after the first step.
class Hurried : public Watched {
 public:
  bool out_of_time() const override { return !fractions.empty(); }
};

TEST(Smooth, EndsWhenTheTimeIsOver) {
  for (const FlowMode mode : {FlowMode::mcf, FlowMode::volume, FlowMode::filtered, FlowMode::reinit}) {
    Ball<float> ball = ball_for(mode, 12, 16);
    Hurried progress;
    try {
      smooth(ball.set, options_for(mode, 16), progress);
      ADD_FAILURE() << name(mode) << " ran to its end";
    } catch (const Error& e) {
      EXPECT_EQ(e.code(), ErrorCode::time_limit) << name(mode);
    }
    EXPECT_EQ(progress.fractions.size(), 1u) << name(mode);
  }
}

// While a step is under way: redistancing asks, too.
class Late : public Progress {
 public:
  bool out_of_time() const override { return ++asked > 1; }
  mutable std::atomic<int> asked = 0;
};

TEST(Smooth, EndsWithinAStepWhenTheTimeIsOver) {
  for (const FlowMode mode : {FlowMode::mcf, FlowMode::volume, FlowMode::filtered, FlowMode::reinit}) {
    Ball<float> ball = ball_for(mode, 12, 4);
    Late progress;
    EXPECT_THROW(smooth(ball.set, options_for(mode, 4), progress), Error) << name(mode);
  }
  Ball<float> ball = ball_for(FlowMode::mcf, 12, 4);
  Late progress;
  EXPECT_THROW(mean_curvature_flow(ball.set, 1, progress), Error);
}

}  // namespace
}  // namespace burnish
