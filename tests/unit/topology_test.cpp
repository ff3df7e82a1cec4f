// The zero surface's topology by signs alone, against shapes known by hand and against the surface that is extracted.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <string>

#include "burnish/core/parallel.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/topology.h"
#include "burnish/surface/validate.h"
#include "burnish/surface/weld.h"
#include "support/analytic_shapes.h"
#include "support/level_sets.h"
#include "support/repetitions.h"

namespace burnish {
namespace {

using namespace test;

template <class T>
LevelSetTopology expect_same_as_extracted(const BasicLevelSet<T>& set) {
  const LevelSetTopology signs = level_set_topology(set);
  for (const bool snap : {false, true}) {
    const SurfaceTopology surface = surface_topology(weld(extract_surface(set, {.snap = snap}).soup));
    EXPECT_EQ(surface.components.size(), signs.surface_components) << "snap " << snap;
    EXPECT_EQ(surface.euler_characteristic, signs.euler_characteristic) << "snap " << snap;
    EXPECT_EQ(surface.genus, signs.genus) << "snap " << snap;
  }
  return signs;
}

const Vec3 kMiddle{32.37, 31.41, 32.29};

// Tetrahedra, and octrees with level jumps through the surface.
template <class Value>
LevelSetTopology topology_of(Value&& value) {
  const auto of = [&](const LatticeNode& n) { return value(to_vec(n) - kMiddle); };
  std::vector<std::uint64_t> some;
  for (std::uint64_t m = 0; m < 512; m += 37) some.push_back(m);
  const LevelSetTopology uniform = expect_same_as_extracted(level_set_of<double>(Octree::build(3, all_blocks(3)), of));
  const LevelSetTopology graded = expect_same_as_extracted(level_set_of<float>(Octree::build(3, some), of));
  EXPECT_EQ(uniform.genus, graded.genus);
  EXPECT_EQ(uniform.surface_components, graded.surface_components);
  EXPECT_EQ(uniform.inside_components, graded.inside_components);
  return uniform;
}

double torus_distance(const Vec3& p, double ring, double tube) { return tube - std::hypot(std::hypot(p.x, p.y) - ring, p.z); }

TEST(LevelSetTopology, Sphere) {
  const LevelSetTopology t = topology_of([](const Vec3& p) { return 20 - norm(p); });
  EXPECT_EQ(t.inside_components, 1u);
  EXPECT_EQ(t.outside_components, 1u);
  EXPECT_EQ(t.surface_components, 1u);
  EXPECT_EQ(t.genus, 0);
  EXPECT_EQ(t.euler_characteristic, 2);
}

TEST(LevelSetTopology, TorusAndDoubleTorus) {
  EXPECT_EQ(topology_of([](const Vec3& p) { return torus_distance(p, 16, 7); }).genus, 1);
  const LevelSetTopology t = topology_of([](const Vec3& p) {
    return std::max(torus_distance(p - Vec3{12, 0, 0}, 10, 5), torus_distance(p + Vec3{12, 0, 0}, 10, 5));
  });
  EXPECT_EQ(t.genus, 2);
  EXPECT_EQ(t.surface_components, 1u);
}

TEST(LevelSetTopology, KnotIsATorus) {
  const auto knot = unit_trefoil();
  const LevelSetTopology t = topology_of([&](const Vec3& p) { return knot->distance(p / 3.2) * 3.2; });
  EXPECT_EQ(t.genus, 1);
  EXPECT_EQ(t.surface_components, 1u);
}

TEST(LevelSetTopology, HollowAndNestedSpheres) {
  const LevelSetTopology hollow = topology_of([](const Vec3& p) { return std::min(22 - norm(p), norm(p) - 12); });
  EXPECT_EQ(hollow.inside_components, 1u);
  EXPECT_EQ(hollow.cavities(), 1u);
  EXPECT_EQ(hollow.surface_components, 2u);
  EXPECT_EQ(hollow.genus, 0);
  const LevelSetTopology nested =
      topology_of([](const Vec3& p) { return std::max(std::min(24 - norm(p), norm(p) - 17), 9 - norm(p)); });
  EXPECT_EQ(nested.inside_components, 2u);
  EXPECT_EQ(nested.outside_components, 2u);
  EXPECT_EQ(nested.surface_components, 3u);
  EXPECT_EQ(nested.euler_characteristic, 6);
}

TEST(LevelSetTopology, TwentyOneSpheres) {
  const LevelSetTopology t = topology_of([](const Vec3& p) {
    double best = -100;
    for (int s = 0; s < 21; ++s) {
      const Vec3 c{20.0 * (s % 3 - 1), 20.0 * (s / 3 % 3 - 1), 20.0 * (s / 9 - 1)};
      best = std::max(best, 6.5 - norm(p - c));
    }
    return best;
  });
  EXPECT_EQ(t.surface_components, 21u);
  EXPECT_EQ(t.euler_characteristic, 42);
  EXPECT_EQ(t.genus, 0);
}

TEST(LevelSetTopology, NothingHasNoSurface) {
  for (const double value : {-1.0, 1.0}) {
    const LevelSetTopology t = level_set_topology(level_set_of<float>(Octree(), [&](const LatticeNode&) { return value; }));
    EXPECT_EQ(t.surface_components, 0u);
    EXPECT_EQ(t.euler_characteristic, 0);
    EXPECT_EQ(t.genus, 0);
    EXPECT_EQ(t.inside_components + t.outside_components, 1u);
  }
}

Octree random_octree(std::mt19937_64& random, int depth, std::size_t blocks) {
  std::vector<std::uint64_t> finest;
  for (std::size_t i = 0; i < blocks; ++i) finest.push_back(random() % (std::uint64_t{1} << (3 * depth)));
  return Octree::build(depth, finest);
}

// Noise: thousands of components, handles and cavities.
TEST(LevelSetTopology, RandomSignsOnAnyOctree) {
  for (std::uint64_t seed = 1; seed <= repetitions(30, 12); ++seed) {
    std::mt19937_64 random(seed);
    const int depth = seed % 3 ? 2 : 3;
    Octree tree = seed % 4 == 0 ? Octree::build(1, all_blocks(1)) : random_octree(random, depth, 1 + random() % 8);
    const std::uint64_t inside = std::array{1, 3, 10, 30, 50, 80}[seed % 6];
    const auto noise = [&](const LatticeNode&) { return (random() % 100 < inside ? 1 : -1) * (0.1 + 0.01 * static_cast<double>(random() % 90)); };
    SCOPED_TRACE(::testing::Message() << "seed " << seed);
    expect_same_as_extracted(closed_at_walls(level_set_of<double>(std::move(tree), noise)));
  }
}

TEST(LevelSetTopology, SameForAnyNumberOfThreads) {
  std::mt19937_64 random(5);
  const auto set = closed_at_walls(level_set_of<float>(random_octree(random, 3, 9), [&](const LatticeNode& n) {
    return std::sin(0.7 * n.x) + std::sin(0.9 * n.y) + std::sin(0.8 * n.z) - 0.1;
  }));
  const auto with_threads = [&](int threads) {
    const ThreadLimit limit(threads);
    return level_set_topology(set);
  };
  const LevelSetTopology one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.inside_components, four.inside_components);
  EXPECT_EQ(one.outside_components, four.outside_components);
  EXPECT_EQ(one.euler_characteristic, four.euler_characteristic);
}

}  // namespace
}  // namespace burnish
