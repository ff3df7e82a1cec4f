#include "burnish/levelset/adapt.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/triangle_index.h"
#include "support/analytic_level_set.h"
#include "support/exact_field.h"
#include "support/random_octree.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;
using Keys = std::vector<std::uint64_t>;

Keys keys_of(const Octree& tree) {
  Keys keys;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) keys.push_back(tree.key(leaf));
  return keys;
}

// A closed surface in the middle of a domain of 2^depth blocks.
TriangleSoup in_domain(const TriangleSoup& soup, double scale, int depth, const Vec3& offset) {
  const double middle = 4.0 * (1 << depth);
  return moved(scaled(moved(soup, bounding_box(soup).center() * -1.0), scale), Vec3{middle, middle, middle} + offset);
}

// Of the leaf that holds a point.
int level_of(const SurfaceOctree& grid, const Vec3& p) {
  const auto block = [](double x) { return static_cast<std::uint32_t>(x / kBlockSide); };
  return grid.octree.level(grid.octree.find({block(p.x), block(p.y), block(p.z)}));
}

struct Measured {
  double on_surface = 0, beside = 0;  // largest errors at points in blocks that are not finest
  std::size_t points = 0;
};

// Random points of the surface, and points moved off them by up to a cell, in blocks of level 1 and more. Points whose
// sampled cell has corners in leaves without facets are left out.
// `height(p)`: positive inside, at least as large as the distance where that is more than 4; the rest is the winding number's to tell.
template <class Height>
Measured measured_errors(const TriangleSoup& soup, const SurfaceOctree& grid, const Height& height, std::size_t points, unsigned seed) {
  const TriangleIndex index(soup);
  const auto inside = [&](const Vec3& p) {
    const double h = height(p);
    return std::abs(h) > 4 ? h > 0 : index.winding_number(p) > 0.5;
  };
  const Field<double> field = exact_field(soup, grid, inside);
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(0, 1);
  Measured m;
  for (std::size_t i = 0; i < points; ++i) {
    const std::size_t f = random() % soup.facets.size();
    double s = any(random), t = any(random);
    if (s + t > 1) s = 1 - s, t = 1 - t;
    const Vec3 p = soup.corner(f, 0) + (soup.corner(f, 1) - soup.corner(f, 0)) * s + (soup.corner(f, 2) - soup.corner(f, 0)) * t;
    const int level = level_of(grid, p);
    if (level == 0) continue;
    ++m.points;
    m.on_surface = std::max(m.on_surface, std::abs(sample(grid.octree, field, p.x, p.y, p.z)));
    const Vec3 q = p + (random_offset(random) * 2.0 - Vec3{1, 1, 1}) * std::ldexp(0.5, level);
    const double value = sample(grid.octree, field, q.x, q.y, q.z);
    if (level_of(grid, q) != level || std::isnan(value)) continue;
    const double exact = (inside(q) ? 1 : -1) * std::sqrt(index.closest(q).squared_distance);
    m.beside = std::max(m.beside, std::abs(value - exact));
  }
  return m;
}

