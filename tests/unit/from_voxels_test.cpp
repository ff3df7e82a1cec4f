#include "burnish/levelset/from_voxels.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <numbers>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/topology.h"
#include "burnish/levelset/volume.h"
#include "burnish/surface/validate.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using namespace test;

struct Volume {
  std::array<std::uint32_t, 3> nodes{};
  Vec3 origin, spacing{1, 1, 1};
  std::vector<float> values;

  VoxelSamples samples() const { return {nodes, origin, spacing, values}; }
};

template <class Value>
Volume volume_of(std::array<std::uint32_t, 3> nodes, const Vec3& origin, const Vec3& spacing, Value&& value) {
  Volume v{nodes, origin, spacing, {}};
  for (std::uint32_t k = 0; k < nodes[2]; ++k)
    for (std::uint32_t j = 0; j < nodes[1]; ++j)
      for (std::uint32_t i = 0; i < nodes[0]; ++i) v.values.push_back(static_cast<float>(value(origin + Vec3{i * spacing.x, j * spacing.y, k * spacing.z})));
  return v;
}

// The share of a voxel of side 1 that a ball fills, from 8^3 points.
double share_of_ball(const Vec3& at, const Vec3& center, double radius) {
  const double d = norm(at - center) - radius;
  if (std::abs(d) > 0.9) return d < 0;
  int in = 0;
  for (int c = 0; c < 512; ++c)
    in += norm(at + Vec3{(c % 8 + 0.5) / 8 - 0.5, (c / 8 % 8 + 0.5) / 8 - 0.5, (c / 64 + 0.5) / 8 - 0.5} - center) < radius;
  return in / 512.0;
}

// Root of the mean square of the extracted points' distances from a sphere, in model units.
double rms_off(const LevelSet& set, const Vec3& center, double radius) {
  double sum = 0;
  const TriangleSoup soup = extract_surface(set, {.snap = false}).soup;
  for (const Vec3& p : soup.points) sum += std::pow(norm(set.frame.to_model(p) - center) - radius, 2);
  return std::sqrt(sum / static_cast<double>(soup.points.size()));
}

const Vec3 kCenter{0.31, -0.17, 0.23};

TEST(FromVoxels, ABallGivenByDistancesComesBackAsOne) {
  const Volume v = volume_of({53, 54, 55}, {-26, -27, -26.5}, {1, 1, 1}, [](const Vec3& p) { return 100 + 7 * (20 - norm(p - kCenter)); });
  const LevelSetFromVoxels result = level_set_from_voxels(v.samples(), 100, true);
  EXPECT_EQ(result.border_voxels, 0u);
  const double rms = rms_off(result.level_set, kCenter, 20), exact = 4.0 / 3 * std::numbers::pi * 8000;
  std::printf("rms %.2e cells, volume %.2e\n", rms, enclosed_volume(result.level_set) / exact - 1);
  EXPECT_LT(rms, 8e-3);  // of linear crossings
  EXPECT_NEAR(enclosed_volume(result.level_set) / exact, 1, 2e-3);
  // It is a distance, up to the band.
  const LevelSet& set = result.level_set;
  double worst = 0;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    for (int n = 0; set.phi.stores(leaf) && n < 512; ++n) {
      const LatticeNode at = lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64);
      const double distance = 20 - norm(set.frame.to_model({static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)}) - kCenter);
      worst = std::max(worst, std::abs(static_cast<double>(set.phi.block(leaf)[n]) - std::clamp(distance, -3.0, 3.0)));
    }
  std::printf("phi off by %.2e at most\n", worst);
  EXPECT_LT(worst, 1e-5);
}

