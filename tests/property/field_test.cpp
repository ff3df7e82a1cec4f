#include "burnish/octree/field.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "burnish/core/vec.h"
#include "support/random_octree.h"
#include "support/repetitions.h"

namespace burnish {
namespace {

using namespace test;

Vec3 position(const LatticeNode& n) { return {double(n.x), double(n.y), double(n.z)}; }

template <class T, class Function>
Field<T> field_of(const Octree& tree, Function&& f) {
  Field<T> field(tree.size(), 0);
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i)
          field.block(leaf)[node_index(i, j, k)] = static_cast<T>(f(position(lattice_node(tree, leaf, i, j, k))));
  return field;
}

// Whether interpolation around p (in a leaf of this level) stays clear of the domain's end, where values continue
// as constants.
bool far_from_walls(const Octree& tree, const Vec3& p, int level) {
  const double margin = 4.0 * (1 << level), end = 8.0 * tree.side() - 1;
  for (int a = 0; a < 3; ++a)
    if (p[a] < 0 || p[a] + margin > end) return false;
  return true;
}

int level_at(const Octree& tree, const Vec3& p) {
  const auto block = [](double x) { return static_cast<std::uint32_t>(x) / kBlockSide; };
  return tree.level(tree.find({block(p.x), block(p.y), block(p.z)}));
}

template <class T>
class FieldProperty : public testing::Test {};
using Scalars = testing::Types<float, double>;
TYPED_TEST_SUITE(FieldProperty, Scalars);

TYPED_TEST(FieldProperty, GatherIsNodeValueBitForBit) {
  using T = TypeParam;
  for (unsigned seed = 1; seed <= 24; ++seed) {
    std::mt19937 random(seed);
    const int depth = 1 + static_cast<int>(random() % 5), width = 1 + static_cast<int>(seed % 3);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth << ", width " << width);
    const Octree tree = random_octree(random, depth, 4);
    std::uniform_real_distribution<double> value(-1, 1);
    const Field<T> field = field_of<T>(tree, [&](const Vec3&) { return value(random); });
    const int side = kBlockSide + 2 * width;
    std::vector<T> dense(static_cast<std::size_t>(side * side * side));
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
      gather(tree, field, leaf, width, dense.data());
      std::size_t n = 0;
      for (int k = -width; k < kBlockSide + width; ++k)
        for (int j = -width; j < kBlockSide + width; ++j)
          for (int i = -width; i < kBlockSide + width; ++i, ++n) {
            const T expected = static_cast<T>(node_value(tree, field, lattice_node(tree, leaf, i, j, k)));
            ASSERT_EQ(std::memcmp(&dense[n], &expected, sizeof(T)), 0)
                << "leaf " << leaf << " node " << i << ' ' << j << ' ' << k << ": " << dense[n] << " against " << expected;
          }
    }
  }
}

TYPED_TEST(FieldProperty, StoredNodesAreWhatTheyAre) {
  using T = TypeParam;
  for (unsigned seed = 1; seed <= 10; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Octree tree = random_octree(random, 4, 5);
    std::uniform_real_distribution<double> value(-1, 1);
    const Field<T> field = field_of<T>(tree, [&](const Vec3&) { return value(random); });
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
      for (int n = 0; n < 512; n += 7) {
        const LatticeNode node = lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64);
        const double stored = field.block(leaf)[n];
        ASSERT_EQ(node_value(tree, field, node), stored);
        ASSERT_EQ(sample(tree, field, node.x, node.y, node.z), stored);
        // Beyond a wall the wall's value continues.
        if (node.x == 0) {
          ASSERT_EQ(node_value(tree, field, {-3, node.y, node.z}), stored);
        }
      }
  }
}

