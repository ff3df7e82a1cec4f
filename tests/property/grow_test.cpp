#include "burnish/octree/grow.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/levelset/crossings.h"
#include "burnish/octree/grid_frame.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

Vec3 random_point(std::mt19937& random, double low, double high) {
  std::uniform_real_distribution<double> any(low, high);
  const double x = any(random), y = any(random), z = any(random);
  return {x, y, z};
}

// Facets of all sizes in [20, 44]^3, in a domain of 64 cells.
TriangleSoup random_facets(std::mt19937& random, std::size_t count) {
  TriangleSoup soup;
  for (std::uint32_t f = 0; f < count; ++f) {
    const Vec3 a = random_point(random, 20, 44);
    const double size = std::exp(std::uniform_real_distribution<double>(-3, 3)(random));
    soup.points.push_back(a);
    for (int i = 0; i < 2; ++i) soup.points.push_back(max(min(a + random_point(random, -size, size), {44, 44, 44}), {20, 20, 20}));
    soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  return soup;
}

// The least max-norm distance from a cube's centre to points of a triangle, by subdivision: below the truth never, above
// it by less than the triangle's size over 2^rounds.
double sampled_max_norm(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& center, int n) {
  double least = 1e300;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Vec3 p = a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n) - center;
      least = std::min(least, std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}));
    }
  return least;
}

TEST(GrowProperty, OverlapAgreesWithDenseSamples) {
  std::size_t hits = 0, misses = 0;
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Vec3 a = random_point(random, -3, 3), b = random_point(random, -3, 3), c = random_point(random, -3, 3);
    const Vec3 center = random_point(random, -1, 1);
    const double least = sampled_max_norm(a, b, c, center, 64);
    if (least <= 1) {
      ASSERT_TRUE(triangle_overlaps_cube(a, b, c, center, 1));
      ++hits;
    } else if (least > 1.15) {  // more than the distance between samples
      ASSERT_FALSE(triangle_overlaps_cube(a, b, c, center, 1));
      ++misses;
    }
  }
  EXPECT_GT(hits, 100u);
  EXPECT_GT(misses, 50u);
}

// The least distance from a cube of half side 1 to points of a triangle, by subdivision.
double sampled_distance(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& center, int n) {
  double least = 1e300;
  for (int i = 0; i <= n; ++i)
    for (int j = 0; i + j <= n; ++j) {
      const Vec3 p = a + (b - a) * (double(i) / n) + (c - a) * (double(j) / n) - center;
      const Vec3 gap = max(max(p - Vec3{1, 1, 1}, Vec3{-1, -1, -1} - p), Vec3{});
      least = std::min(least, norm(gap));
    }
  return least;
}

TEST(GrowProperty, NearnessAgreesWithDenseSamples) {
  std::size_t hits = 0, misses = 0, in_vain = 0;
  for (unsigned seed = 1; seed <= 600; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Vec3 a = random_point(random, -5, 5), b = random_point(random, -5, 5), c = random_point(random, -5, 5);
    const Vec3 center = random_point(random, -1, 1);
    const double reach = 0.5 + static_cast<double>(seed % 4);
    const bool near = TriangleNearBox(a, b, c, reach)(center, 1);
    const double least = sampled_distance(a, b, c, center, 64);
    if (least <= reach) {
      ASSERT_TRUE(near);
      ++hits;
    } else if (least > 1.4143 * reach + 0.2) {
      ASSERT_FALSE(near);
      ++misses;
    } else if (least > reach + 0.2) {
      in_vain += near;
    }
  }
  EXPECT_GT(hits, 100u);
  EXPECT_GT(misses, 50u);
  EXPECT_LT(in_vain, 30u);
}

// The normal of a facet that is a line but for rounding has any direction: blocks that hold one of its corners are near it.
TEST(GrowProperty, LinesAreNearTheBlocksOfTheirPoints) {
  for (unsigned seed = 1; seed <= 400; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Vec3 a = random_point(random, 0, 500), c = random_point(random, 0, 500);
    const Vec3 b = a + (c - a) * std::uniform_real_distribution<double>(0, 1)(random);
    for (const Vec3& p : {a, b, c}) {
      const Vec3 center{8 * std::floor(p.x / 8) + 3.5, 8 * std::floor(p.y / 8) + 3.5, 8 * std::floor(p.z / 8) + 3.5};
      ASSERT_TRUE(TriangleNearBox(a, b, c, 3)(center, 3.5));
      ASSERT_TRUE(triangle_overlaps_cube(a, b, c, center + Vec3{0.5, 0.5, 0.5}, 4.0001));
    }
  }
}

TEST(GrowProperty, TouchingCounts) {
  // In the plane of a face, through an edge, through a corner; and just off each.
  EXPECT_TRUE(triangle_overlaps_cube({1, -9, -9}, {1, 9, -9}, {1, 0, 9}, {0, 0, 0}, 1));
  EXPECT_TRUE(triangle_overlaps_cube({2, 0, -9}, {0, 2, -9}, {1, 1, 9}, {0, 0, 0}, 1));
  EXPECT_TRUE(triangle_overlaps_cube({3, 0, 0}, {0, 3, 0}, {0, 0, 3}, {0, 0, 0}, 1));
  EXPECT_FALSE(triangle_overlaps_cube({1.001, -9, -9}, {1.001, 9, -9}, {1.001, 0, 9}, {0, 0, 0}, 1));
  EXPECT_FALSE(triangle_overlaps_cube({2.002, 0, -9}, {0, 2.002, -9}, {1.001, 1.001, 9}, {0, 0, 0}, 1));
  EXPECT_FALSE(triangle_overlaps_cube({3.003, 0, 0}, {0, 3.003, 0}, {0, 0, 3.003}, {0, 0, 0}, 1));
}

