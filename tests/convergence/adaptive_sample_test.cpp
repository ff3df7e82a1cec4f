// Distances on octrees whose levels jump right through the surface: interpolation stays second order.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/levelset/adapt.h"
#include "support/analytic_level_set.h"

namespace burnish {
namespace {

using namespace test;

// The closest point of an ellipsoid (Eberly, "Distance from a point to an ellipsoid"): y = a^2 p / (t + a^2) per axis, t the largest root of
// sum of (a p / (t + a^2))^2 = 1. Newton's method from the left is monotone, since the sum is convex and decreasing there.
double ellipsoid_distance(const Vec3& axes, const Vec3& p) {
  double t = -1e300;
  for (int a = 0; a < 3; ++a) t = std::max(t, axes[a] * std::abs(p[a]) - axes[a] * axes[a]);
  for (int i = 0; i < 50; ++i) {
    double f = -1, slope = 0;
    for (int a = 0; a < 3; ++a) {
      const double d = t + axes[a] * axes[a], r = d > 0 ? axes[a] * p[a] / d : 0;
      f += r * r;
      if (d > 0) slope -= 2 * r * r / d;
    }
    if (!(f > 1e-15) || slope == 0) break;
    t -= f / slope;
  }
  Vec3 y, in;
  for (int a = 0; a < 3; ++a) {
    y[a] = axes[a] * axes[a] * p[a] / (t + axes[a] * axes[a]);
    in[a] = p[a] / axes[a];
  }
  return squared_norm(in) < 1 ? norm(p - y) : -norm(p - y);
}

// Blocks of levels 0, 1 and 2, in a pattern of octants that the surface runs through.
Octree jumping_octree(int depth, std::mt19937& random) {
  std::vector<std::uint64_t> keys;
  for (std::uint64_t m = 0; m < std::uint64_t{1} << 3 * (depth - 2); ++m) {
    keys.push_back(morton::key(m, 2));
    if (random() % 3 == 0) keys.push_back(morton::key(m << 3 | random() % 8, 1));
    if (random() % 6 == 0) keys.push_back(morton::key(m << 6 | random() % 64, 0));
  }
  return Octree::build_graded(depth, keys);
}

constexpr double kReach = 0.05;  // how far off the surface is sampled, in parts of the shape's size

// The largest error of `sample` near the surface, in parts of the shape's size, over ten offsets and octrees. The shape is `size`
// finest cells large, in a domain of 2^depth blocks.
template <class Distance>
double worst_error(int depth, double size, const Distance& distance) {
  double worst = 0;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    std::mt19937 random(seed);
    const double middle = 4.0 * (1 << depth);
    const Vec3 center = Vec3{middle, middle, middle} + random_offset(random) * 8.0;
    const Octree tree = jumping_octree(depth, random);
    Field<double> field(tree.size(), 0);
    parallel_for(
        tree.size(),
        [&](std::size_t leaf) {
          // Blocks that no sampled cell has a corner in are left out.
          const double half = 4 << tree.level(leaf);
          const Vec3 middle_of_leaf = to_vec(lattice_node(tree, leaf, 4, 4, 4));
          if (std::abs(distance((middle_of_leaf - center) / size)) * size > 1.8 * half + kReach * size + 16) return;
          for (int n = 0; n < 512; ++n) {
            const Vec3 p = to_vec(lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64));
            field.block(leaf)[n] = size * distance((p - center) / size);
          }
        },
        16);
    std::uniform_real_distribution<double> any(-1.3, 1.3);
    for (int i = 0; i < 20'000; ++i) {
      const Vec3 p{any(random), any(random), any(random)};
      const double exact = distance(p);
      if (std::abs(exact) > kReach) continue;
      const Vec3 x = center + p * size;
      worst = std::max(worst, std::abs(sample(tree, field, x.x, x.y, x.z) / size - exact));
    }
  }
  return worst;
}

template <class Distance>
void expect_second_order(const char* name, const Distance& distance) {
  const double coarse = worst_error(4, 40, distance), middle = worst_error(5, 80, distance), fine = worst_error(6, 160, distance);
  testing::Test::RecordProperty(std::string("order_") + name, std::to_string(std::log2(middle / fine)));
  EXPECT_GE(std::log2(coarse / fine) / 2, 1.85) << name << ": " << coarse << " -> " << middle << " -> " << fine;
  EXPECT_GE(std::log2(middle / fine), 1.8) << name << ": " << coarse << " -> " << middle << " -> " << fine;
}

TEST(AdaptiveSample, BallsAreOfSecondOrder) {
  expect_second_order("ball", [](const Vec3& p) { return 1 - norm(p); });
}

TEST(AdaptiveSample, ToriAreOfSecondOrder) {
  expect_second_order("torus", [](const Vec3& p) { return 0.4 - std::hypot(std::hypot(p.x, p.y) - 0.8, p.z); });
}

TEST(AdaptiveSample, EllipsoidsAreOfSecondOrder) {
  expect_second_order("ellipsoid", [](const Vec3& p) { return ellipsoid_distance({1.1, 0.8, 0.7}, p); });
}

}  // namespace
}  // namespace burnish