TEST(FromVoxels, PartialVolumesAndSteps) {
  const double exact = 4.0 / 3 * std::numbers::pi * 8000;
  const Volume shares = volume_of({50, 50, 50}, {-25, -25, -25}, {1, 1, 1}, [](const Vec3& p) { return std::round(255 * share_of_ball(p, kCenter, 20)); });
  const LevelSet partial = level_set_from_voxels(shares.samples(), 127.5, true).level_set;
  const Volume steps = volume_of({50, 50, 50}, {-25, -25, -25}, {1, 1, 1}, [](const Vec3& p) { return norm(p - kCenter) < 20; });
  const LevelSet stairs = level_set_from_voxels(steps.samples(), 0.5, true).level_set;
  std::printf("partial: rms %.3f, volume %.2e; steps: rms %.3f, volume %.2e\n", rms_off(partial, kCenter, 20), enclosed_volume(partial) / exact - 1, rms_off(stairs, kCenter, 20),
              enclosed_volume(stairs) / exact - 1);
  EXPECT_LT(rms_off(partial, kCenter, 20), 0.04);
  EXPECT_NEAR(enclosed_volume(partial) / exact, 1, 3e-3);
  EXPECT_LT(rms_off(stairs, kCenter, 20), 0.22);
  EXPECT_NEAR(enclosed_volume(stairs) / exact, 1, 3e-3);
}

TEST(FromVoxels, EachNodeHasTheSideOfItsVoxel) {
  // Noise: the hardest of topologies. A voxel at the iso value is outside.
  std::uint64_t state = 12345;
  const Volume v = volume_of({20, 17, 13}, {1, 2, 3}, {0.5, 0.5, 0.5}, [&](const Vec3&) {
    state = state * 6364136223846793005u + 1442695040888963407u;
    return static_cast<double>(state >> 60);
  });
  for (const bool above : {true, false}) {
    const LevelSet set = level_set_from_voxels(v.samples(), 7, above).level_set;
    std::size_t wrong = 0, n = 0;
    for (std::uint32_t k = 0; k < 13; ++k)
      for (std::uint32_t j = 0; j < 17; ++j)
        for (std::uint32_t i = 0; i < 20; ++i, ++n) {
          const Vec3 at = set.frame.to_lattice(v.origin + Vec3{0.5 * i, 0.5 * j, 0.5 * k});
          const double phi = node_value(set.octree(), set.phi, {static_cast<std::int32_t>(std::lround(at.x)), static_cast<std::int32_t>(std::lround(at.y)), static_cast<std::int32_t>(std::lround(at.z))});
          wrong += (phi >= 0) != (above ? v.values[n] > 7 : v.values[n] < 7);
        }
    EXPECT_EQ(wrong, 0u);
    const TriangleSoup surface = extract_surface(set, {}).soup;
    const SurfaceTopology topology = surface_topology(surface);
    const LevelSetTopology field = level_set_topology(set);
    EXPECT_EQ(topology.components.size(), field.surface_components);
    EXPECT_EQ(topology.genus, field.genus);
  }
}

TEST(FromVoxels, ASolidThatRunsOffTheVolumeIsClosedHalfASpacingBeyond) {
  const Volume v = volume_of({10, 8, 6}, {0, 0, 0}, {2, 2, 2}, [](const Vec3&) { return 1000; });
  const LevelSetFromVoxels full = level_set_from_voxels(v.samples(), 300, true);
  EXPECT_EQ(full.border_voxels, 10u * 8 * 6 - 8 * 6 * 4);
  const TriangleSoup soup = extract_surface(full.level_set, {.snap = false}).soup;
  Vec3 low{1e9, 1e9, 1e9}, high = low * -1.0;
  for (const Vec3& p : soup.points) low = min(low, full.level_set.frame.to_model(p)), high = max(high, full.level_set.frame.to_model(p));
  for (int a = 0; a < 3; ++a) {
    // Corners make the interpolant of the start swing.
    EXPECT_NEAR(low[a], -1, 0.04);
    EXPECT_NEAR(high[a], 2.0 * v.nodes[static_cast<std::size_t>(a)] - 1, 0.04);
  }
  // Half a ball, cut off by the border.
  const Volume half = volume_of({53, 53, 27}, {-26, -26, 0}, {1, 1, 1}, [](const Vec3& p) { return 20 - norm(p); });
  EXPECT_NEAR(enclosed_volume(level_set_from_voxels(half.samples(), 0, true).level_set) / (2.0 / 3 * std::numbers::pi * 8000 + 0.5 * std::numbers::pi * 400), 1, 5e-3);
}