TYPED_TEST(FieldProperty, LinearFunctionsComeBackAcrossLevelJumps) {
  using T = TypeParam;
  const double rounding = std::is_same_v<T, float> ? 1e-4 : 1e-12;  // values up to 500
  const auto linear = [](const Vec3& p) { return 3 + 0.5 * p.x - 0.75 * p.y + 0.25 * p.z; };
  std::size_t across = 0;
  for (unsigned seed = 1; seed <= 12; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Octree tree = random_octree(random, 5, 3);
    const Field<T> field = field_of<T>(tree, linear);
    constexpr int width = 3, side = kBlockSide + 2 * width;
    std::vector<T> dense(side * side * side);
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
      gather(tree, field, leaf, width, dense.data());
      std::size_t n = 0;
      for (int k = -width; k < kBlockSide + width; ++k)
        for (int j = -width; j < kBlockSide + width; ++j)
          for (int i = -width; i < kBlockSide + width; ++i, ++n) {
            const Vec3 p = position(lattice_node(tree, leaf, i, j, k));
            if (p.x < 0 || p.y < 0 || p.z < 0) continue;
            const double end = 8.0 * tree.side();
            if (p.x >= end || p.y >= end || p.z >= end) continue;
            const int level = level_at(tree, p);
            if (!far_from_walls(tree, p, level)) continue;
            across += level > tree.level(leaf);
            ASSERT_NEAR(dense[n], linear(p), rounding) << "leaf " << leaf << " node " << i << ' ' << j << ' ' << k;
          }
    }
    std::uniform_real_distribution<double> any(0, 8.0 * tree.side());
    for (int i = 0; i < 2000; ++i) {
      const Vec3 p{any(random), any(random), any(random)};
      if (far_from_walls(tree, p, level_at(tree, p))) {
        ASSERT_NEAR(sample(tree, field, p.x, p.y, p.z), linear(p), 2 * rounding);
      }
    }
  }
  EXPECT_GT(across, 10'000u) << "the trees have too few level jumps to show anything";
}

// Points within one cell of a coarser neighbour, where interpolation uses nodes that no leaf stores.
std::vector<Vec3> points_beside_jumps(const Octree& tree, std::mt19937& random) {
  std::uniform_real_distribution<double> part(0, 1);
  std::vector<Vec3> points;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int axis = 0; axis < 3; ++axis) {
      const int dir = direction(axis == 0, axis == 1, axis == 2);
      if (tree.neighbor_kind(leaf, dir) != NeighborKind::coarser) continue;
      const double size = 1 << tree.level(leaf);
      for (int i = 0; i < 200; ++i) {
        Vec3 p = position(lattice_node(tree, leaf, 0, 0, 0));
        for (int a = 0; a < 3; ++a) p[a] += size * (a == axis ? 7 + part(random) : 8 * part(random));
        if (far_from_walls(tree, p, tree.level(leaf) + 1)) points.push_back(p);
      }
    }
  return points;
}

// The lattice stays, the function's wavelength doubles: the same as halving every cell.
TEST(FieldOrder, SamplesAreSecondOrderAcrossLevelJumps) {
  std::mt19937 random(3);
  const Octree tree = random_octree(random, 5, 6);
  const std::vector<Vec3> points = points_beside_jumps(tree, random);
  ASSERT_GT(points.size(), 1000u);
  // The worst of several phases, so that every wavelength meets its largest curvature beside a jump.
  const auto worst = [&](double wavelength) {
    const double w = 2 * std::numbers::pi / wavelength;
    double error = 0;
    for (int phase = 0; phase < 8; ++phase) {
      const auto f = [&](const Vec3& p) {
        return std::sin(w * p.x + 0.8 * phase) * std::cos(w * p.y + 2.1 * phase) + std::sin(w * (p.z + 0.5 * p.x) + 1.3 * phase);
      };
      const Field<double> field = field_of<double>(tree, f);
      for (const Vec3& p : points) error = std::max(error, std::abs(sample(tree, field, p.x, p.y, p.z) - f(p)));
    }
    return error;
  };
  const double coarse = worst(64), middle = worst(128), fine = worst(256);
  RecordProperty("order_1", std::to_string(std::log2(coarse / middle)));
  RecordProperty("order_2", std::to_string(std::log2(middle / fine)));
  EXPECT_GE(std::log2(coarse / middle), 1.9) << coarse << " -> " << middle;
  EXPECT_GE(std::log2(middle / fine), 1.9) << middle << " -> " << fine;
}

