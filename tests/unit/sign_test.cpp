#include "burnish/levelset/sign.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <functional>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/triangle_index.h"
#include "support/level_sets.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

// Positive inside, in model units.
using SignedDistance = std::function<double(const Vec3&)>;

SignedDistance ball(const Vec3& center, double radius) {
  return [=](const Vec3& p) { return radius - norm(p - center); };
}

double in_unit_cube(const Vec3& p) {
  const Vec3 q{std::abs(p.x - 0.5) - 0.5, std::abs(p.y - 0.5) - 0.5, std::abs(p.z - 0.5) - 0.5};
  return -norm(max(q, Vec3{})) - std::min(0.0, std::max({q.x, q.y, q.z}));
}

template <class Visit>
void for_each_node(const LevelSet& set, Visit&& visit) {
  const Octree& tree = set.octree();
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
      visit(to_vec(lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64)), static_cast<double>(set.phi.block(leaf)[n]), tree.level(leaf));
}

LevelSetFromTriangles make(const TriangleSoup& soup, double cell, double band = 3) {
  return level_set_from_triangles(soup, make_frame(bounding_box(soup), cell, band + 9), {.band = band});
}

// Signs are right at every node farther than `tolerance` (in cells) from the analytic surface; returns how many those are.
std::size_t expect_signs(const LevelSet& set, const SignedDistance& exact, double tolerance) {
  std::size_t checked = 0, wrong = 0;
  for_each_node(set, [&](const Vec3& p, double phi, int) {
    const double d = exact(set.frame.to_model(p)) / set.frame.cell;
    if (std::abs(d) <= tolerance) return;
    ++checked;
    wrong += (phi > 0) != (d > 0);
  });
  EXPECT_EQ(wrong, 0u) << "of " << checked;
  return checked;
}

// |phi| is the distance to `boundary`, within the band exactly but for its rounding to float, beyond it never too small.
void expect_exact_distances(const LevelSet& set, const TriangleSoup& boundary) {
  const TriangleIndex index(to_lattice(boundary, set.frame));
  double worst = 0, worst_far = 0;
  std::size_t within = 0;
  for_each_node(set, [&](const Vec3& p, double phi, int level) {
    if (std::abs(phi) > set.band && (static_cast<int>(p.x + p.y + p.z) >> level) % 5 != 0) return;  // a part is enough
    const double d = std::sqrt(index.closest(p).squared_distance);
    if (d <= set.band) {
      ++within;
      worst = std::max(worst, std::abs(std::abs(phi) - d) / (6e-8 * d + 1e-12));
    } else {
      worst_far = std::max(worst_far, (d - std::abs(phi)) / d);
    }
  });
  EXPECT_GT(within, 1000u);
  EXPECT_LE(worst, 1) << "in units of 6e-8 d + 1e-12 cells";
  EXPECT_LE(worst_far, 1e-7);
}