TEST(AdaptProperty, ErrorsInCoarseBlocksAreWithinTheTolerance) {
  struct Shape {
    const char* name;
    TriangleSoup soup;
    double tolerance;
    std::function<double(const Vec3&)> height;  // positive inside
  };
  const int depth = 5;
  const Vec3 offset{0.31, 0.47, 0.13}, center = Vec3{128, 128, 128} + offset;
  const auto ball = [=](const Vec3& p) { return 90 - norm(p - center); };
  const auto tube = [=](const Vec3& p) { return 30 - std::hypot(std::hypot(p.x - center.x, p.y - center.y) - 75, p.z - center.z); };
  const auto ellipsoid = [=](const Vec3& p) { return 100 - norm(Vec3{p.x - center.x, (p.y - center.y) / 0.7, (p.z - center.z) / 0.5}); };
  const Shape shapes[] = {
      {"ball", in_domain(icosphere(5), 90, depth, offset), 0.05, ball},
      {"torus", in_domain(torus(96, 48), 75, depth, offset), 0.1, tube},
      {"coarse ball", in_domain(icosphere(2), 90, depth, offset), 0.3, ball},
      {"ellipsoid", in_domain(mapped(icosphere(5), [](const Vec3& p) { return Vec3{p.x, 0.7 * p.y, 0.5 * p.z}; }), 100, depth, offset), 0.1, ellipsoid},
  };
  for (const Shape& shape : shapes) {
    SCOPED_TRACE(shape.name);
    const SurfaceOctree grid = grow_to_tolerance(shape.soup, depth, {.tolerance = shape.tolerance, .coarsest_level = 3}).grid;
    const Measured m = measured_errors(shape.soup, grid, shape.height, 3000, 3);
    RecordProperty(std::string("on_surface_") + shape.name, std::to_string(m.on_surface));
    RecordProperty(std::string("beside_") + shape.name, std::to_string(m.beside));
    EXPECT_GT(m.points, 400u);
    EXPECT_LE(m.on_surface, shape.tolerance);
    EXPECT_LE(m.beside, shape.tolerance);
  }
}

TEST(AdaptProperty, LevelsFollowTheCurvature) {
  // A ball of radius R on cells of side H is off by H^2 / R at most: H = 8 would do for R = 90 and a tolerance of 1, not for 0.1.
  const TriangleSoup ball = in_domain(icosphere(5), 90, 5, {0.31, 0.47, 0.13});
  const auto grow = [&](double tolerance) { return grow_to_tolerance(ball, 5, {.tolerance = tolerance, .coarsest_level = 3}); };
  const AdaptiveGrowth fine = grow(1e-6), coarse = grow(2);
  EXPECT_GT(fine.statistics.levels[0].cells_cut, 0u);
  EXPECT_EQ(fine.statistics.cells_cut(), fine.statistics.levels[0].cells_cut);
  EXPECT_EQ(coarse.statistics.levels[0].cells_cut, 0u);
  std::size_t before = 0;
  for (const double tolerance : {1.0, 0.3, 0.1, 0.03, 0.01}) {
    const std::size_t leaves = grow(tolerance).grid.octree.size();
    EXPECT_GE(leaves, before) << tolerance;
    before = leaves;
  }
}

// A spike between the nodes of a coarse block, far narrower than its cells: only the surface's own points show it.
TEST(AdaptProperty, DetailsBetweenNodesAreFound) {
  TriangleSoup soup = in_domain(icosphere(5), 90, 5, {0.31, 0.47, 0.13});
  const Vec3 center{128.31, 128.47, 128.13};
  Vec3& top = *std::max_element(soup.points.begin(), soup.points.end(), [](const Vec3& a, const Vec3& b) { return a.x + a.y < b.x + b.y; });
  top += (top - center) * (4 / norm(top - center));
  const AdaptiveGrowth grown = grow_to_tolerance(soup, 5, {.tolerance = 0.2, .coarsest_level = 3});
  const SurfaceOctree& grid = grown.grid;
  EXPECT_EQ(level_of(grid, top), 0);
  EXPECT_LT(grown.statistics.levels[0].cells_cut, grown.statistics.cells_cut() / 2);
}

TEST(AdaptProperty, FlatFacesStayCoarseAndSharpEdgesAreFinest) {
  const int depth = 5;
  const TriangleSoup box = in_domain(cube(), 170, depth, {0.31, 0.47, 0.13});
  const SurfaceOctree grid = grow_to_tolerance(box, depth, {.tolerance = 0.05, .coarsest_level = 2}).grid;
  const Box3 bounds = bounding_box(box);
  std::size_t coarse = 0;
  for (std::size_t leaf = 0; leaf < grid.octree.size(); ++leaf) {
    if (!grid.near_surface(leaf)) continue;
    const morton::Position c = grid.octree.corner(leaf);
    const double size = 8 << grid.octree.level(leaf);
    const Vec3 low{8.0 * c.x, 8.0 * c.y, 8.0 * c.z}, high = low + Vec3{size, size, size};
    const auto holds = [&](int a, double x) { return low[a] < x && x < high[a]; };
    const auto meets = [&](int a) { return holds(a, bounds.lower[a]) || holds(a, bounds.upper[a]); };
    const auto within = [&](int a) { return bounds.lower[a] < high[a] && low[a] < bounds.upper[a]; };
    const int faces = meets(0) + meets(1) + meets(2);
    if (faces >= 2 && within(0) && within(1) && within(2)) {
      EXPECT_EQ(grid.octree.level(leaf), 0);
    }
    coarse += faces == 1 && grid.octree.level(leaf) == 2;
  }
  EXPECT_GT(coarse, 50u);
}

