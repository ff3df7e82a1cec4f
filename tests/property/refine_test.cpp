#include "burnish/octree/refine.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <random>

#include "burnish/core/parallel.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;
using Keys = std::vector<std::uint64_t>;

Vec3 random_point(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> any(low, high);
  const double x = any(random), y = any(random), z = any(random);
  return {x, y, z};
}

// Facets of all sizes in [20, 44]^3, in a domain of 64 cells; some without area.
TriangleSoup random_facets(std::mt19937& random, std::size_t count) {
  TriangleSoup soup;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Vec3 a = random_point(random, 20, 44);
    const double size = std::exp(std::uniform_real_distribution<double>(-3, 3)(random));
    soup.points.push_back(a);
    for (int i = 0; i < 2; ++i) soup.points.push_back(max(min(a + random_point(random, -size, size), {44, 44, 44}), {20, 20, 20}));
    soup.facets.push_back({3 * f, 3 * f + 1, f % 13 == 0 ? 3 * f + 1 : 3 * f + 2});
  }
  return soup;
}

struct Case {
  TriangleSoup soup;
  GrowthOptions options;
  RefinementLimits limits;
  int depth = 0;

  AdaptiveGrowth grow() const {
    const auto criteria = criteria_of(limits);
    std::vector<const RefinementCriterion*> asked;
    for (const auto& criterion : criteria) asked.push_back(criterion.get());
    return grow_adaptive(soup, depth, options, asked);
  }
};

Case random_case(unsigned seed) {
  std::mt19937 random(seed);
  Case c;
  c.soup = random_facets(random, 1 + random() % 80);
  c.options.cells_per_side = seed % 2 == 0 ? 8 : 1;
  c.depth = seed % 2 == 0 ? 3 : 6;
  c.options.coarsest_level = static_cast<int>(random() % static_cast<unsigned>(c.depth + 1));
  c.options.band = static_cast<double>(random() % 4);
  if (c.options.cells_per_side == 8) c.options.band = std::max(c.options.band, 2.0);
  if (random() % 2) c.limits.max_face_limit = random() % 4;
  if (random() % 2) c.limits.max_face_cut = 1 + random() % 6;
  if (random() % 2) c.limits.refine_tol = std::exp(std::uniform_real_distribution<double>(-2, 2)(random));
  return c;
}

Vec3 corner_of(std::uint64_t key, int cells_per_side) {
  const morton::Position p = morton::corner(key);
  return Vec3{static_cast<double>(p.x), static_cast<double>(p.y), static_cast<double>(p.z)} * cells_per_side;
}

bool overlaps(const TriangleSoup& soup, std::uint32_t f, const Vec3& corner, double side, double by) {
  return triangle_overlaps_cube(soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2), corner + Vec3{1, 1, 1} * (0.5 * side), 0.5 * side + by);
}

// All facets against the cube of the octant inflated by `by`, or of a block against the box of its nodes rounded by it; above the
// coarsest level against its cube rounded by it.
std::vector<std::uint32_t> facets_near(const Case& c, std::uint64_t key, double by) {
  std::vector<std::uint32_t> near;
  const int level = morton::level(key);
  const double cell = std::ldexp(1.0, level), side = c.options.cells_per_side * cell;
  const Vec3 corner = corner_of(key, c.options.cells_per_side);
  const double half = 0.5 * (level <= c.options.coarsest_level ? side - cell : side);
  for (std::uint32_t f = 0; f < c.soup.facets.size(); ++f) {
    const bool meets = c.options.cells_per_side == 1
                           ? overlaps(c.soup, f, corner, side, by)
                           : TriangleNearBox(c.soup.corner(f, 0), c.soup.corner(f, 1), c.soup.corner(f, 2), by + 1e-6)(corner + Vec3{1, 1, 1} * half, half);
    if (meets) near.push_back(f);
  }
  return near;
}