TEST(Sign, Sphere) {
  const TriangleSoup soup = icosphere(4);
  const LevelSetFromTriangles result = make(soup, 1.0 / 16);
  EXPECT_EQ(result.regions, 2u);
  EXPECT_EQ(result.ambiguous_regions, 0u);
  EXPECT_EQ(result.interior_facets, 0u);
  EXPECT_EQ(result.unresolved_facets, 0u);
  // The facets lie up to 1.6e-3 inside the ball: 0.03 cells.
  EXPECT_GT(expect_signs(result.level_set, ball({}, 1), 0.04), 20'000u);
  expect_exact_distances(result.level_set, soup);
}

TEST(Sign, Torus) {
  const TriangleSoup soup = torus(120, 60);
  const LevelSetFromTriangles result = make(soup, 1.0 / 16);
  EXPECT_EQ(result.regions, 2u);
  EXPECT_EQ(result.ambiguous_regions, 0u);
  expect_signs(result.level_set, [](const Vec3& p) { return 0.4 - std::hypot(std::hypot(p.x, p.y) - 1, p.z); }, 0.05);
  expect_exact_distances(result.level_set, soup);
}

TEST(Sign, CubeOfRoundNumbers) {
  for (const double cell : {1.0 / 16, 1.0 / 10, 0.07}) {
    SCOPED_TRACE(testing::Message() << "cell " << cell);
    const LevelSetFromTriangles result = make(cube(), cell);
    EXPECT_EQ(result.regions, 2u);
    EXPECT_EQ(result.ambiguous_regions, 0u);
    EXPECT_EQ(result.interior_facets + result.unresolved_facets, 0u);
    expect_signs(result.level_set, in_unit_cube, 1e-9);
    expect_exact_distances(result.level_set, cube());
  }
}

// A lattice whose nodes lie on the faces, which `make_frame` never makes: nodes off the surface keep their side.
TEST(Sign, CubeWithNodesOnItsFaces) {
  const GridFrame frame{{-0.5, -0.5, -0.5}, 1.0 / 16, 2};
  const LevelSetFromTriangles result = level_set_from_triangles(cube(), frame);
  expect_signs(result.level_set, in_unit_cube, 1e-9);
  for_each_node(result.level_set, [&](const Vec3& p, double phi, int) {
    const double d = in_unit_cube(frame.to_model(p)) * 16;
    if (std::abs(d) <= 3) {
      EXPECT_NEAR(std::abs(phi), std::abs(d), 6e-8 * 3);
    }
  });
}

TEST(Sign, CavityIsOutside) {
  const TriangleSoup soup = merged(icosphere(4), flipped(scaled(icosphere(3), 0.5)));
  const LevelSetFromTriangles result = make(soup, 1.0 / 16);
  EXPECT_EQ(result.regions, 3u);
  EXPECT_EQ(result.ambiguous_regions, 0u);
  EXPECT_EQ(result.interior_facets, 0u);
  expect_signs(result.level_set, [](const Vec3& p) { return std::min(1 - norm(p), norm(p) - 0.5); }, 0.08);
  expect_exact_distances(result.level_set, soup);
}

TEST(Sign, OverlapIsAUnion) {
  const Vec3 left{-0.5, 0, 0}, right{0.5, 0.02, 0.01};
  const auto both = [&](const Vec3& p) { return std::max(ball(left, 1)(p), ball(right, 1)(p)); };
  // With facets of 4.5 cells, up to 0.4 cells inside the ball, and of 1.1.
  for (const auto& [subdivision, inward] : {std::pair{2, 0.45}, {4, 0.06}}) {
    SCOPED_TRACE(testing::Message() << "subdivision " << subdivision);
    const TriangleSoup soup = merged(moved(icosphere(subdivision), left), moved(icosphere(subdivision), right));
    const LevelSetFromTriangles result = make(soup, 1.0 / 16);
    const LevelSet& set = result.level_set;
    EXPECT_EQ(result.regions, 4u);
    EXPECT_EQ(result.ambiguous_regions, 0u);
    EXPECT_EQ(result.unresolved_facets, 0u);
    expect_signs(set, both, inward);
    // A quarter of each sphere lies in the other ball. What crosses no lattice edge, or is beside the seam, is not counted.
    const double share = static_cast<double>(result.interior_facets) / static_cast<double>(soup.facets.size());
    EXPECT_GT(share, 0.14);
    EXPECT_LT(share, 0.25);
    // Outside, the union's distance is the smaller one; inside it is at least the larger one, whatever sheets there were
    // (but for facets that cross the seam or begin beside it, and those smaller than cells).
    double worst_outside = 0, worst_inside = 0;
    for_each_node(set, [&](const Vec3& p, double phi, int) {
      const Vec3 x = set.frame.to_model(p);
      const double d = both(x) / set.frame.cell, to_seam = std::hypot(x.x, std::hypot(x.y, x.z) - std::sqrt(0.75)) / set.frame.cell;
      if (d < -0.1 && d > inward - set.band) worst_outside = std::max(worst_outside, std::abs(phi - d));
      if (d > 0.1 && to_seam > 11) worst_inside = std::max(worst_inside, std::min(d, set.band) - phi);
    });
    EXPECT_LE(worst_outside, inward);
    if (subdivision == 2) {
      EXPECT_LE(worst_inside, inward);
    }
  }
}

TEST(Sign, DoubleShellIsOneSolid) {
  const TriangleSoup shell = icosphere(3);
  const LevelSetFromTriangles result = make(merged(shell, shell), 1.0 / 16);
  EXPECT_EQ(result.regions, 2u);
  EXPECT_EQ(result.ambiguous_regions, 0u);
  EXPECT_EQ(result.interior_facets, 0u);
  expect_signs(result.level_set, ball({}, 1), 0.12);
  expect_exact_distances(result.level_set, shell);
}

TEST(Sign, HoleIsClosedByItsCap) {
  const TriangleSoup shell = icosphere(4);
  std::vector<std::size_t> missing;
  for (std::size_t f = 0; f < shell.facets.size(); ++f)
    if (shell.corner(f, 0).z > 0.95) missing.push_back(f);
  const CappedSoup capped = cap_boundary(without_facets(shell, missing));
  ASSERT_EQ(capped.caps.size(), 1u);
  const LevelSetFromTriangles result = make(capped.soup, 1.0 / 16);
  EXPECT_EQ(result.regions, 2u);
  EXPECT_EQ(result.ambiguous_regions, 0u);
  // Below the cap's rim, up to its unevenness, the ball; above it nothing.
  expect_signs(result.level_set, [](const Vec3& p) { return std::min(1 - norm(p), 0.92 - p.z) > 0 ? 1 - norm(p) : p.z > 0.96 ? -1.0 : std::min(0.0, 1 - norm(p)); },
               0.04);
  expect_exact_distances(result.level_set, capped.soup);
}

TEST(Sign, PartitionWallsAreNoSurface) {
  TriangleSoup soup = cube();
  soup.points.insert(soup.points.end(), {{0.47, 0, 0}, {0.47, 1, 0}, {0.47, 1, 1}, {0.47, 0, 1}});
  soup.facets.insert(soup.facets.end(), {{8, 9, 10}, {8, 10, 11}});
  const CappedSoup capped = cap_boundary(soup);
  EXPECT_EQ(capped.caps.size(), 1u);
  const LevelSetFromTriangles result = make(capped.soup, 1.0 / 16);
  EXPECT_EQ(result.regions, 3u);
  EXPECT_EQ(result.ambiguous_regions, 0u);
  EXPECT_EQ(result.interior_facets, 4u);  // the wall and its cap
  expect_signs(result.level_set, in_unit_cube, 1e-9);
  expect_exact_distances(result.level_set, cube());
}

TEST(Sign, InsideOutIsOutside) {
  const LevelSetFromTriangles result = make(flipped(icosphere(2)), 1.0 / 8);
  for_each_node(result.level_set, [](const Vec3&, double phi, int) { ASSERT_LE(phi, 0); });
  EXPECT_EQ(result.unresolved_facets, 320u);
}

TEST(Sign, SameBitsForAnyNumberOfThreads) {
  const TriangleSoup soup = merged(torus(60, 30), moved(icosphere(4), {0.9, 0.2, 0.1}));
  const auto build = [&](int threads) {
    const ThreadLimit limit(threads);
    return make(soup, 1.0 / 24);
  };
  const LevelSetFromTriangles one = build(1), four = build(4);
  ASSERT_EQ(one.level_set.phi.values().size(), four.level_set.phi.values().size());
  EXPECT_EQ(std::memcmp(one.level_set.phi.values().data(), four.level_set.phi.values().data(), one.level_set.phi.values().size() * sizeof(float)), 0);
  EXPECT_EQ(one.winding_evaluations, four.winding_evaluations);
  EXPECT_EQ(one.interior_facets, four.interior_facets);
}

// Far values are distances to some facet: never too small. Candidates are thinned out, so that it need not be the closest.
void expect_far_distances_of_a_ball(int level, double worst_cells) {
  const TriangleSoup soup = icosphere(level);
  const LevelSetFromTriangles result = level_set_from_triangles(soup, make_frame(bounding_box(soup), 1.0 / 8, 40), {.band = 3});
  double worst = 0;
  std::size_t far = 0;
  for_each_node(result.level_set, [&](const Vec3& p, double phi, int) {
    const double d = (1 - norm(result.level_set.frame.to_model(p))) * 8;
    if (d > -3) return;
    ++far;
    ASSERT_LE(phi, d * (1 - 1e-6)) << "too small";
    worst = std::max(worst, std::abs(phi - d));
  });
  EXPECT_GT(far, 10'000u);
  EXPECT_LE(worst, worst_cells);
}

TEST(FarField, IsTheDistanceOutsideAConvexBody) { expect_far_distances_of_a_ball(3, 0.3); }

// Thousands of facets in a block: the closest ones have to be among the few that are passed on.
TEST(FarField, OfFacetsFarSmallerThanCells) { expect_far_distances_of_a_ball(6, 0.3); }

// A ball with a hole that nothing closes: inside and outside are one region. Sides are certain far from the hole, and doubtful in it.
TEST(Sign, DoubtIsToldNodeByNode) {
  const TriangleSoup ball = icosphere(3);
  EXPECT_TRUE(make(ball, 0.1).certainty.empty());
  std::vector<std::size_t> top;
  for (std::size_t f = 0; f < ball.facets.size(); ++f)
    if (ball.corner(f, 0).z + ball.corner(f, 1).z + ball.corner(f, 2).z > 3 * 0.85) top.push_back(f);
  const LevelSetFromTriangles built = make(without_facets(ball, top), 0.05);
  EXPECT_EQ(built.ambiguous_regions, 1u);
  ASSERT_FALSE(built.certainty.empty());
  const Octree& tree = built.level_set.octree();
  double in_hole = 255, far = 255;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
      const Vec3 p = built.level_set.frame.to_model(to_vec(lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64)));
      const double certainty = built.certainty.block(leaf)[n];
      if (norm(p - Vec3{0, 0, 0.86}) < 0.12) in_hole = std::min(in_hole, certainty);
      if (p.z < -0.3) far = std::min(far, certainty);
    }
  EXPECT_LT(in_hole, 50);
  EXPECT_GT(far, 180);
}

}  // namespace
}  // namespace burnish
