#include "burnish/levelset/verify.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <vector>

#include "burnish/core/parallel.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

struct Built {
  TriangleSoup lattice_soup;
  LevelSetFromTriangles field;

  DistanceCheck check(std::size_t nodes, std::uint64_t seed = 1) const {
    const double diagonal = bounding_box(lattice_soup).diagonal();
    return check_distances(lattice_soup, field.roles, field.level_set, {.nodes = nodes, .diagonal = diagonal, .seed = seed});
  }
};

Built build(const TriangleSoup& soup, double cell, double band, bool far_field = true) {
  const GridFrame frame = make_frame(bounding_box(soup), cell, band + 9);
  return {to_lattice(soup, frame), level_set_from_triangles(soup, frame, {.band = band, .room = 0, .far_field = far_field})};
}

TEST(CheckDistances, OfAClosedSurfaceAreExact) {
  for (const bool far_field : {true, false}) {
    const DistanceCheck check = build(icosphere(3), 0.03, 4, far_field).check(2000);
    EXPECT_TRUE(check.passed());
    EXPECT_EQ(check.total(), 2000u);
    for (const std::size_t nodes : check.nodes) EXPECT_EQ(nodes, 500u);
    EXPECT_LT(check.stored_nodes, check.total()) << "no node at the band's edge lies beyond it";
    EXPECT_LT(check.kernel.max, 1e-12);
    EXPECT_LE(check.kernel.rms, check.kernel.max);
    EXPECT_GT(check.stored.max, 0);
    EXPECT_LT(check.stored.max, 4 * 0x1p-24 + 1e-12);
    EXPECT_LE(check.stored.worst_share, 1);
  }
}

// The band of a leaf of level l is 2^l times as wide.
TEST(CheckDistances, OfBlocksOfSeveralLevels) {
  const TriangleSoup ball = icosphere(5);
  const GridFrame frame = make_frame(bounding_box(ball), 0.01, 40);
  LevelSetOptions options{.band = 3, .room = 0, .far_field = true};
  options.adaptivity.tolerance = 0.05;
  options.adaptivity.limits.coarsest_level = 3;
  Built built{to_lattice(ball, frame), level_set_from_triangles(ball, frame, options)};
  LevelSet& set = built.field.level_set;
  std::array<std::size_t, 4> near{};
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    if (set.grid.near_surface(leaf)) ++near.at(static_cast<std::size_t>(set.octree().level(leaf)));
  EXPECT_GE(std::ranges::count_if(near, [](std::size_t n) { return n > 0; }), 2) << "the test takes several levels";
  const DistanceCheck check = built.check(2000);
  EXPECT_TRUE(check.passed());
  EXPECT_EQ(check.total(), 2000u);
  EXPECT_LT(check.stored_nodes, check.total());
  EXPECT_GT(check.stored.max, 0);
  // What is off in coarse leaves alone is found as well.
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    if (set.octree().level(leaf) > 0 && set.grid.near_surface(leaf))
      for (std::size_t n = 0; n < kBlockNodes; ++n) set.phi.block(leaf)[n] *= 1 + 0x1p-21f;
  EXPECT_GT(built.check(2000).stored.exceeded, 10u);
}

// A facet inside the solid is nearer to many nodes than its surface, and no part of it.
TEST(CheckDistances, LeaveOutFacetsInside) {
  const Built built = build(merged(icosphere(2), moved(icosphere(2), {0.7, 0.1, 0.05})), 0.03, 3);
  ASSERT_GT(built.field.interior_facets, 50u);
  EXPECT_TRUE(built.check(1000).passed());
  Built ignorant = built;
  ignorant.field.roles.assign(ignorant.field.roles.size(), FacetRole::boundary);
  EXPECT_GT(ignorant.check(1000).stored.exceeded, 0u);
}

TEST(CheckDistances, FindAStoredValueThatIsOff) {
  Built built = build(icosphere(2), 0.04, 3);
  for (float& phi : built.field.level_set.phi.values()) phi *= 1 + 0x1p-21f;
  const DistanceCheck check = built.check(400);
  EXPECT_FALSE(check.passed());
  EXPECT_EQ(check.kernel.exceeded, 0u);
  EXPECT_GT(check.stored.exceeded, 100u);
  EXPECT_GT(check.stored.worst_share, 1);
}

TEST(CheckDistances, FindFacetsThatNoListNames) {
  Built built = build(icosphere(2), 0.04, 3);
  SurfaceOctree& grid = built.field.level_set.grid;
  // Every leaf forgets all facets but its first.
  std::vector<std::uint64_t> first(1, 0);
  std::vector<std::uint32_t> facets;
  for (std::size_t leaf = 0; leaf < grid.octree.size(); ++leaf) {
    if (grid.near_surface(leaf)) facets.push_back(grid.facets_of(leaf).front());
    first.push_back(facets.size());
  }
  grid.first_facet = first;
  grid.facets = facets;
  EXPECT_GT(built.check(400).kernel.exceeded, 100u);
}

TEST(CheckDistances, AreTheSameForAnyNumberOfThreads) {
  const Built built = build(torus(24, 12), 0.03, 3);
  const auto figures = [&](int threads) {
    const ThreadLimit limit(threads);
    const DistanceCheck check = built.check(1000, 7);
    return std::array{check.kernel.max, check.kernel.rms, check.stored.max, check.stored.rms, static_cast<double>(check.stored_nodes)};
  };
  EXPECT_EQ(figures(1), figures(4));
}

// More than there are: every node near the surface is compared, and those at corners and edges once more.
TEST(CheckDistances, OfAllNodes) {
  const Built built = build(cube(), 0.25, 2);
  std::size_t near = 0;
  for (std::size_t leaf = 0; leaf < built.field.level_set.octree().size(); ++leaf) near += built.field.level_set.grid.near_surface(leaf);
  const DistanceCheck check = built.check(1'000'000);
  EXPECT_TRUE(check.passed());
  const std::size_t at_features = check.nodes[static_cast<std::size_t>(NodeStratum::near_features)];
  EXPECT_GE(at_features, 8u);
  EXPECT_EQ(check.total(), kBlockNodes * near + at_features);
}

}  // namespace
}  // namespace burnish