TEST(FromVoxels, SlicesFartherApartThanPixelsAreInterpolated) {
  const Volume v = volume_of({60, 60, 25}, {-30, -30, -30}, {1, 1, 2.5}, [](const Vec3& p) { return 20 - norm(p - kCenter); });
  const LevelSet set = level_set_from_voxels(v.samples(), 0, true).level_set;
  EXPECT_EQ(set.frame.cell, 1);
  std::printf("rms %.3f\n", rms_off(set, kCenter, 20));
  EXPECT_LT(rms_off(set, kCenter, 20), 0.05);  // linear between slices: 2.5^2 / 8 / 20 at most
}

TEST(FromVoxels, SameBitsForAnyNumberOfThreads) {
  const Volume v = volume_of({50, 50, 50}, {-25, -25, -25}, {1, 1, 1}, [](const Vec3& p) { return std::round(255 * share_of_ball(p, kCenter, 20)); });
  const LevelSet many = level_set_from_voxels(v.samples(), 100, true, {.band = 5, .room = 10}).level_set;
  const ThreadLimit one(1);
  const LevelSet alone = level_set_from_voxels(v.samples(), 100, true, {.band = 5, .room = 10}).level_set;
  EXPECT_EQ(many.phi.values(), alone.phi.values());
}

TEST(FromVoxels, OtsuPartsTwoClasses) {
  const Volume steps = volume_of({20, 20, 20}, {0, 0, 0}, {1, 1, 1}, [](const Vec3& p) { return p.x < 7; });
  EXPECT_NEAR(otsu_threshold(steps.samples(), value_range(steps.samples())), 0.5, 1e-3);
  EXPECT_TRUE(has_two_values(steps.samples(), value_range(steps.samples())));
  // Two classes of 100 +- 20 and 400 +- 50.
  const Volume two = volume_of({30, 30, 30}, {0, 0, 0}, {1, 1, 1}, [](const Vec3& p) { return p.x < 10 ? 100 + 20 * std::sin(p.y + 3 * p.z) : 400 + 50 * std::sin(3 * p.y + p.z); });
  EXPECT_FALSE(has_two_values(two.samples(), value_range(two.samples())));
  const double threshold = otsu_threshold(two.samples(), value_range(two.samples()));
  EXPECT_NEAR(threshold, 235, 2);  // the middle of what is empty: of 120 and 350
  const Volume flat = volume_of({3, 3, 3}, {0, 0, 0}, {1, 1, 1}, [](const Vec3&) { return 5; });
  EXPECT_EQ(otsu_threshold(flat.samples(), value_range(flat.samples())), 5);
}

// The lattice of the least spacing has a million times as many nodes as the volume.
TEST(FromVoxels, UnequalSpacingsStayWithinTheBudget) {
  for (const auto& [spacing, budget] : {std::pair(Vec3{1e-4, 1, 1}, std::uint64_t{1} << 30), std::pair(Vec3{0.05, 1, 1}, std::uint64_t{3} << 20)}) {
    const Volume v = volume_of({20, 20, 20}, {0, 0, 0}, spacing, [&](const Vec3& p) { return 7 - norm(Vec3{p.x / spacing.x, p.y, p.z} - Vec3{9.5, 9.5, 9.5}); });
    try {
      level_set_from_voxels(v.samples(), 0, true, {.memory_bytes = budget});
      ADD_FAILURE() << spacing.x;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::memory_limit);
      EXPECT_TRUE(contains(error.what(), {"spacings", "budget"}));
    }
  }
}

TEST(FromVoxels, ErrorsNameThePlace) {
  Volume v = volume_of({4, 3, 2}, {0, 0, 0}, {1, 1, 1}, [](const Vec3& p) { return p.x; });
  EXPECT_EQ(value_range(v.samples()).most, 3);
  EXPECT_THROW(level_set_from_voxels(v.samples(), 3, true), Error);
  v.values[4 * 3 + 4 * 2 + 1] = std::nanf("");
  v.values[4 * 3 + 4 * 2 + 3] = INFINITY;
  try {
    value_range(v.samples());
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unreadable_input);
    EXPECT_TRUE(contains(error.what(), {"voxel (1, 2, 1)", "nan"}));
  }
}

}  // namespace
}  // namespace burnish