TEST(AdaptProperty, SoupsThatPromiseNothingGrowToo) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    TriangleSoup soup;
    for (std::uint32_t i = 0; i < 30; ++i) soup.points.push_back(Vec3{40, 40, 40} + random_offset(random) * 48.0);
    for (std::uint32_t i = 0; i < 25; ++i) {
      const auto any = [&] { return static_cast<std::uint32_t>(random() % 30); };
      soup.facets.push_back({any(), any(), any()});
    }
    const AdaptiveGrowth grown = grow_to_tolerance(soup, 4, {.tolerance = 0.1, .coarsest_level = 2});
    // An open sheet has no sides: the rims at least are finest.
    EXPECT_GT(grown.statistics.levels[0].cells_cut, 0u);
  }
}

TEST(AdaptProperty, SameResultForAnyNumberOfThreads) {
  const TriangleSoup soup = in_domain(torus(96, 48), 75, 5, {0.31, 0.47, 0.13});
  const auto grow = [&](int threads) {
    const ThreadLimit limit(threads);
    return grow_to_tolerance(soup, 5, {.tolerance = 0.1, .coarsest_level = 3}).grid;
  };
  const SurfaceOctree one = grow(1), four = grow(4);
  EXPECT_EQ(keys_of(one.octree), keys_of(four.octree));
  EXPECT_EQ(one.first_facet, four.first_facet);
  EXPECT_EQ(one.facets, four.facets);
}

// phi = value(node) at every node of the octree, with one facet in each leaf that it changes sign in.
template <class T, class Value>
BasicLevelSet<T> spread_level_set(Octree tree, double band, const Value& value) {
  BasicLevelSet<T> set = level_set_of<T>(std::move(tree), value);
  set.band = band;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) set.grid.facets.push_back(static_cast<std::uint32_t>(leaf));
  return set;
}

// At every node of the fine level set, as `coarsen` promises.
template <class T>
void expect_kept(const BasicLevelSet<T>& fine, const BasicLevelSet<T>& coarse, double tolerance) {
  for (std::size_t leaf = 0; leaf < fine.octree().size(); ++leaf)
    for (int n = 0; n < 512; ++n) {
      const double old = fine.phi.block(leaf)[n];
      const Vec3 p = to_vec(lattice_node(fine.octree(), leaf, n % 8, n / 8 % 8, n / 64));
      const double now = sample(coarse.octree(), coarse.phi, p.x, p.y, p.z);
      if (std::abs(old) < fine.band) {
        ASSERT_NEAR(now, old, tolerance + 1e-12);
      } else {
        ASSERT_EQ(now >= 0, old >= 0);
      }
    }
}

TEST(CoarsenProperty, NoNodeIsOffByMoreThanTheTolerance) {
  const Vec3 center{32.3, 31.8, 32.1};
  for (const double tolerance : {0.003, 0.03, 0.3})
    for (const double radius : {9.0, 20.0}) {
      SCOPED_TRACE(testing::Message() << "tolerance " << tolerance << ", radius " << radius);
      const auto distance = [&](const LatticeNode& n) { return radius - norm(to_vec(n) - center); };
      const auto ball = spread_level_set<double>(Octree::build(3, all_blocks(3)), 6, distance);
      const auto coarse = coarsen(ball, tolerance, 3);
      expect_kept(ball, coarse, tolerance);
      EXPECT_LT(coarse.octree().size(), ball.octree().size());
    }
}