// A polynomial of this degree in each variable, with coefficients that depend on the seed.
double polynomial(int degree, unsigned seed, const LatticeNode& n) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> any(-1, 1);
  double sum = 0;
  for (int c = 0; c <= degree; ++c)
    for (int b = 0; b <= degree; ++b)
      for (int a = 0; a <= degree; ++a) sum += any(random) * std::pow(n.x / 32.0 - 1, a) * std::pow(n.y / 32.0 - 1, b) * std::pow(n.z / 32.0 - 1, c);
  return sum;
}

TEST(GatherSmooth, ReproducesPolynomialsAcrossLevelJumps) {
  for (unsigned seed = 1; seed <= repetitions(4, 1); ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const Octree tree = random_octree(random, 3, 12);
    for (const auto& [order, degree] : {std::pair{HaloOrder::cubic, 3}, std::pair{HaloOrder::quintic, 5}}) {
      Field<double> field(tree.size(), 0);
      for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
        for (int n = 0; n < 512; ++n) field.block(leaf)[n] = polynomial(degree, seed, lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64));
      constexpr int width = 4, side = 8 + 2 * width, last = 64;
      std::vector<double> dense(side * side * side);
      int interpolated = 0;
      for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
        gather_smooth(tree, field, leaf, width, order, dense.data());
        for (int k = -width; k < 8 + width; ++k)
          for (int j = -width; j < 8 + width; ++j)
            for (int i = -width; i < 8 + width; ++i) {
              const LatticeNode node = lattice_node(tree, leaf, i, j, k);
              // Stencils must not meet the walls, where fields go on as constants: three coarse cells.
              const int room = 6 << (tree.level(leaf) + 1);
              if (std::min({node.x, node.y, node.z}) < room || std::max({node.x, node.y, node.z}) > last - room) continue;
              const double value = dense[static_cast<std::size_t>((i + width) + side * ((j + width) + side * (k + width)))];
              const double exact = polynomial(degree, seed, node);
              ASSERT_NEAR(value, exact, 1e-10) << i << " " << j << " " << k;
              interpolated += value != exact;
            }
      }
      EXPECT_GT(interpolated, 100);
    }
  }
}

TEST(GatherSmooth, CopiesWhatIsStored) {
  std::mt19937 random(5);
  const Octree tree = random_octree(random, 3, 12);
  Field<float> field(tree.size(), 0);
  std::uniform_real_distribution<float> any(-1, 1);
  for (float& v : field.values()) v = any(random);
  constexpr int width = 3, side = 8 + 2 * width;
  std::vector<float> dense(side * side * side);
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
    gather_smooth(tree, field, leaf, width, HaloOrder::cubic, dense.data());
    for (int k = -width; k < 8 + width; ++k)
      for (int j = -width; j < 8 + width; ++j)
        for (int i = -width; i < 8 + width; ++i) {
          const LatticeNode node = lattice_node(tree, leaf, i, j, k);
          if (std::min({node.x, node.y, node.z}) < 0 || std::max({node.x, node.y, node.z}) >= 64) continue;
          const std::uint32_t at = tree.find({static_cast<std::uint32_t>(node.x) / 8, static_cast<std::uint32_t>(node.y) / 8, static_cast<std::uint32_t>(node.z) / 8});
          const int mask = (1 << tree.level(at)) - 1;
          if (((node.x | node.y | node.z) & mask) != 0) continue;
          ASSERT_EQ(dense[static_cast<std::size_t>((i + width) + side * ((j + width) + side * (k + width)))], node_value(tree, field, node));
        }
  }
}

}  // namespace
}  // namespace burnish