// The thesis' Algorithm 2, cell by facet.
bool a_cell_fires(const Case& c, std::uint64_t key) {
  const double side = std::ldexp(1.0, morton::level(key));
  const int n = c.options.cells_per_side;
  for (int cell = 0; cell < n * n * n; ++cell) {
    const Vec3 low = corner_of(key, n) + Vec3{double(cell % n), double(cell / n % n), double(cell / (n * n))} * side;
    std::uint32_t sorted = 0, cut = 0;
    double length_scale = 1e300;
    for (std::uint32_t f = 0; f < c.soup.facets.size(); ++f) {
      if (!overlaps(c.soup, f, low, side, 0)) continue;
      ++cut;
      const Vec3 centroid = (c.soup.corner(f, 0) + c.soup.corner(f, 1) + c.soup.corner(f, 2)) / 3.0;
      const Vec3 in = centroid - low;
      sorted += std::min({in.x, in.y, in.z}) >= 0 && std::max({in.x, in.y, in.z}) < side;
      for (int i = 0; i < 3; ++i)
        if (const double edge = norm(c.soup.corner(f, (i + 1) % 3) - c.soup.corner(f, i)); edge > 0) length_scale = std::min(length_scale, edge);
    }
    if (c.limits.max_face_limit && sorted > *c.limits.max_face_limit) return true;
    if (c.limits.max_face_cut && cut > *c.limits.max_face_cut) return true;
    if (c.limits.refine_tol && cut > 0 && side / length_scale > *c.limits.refine_tol) return true;
  }
  return false;
}

void add_leaves_by_definition(const Case& c, std::uint64_t key, Keys& leaves) {
  const int level = morton::level(key), coarsest = c.options.coarsest_level;
  const double band = c.options.band * std::ldexp(1.0, std::min(level, coarsest));
  const bool divided = level > 0 && !facets_near(c, key, band).empty() && (level > coarsest || a_cell_fires(c, key));
  if (!divided) {
    leaves.push_back(key);
    return;
  }
  for (std::uint64_t child = 0; child < 8; ++child)
    add_leaves_by_definition(c, morton::key((key >> (3 * level + 1)) << 3 | child, level - 1), leaves);
}

Keys keys_of(const Octree& tree) {
  Keys keys;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) keys.push_back(tree.key(leaf));
  return keys;
}

TEST(RefineProperty, IsTheCoarsestBalancedOctreeInWhichNoCriterionFires) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    Case c = random_case(seed);
    // A facet with an edge of length 0 has no length scale: the definition above leaves only that edge out.
    std::erase_if(c.soup.facets, [](const Facet& f) { return f[1] == f[2]; });
    Keys leaves;
    add_leaves_by_definition(c, morton::key(0, c.depth), leaves);
    ASSERT_EQ(keys_of(c.grow().grid.octree), keys_of(Octree::build_graded(c.depth, leaves)));
  }
}

TEST(RefineProperty, ListsOfEveryLevelAreThoseOfBruteForce) {
  std::vector<std::size_t> lists(8, 0);
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case c = random_case(seed);
    const SurfaceOctree grid = c.grow().grid;
    ASSERT_EQ(grid.first_facet.size(), grid.octree.size() + 1);
    for (std::size_t leaf = 0; leaf < grid.octree.size(); ++leaf) {
      const int level = grid.octree.level(leaf);
      const auto list = grid.facets_of(leaf);
      const auto expected = facets_near(c, grid.octree.key(leaf), c.options.band * std::ldexp(1.0, std::min(level, c.options.coarsest_level)));
      ASSERT_EQ(std::vector<std::uint32_t>(list.begin(), list.end()), expected) << "leaf " << leaf << " of level " << level;
      lists[static_cast<std::size_t>(level)] += !expected.empty();
    }
  }
  for (int level = 0; level < 4; ++level) EXPECT_GT(lists[static_cast<std::size_t>(level)], 50u) << "level " << level;
}