TEST(CoarsenProperty, WavySurfacesOnRandomOctrees) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Octree tree = random_octree(random, 3, 60);
    const Vec3 wave = random_offset(random) * 0.25;
    const auto height = [&](const LatticeNode& n) { return n.z - 30.3 + 5 * std::sin(wave.x * n.x) * std::cos(wave.y * n.y); };
    const auto set = spread_level_set<float>(tree, 8, height);
    for (const double tolerance : {0.01, 0.1, 1.0}) expect_kept(set, coarsen(set, tolerance, 3), tolerance);
  }
}

TEST(CoarsenProperty, RefinedAndCoarsenedIsTheIdentity) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> any(-5, 5);
    const Octree tree = random_octree(random, 3, 3);
    // Beside the walls, beyond which values continue and nothing is interpolated, nodes are beyond the band.
    const auto value = [&](const LatticeNode& n) { return std::max({n.x, n.y, n.z}) < 56 ? any(random) : 200; };
    const auto set = spread_level_set<double>(tree, 100, value);
    Keys keys = keys_of(tree);
    for (const std::uint64_t key : keys_of(tree))
      if (const int l = morton::level(key); l > 0 && random() % 2) keys.push_back(morton::key((key >> (3 * l + 1)) << 3, l - 1));
    BasicLevelSet<double> fine;
    fine.frame = set.frame;
    fine.band = set.band;
    fine.grid = transfer_facets(set.grid, Octree::build_graded(3, keys));
    fine.phi = transfer_nodal(set.octree(), set.phi, fine.octree());
    const auto back = coarsen(fine, 1e-12, 3);
    ASSERT_EQ(keys_of(back.octree()), keys_of(tree));
    ASSERT_EQ(back.phi.values(), set.phi.values());
    ASSERT_EQ(back.grid.facets, set.grid.facets);
    ASSERT_EQ(back.grid.first_facet, set.grid.first_facet);
  }
}

TEST(CoarsenProperty, ALinearFieldBecomesAsCoarseAsAllowed) {
  const auto linear = [](const LatticeNode& n) { return 0.5 * n.x + 0.25 * n.y - n.z + 11; };
  const auto set = spread_level_set<double>(Octree::build(3, all_blocks(3)), 100, linear);
  const auto coarse = coarsen(set, 1e-12, 2);
  // The walls' last cells continue their nodes' values, which is not linear: blocks at the upper walls stay.
  EXPECT_EQ(coarse.octree().level(coarse.octree().find({0, 0, 0})), 2);
  expect_kept(set, coarse, 1e-12);
  EXPECT_EQ(coarsen(set, 1e-12, 0).phi.values(), set.phi.values());
}

// Real distances: spread to the whole domain, coarsened where the ball is smooth.
TEST(CoarsenProperty, DistancesOfAMesh) {
  const TriangleSoup ball = scaled(icosphere(4), 1);
  const GridFrame frame = make_frame(bounding_box(ball), 1.0 / 40, 12);
  const LevelSet set = level_set_from_triangles(ball, frame, {.band = 5, .room = 8}).level_set;
  const LevelSet coarse = coarsen(set, 0.05, 3);
  expect_kept(set, coarse, 0.05);
  EXPECT_LT(coarse.octree().size(), set.octree().size() * 3 / 4);
  std::size_t merged = 0;
  for (std::size_t leaf = 0; leaf < coarse.octree().size(); ++leaf) merged += coarse.grid.near_surface(leaf) && coarse.octree().level(leaf) > 0;
  EXPECT_GT(merged, 20u);
}

TEST(CoarsenProperty, SameBitsForAnyNumberOfThreads) {
  const Vec3 center{32.3, 31.8, 32.1};
  const auto ball = spread_level_set<float>(Octree::build(3, all_blocks(3)), 6, [&](const LatticeNode& n) { return 20 - norm(to_vec(n) - center); });
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return coarsen(ball, 0.05, 3);
  };
  const LevelSet one = run(1), four = run(4);
  EXPECT_EQ(keys_of(one.octree()), keys_of(four.octree()));
  EXPECT_EQ(one.phi.values(), four.phi.values());
}

}  // namespace
}  // namespace burnish