// Brute force: every finest block against every facet.
TEST(GrowProperty, BandListsAreThoseOfBruteForce) {
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const TriangleSoup soup = random_facets(random, 60);
    const double band = 1 + static_cast<double>(seed % 3);
    const SurfaceOctree grid = grow_uniform_band(soup, 3, band);
    for (std::uint32_t z = 0; z < 8; ++z)
      for (std::uint32_t y = 0; y < 8; ++y)
        for (std::uint32_t x = 0; x < 8; ++x) {
          std::vector<std::uint32_t> expected;
          for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
            if (TriangleNearBox(soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2), band + 1e-6)({8 * x + 3.5, 8 * y + 3.5, 8 * z + 3.5}, 3.5))
              expected.push_back(f);
          const std::uint32_t leaf = grid.octree.find({x, y, z});
          const auto facets = grid.facets_of(leaf);
          if (expected.empty()) {
            ASSERT_TRUE(facets.empty());
          } else {
            ASSERT_EQ(grid.octree.level(leaf), 0);
            ASSERT_EQ(std::vector<std::uint32_t>(facets.begin(), facets.end()), expected);
          }
        }
  }
}

TEST(GrowProperty, SameListsForAnyNumberOfThreads) {
  const TriangleSoup soup = moved(scaled(icosphere(5), 25), {32.1, 31.7, 32.4});
  const auto grow = [&](int threads) {
    const ThreadLimit limit(threads);
    return grow_uniform_band(soup, 3, 3);
  };
  const SurfaceOctree one = grow(1), four = grow(4);
  EXPECT_EQ(one.first_facet, four.first_facet);
  EXPECT_EQ(one.facets, four.facets);
}

// A node inside and one outside a closed surface are never joined by an edge that no facet crosses.
TEST(CrossingsProperty, ClosedSurfacesLetNothingPass) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Vec3 center = random_point(random, 30, 34);
    const Vec3 axes = random_point(random, 5, 20);
    const int level = static_cast<int>(seed % 4);
    TriangleSoup soup = mapped(icosphere(level), [&](const Vec3& p) {
      return center + Vec3{axes.x * p.x, axes.y * p.y, axes.z * p.z};
    });
    const SurfaceOctree grid = grow_uniform_band(soup, 3, 2);
    const Field<std::uint8_t> crossed = crossed_edges(soup, grid);
    // Convex with the origin inside: a point is inside if it is behind every facet.
    const auto inside = [&](const Vec3& p) {
      for (std::size_t f = 0; f < soup.facets.size(); ++f)
        if (dot(facet_normal_2a(soup, f), p - soup.corner(f, 0)) > 0) return false;
      return true;
    };
    for (std::size_t leaf = 0; leaf < grid.octree.size(); leaf += 3) {
      if (!grid.near_surface(leaf)) continue;
      for (int n = 0; n < 512; n += 3) {
        const LatticeNode node = lattice_node(grid.octree, leaf, n % 8, n / 8 % 8, n / 64);
        const Vec3 p{double(node.x), double(node.y), double(node.z)};
        const bool here = inside(p);
        for (int axis = 0; axis < 3; ++axis) {
          Vec3 q = p;
          q[axis] += 1;
          const bool marked = crossed.block(leaf)[n] >> axis & 1;
          const bool separated = inside(q) != here;
          if (separated) {
            ASSERT_TRUE(marked) << "a leak at " << p.x << ' ' << p.y << ' ' << p.z << " axis " << axis;
          }
          if (here && !separated) {
            ASSERT_FALSE(marked) << "inside a convex body nothing is crossed: " << p.x << ' ' << p.y << ' ' << p.z;
          }
        }
      }
    }
  }
}

TEST(GridFrameProperty, HoldsTheBoxWithItsMargin) {
  for (unsigned seed = 1; seed <= 200; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    Box3 box;
    const double scale = std::exp(std::uniform_real_distribution<double>(-20, 20)(random));
    box.extend(random_point(random, -1, 1) * scale);
    box.extend(random_point(random, -1, 1) * scale);
    const double cell = box.longest_side() / std::uniform_real_distribution<double>(1, 500)(random);
    const double margin = std::uniform_real_distribution<double>(1, 20)(random);
    const GridFrame frame = make_frame(box, cell, margin);
    const Vec3 low = frame.to_lattice(box.lower), high = frame.to_lattice(box.upper);
    for (int a = 0; a < 3; ++a) {
      EXPECT_GE(low[a], margin - 1e-6);
      EXPECT_LE(high[a], frame.lattice_side() - margin + 1e-6);
    }
    if (frame.depth > 0) {
      EXPECT_LT(frame.lattice_side() / 2, box.longest_side() / cell + 2 * margin + 2);
    }
    EXPECT_LE(norm(frame.to_model(low) - box.lower), 1e-12 * scale);
  }
}

}  // namespace
}  // namespace burnish