TEST(RefineProperty, StatisticsAddUp) {
  for (unsigned seed = 1; seed <= 40; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    const Case c = random_case(seed);
    const AdaptiveGrowth grown = c.grow();
    const GrowthStatistics& s = grown.statistics;
    std::uint64_t leaves = 0, cut = 0;
    for (const LevelCount& level : s.levels) leaves += level.leaves;
    ASSERT_EQ(leaves, grown.grid.octree.size());
    const int n = c.options.cells_per_side;
    for (std::size_t leaf = 0; leaf < grown.grid.octree.size(); ++leaf) {
      const double side = std::ldexp(1.0, grown.grid.octree.level(leaf));
      for (int cell = 0; cell < n * n * n; ++cell) {
        const Vec3 low = corner_of(grown.grid.octree.key(leaf), n) + Vec3{double(cell % n), double(cell / n % n), double(cell / (n * n))} * side;
        const auto list = grown.grid.facets_of(leaf);
        cut += std::any_of(list.begin(), list.end(), [&](std::uint32_t f) { return overlaps(c.soup, f, low, side, 0); });
      }
    }
    ASSERT_EQ(s.cells_cut(), cut);
    ASSERT_EQ(s.cells(), leaves * static_cast<std::uint64_t>(n * n * n));
    ASSERT_EQ(s.divided_by.size(), criteria_of(c.limits).size());
  }
}

TEST(RefineProperty, WithoutCriteriaAndLevelZeroIsTheUniformBand) {
  std::mt19937 random(3);
  const TriangleSoup soup = random_facets(random, 60);
  const SurfaceOctree uniform = grow_uniform_band(soup, 3, 2), grown = grow_adaptive(soup, 3, {8, 0, 2}, {}).grid;
  EXPECT_EQ(keys_of(grown.octree), keys_of(uniform.octree));
  EXPECT_EQ(grown.first_facet, uniform.first_facet);
  EXPECT_EQ(grown.facets, uniform.facets);
}

TEST(RefineProperty, SameResultForAnyNumberOfThreads) {
  const TriangleSoup soup = moved(scaled(icosphere(5), 25), {32.1, 31.7, 32.4});
  const auto grow = [&](int threads) {
    const ThreadLimit limit(threads);
    const auto few = max_face_cut(12);
    const RefinementCriterion* criteria[] = {few.get()};
    return grow_adaptive(soup, 6, {1, 4, 1}, criteria);
  };
  const AdaptiveGrowth one = grow(1), four = grow(4);
  EXPECT_EQ(keys_of(one.grid.octree), keys_of(four.grid.octree));
  EXPECT_EQ(one.grid.first_facet, four.grid.first_facet);
  EXPECT_EQ(one.grid.facets, four.grid.facets);
  EXPECT_EQ(one.statistics.divided_by, four.statistics.divided_by);
  EXPECT_GT(one.statistics.divided_by[0], 100u);
}

TEST(RefineProperty, ASoupWithoutFacetsIsOneLeaf) {
  const AdaptiveGrowth grown = grow_adaptive({}, 4, {}, {});
  EXPECT_EQ(grown.grid.octree.size(), 1u);
  EXPECT_FALSE(grown.grid.near_surface(0));
  EXPECT_EQ(grown.statistics.divided_by_balance, 0u);
}

// A frame's cells: leaves of 2^level lattice units at corner(leaf), each listing what cuts it.
TEST(RefineProperty, CellsOfAFrame) {
  const TriangleSoup soup = icosphere(3);
  const GridFrame frame = make_frame(bounding_box(soup), 0.03, 2);
  RefinementLimits limits;
  limits.max_face_cut = 8;
  limits.coarsest_level = 4;
  const SurfaceOctree grid = grow_cells(soup, frame, limits);
  ASSERT_EQ(grid.octree.depth(), frame.depth + 3);
  std::size_t with_facets = 0;
  for (std::size_t leaf = 0; leaf < grid.octree.size(); ++leaf) {
    const morton::Position c = grid.octree.corner(leaf);
    const Vec3 low = frame.to_model({double(c.x), double(c.y), double(c.z)});
    const double side = frame.cell * std::ldexp(1.0, grid.octree.level(leaf));
    const Vec3 center = low + Vec3{1, 1, 1} * (side / 2);
    // The unit sphere's facets are within 0.02 of it.
    if (grid.near_surface(leaf)) {
      ++with_facets;
      EXPECT_LE(std::abs(norm(center) - 1), 0.9 * side + 0.02);
      EXPECT_TRUE(grid.facets_of(leaf).size() <= 8 || grid.octree.level(leaf) == 0);
    } else {
      EXPECT_GE(std::abs(norm(center) - 1), 0.5 * side - 0.02);
    }
  }
  EXPECT_GT(with_facets, 500u);
}

}  // namespace
}  // namespace burnish
