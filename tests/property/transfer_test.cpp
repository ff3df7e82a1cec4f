#include "burnish/octree/transfer.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "burnish/core/parallel.h"
#include "support/level_sets.h"
#include "support/random_octree.h"

namespace burnish {
namespace {

using namespace test;

std::vector<std::uint64_t> keys_of(const Octree& tree) {
  std::vector<std::uint64_t> keys;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) keys.push_back(tree.key(leaf));
  return keys;
}

// The octree with some more leaves divided, by up to two levels.
Octree refined(const Octree& tree, std::mt19937& random) {
  std::vector<std::uint64_t> keys = keys_of(tree);
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
    if (random() % 6 != 0) continue;
    std::uint64_t key = tree.key(leaf);
    for (std::uint64_t by = 1 + random() % 2; by > 0 && morton::level(key) > 0; --by) {
      const int level = morton::level(key);
      key = morton::key((key >> (3 * level + 1)) << 3 | random() % 8, level - 1);
      keys.push_back(key);
    }
  }
  return Octree::build_graded(tree.depth(), keys);
}

Field<double> random_field(const Octree& tree, std::mt19937& random) {
  std::uniform_real_distribution<double> any(-5, 5);
  Field<double> field(tree.size(), 0);
  for (double& v : field.values()) v = any(random);
  return field;
}

// Runs check(coarse, fine, random) on pairs of octrees, the second a refinement of the first; a failure names the seed.
void for_pairs(unsigned seeds, const std::function<void(const Octree&, const Octree&, std::mt19937&)>& check) {
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    std::mt19937 random(seed);
    const int depth = 1 + static_cast<int>(random() % 3);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth);
    const Octree coarse = random_octree(random, depth, 4);
    check(coarse, refined(coarse, random), random);
    if (testing::Test::HasFatalFailure()) return;
  }
}

double integral(const Octree& tree, const Field<double>& field, std::size_t begin, std::size_t end) {
  double sum = 0;
  for (std::size_t leaf = begin; leaf < end; ++leaf)
    for (std::size_t n = 0; n < kBlockNodes; ++n) sum += field.block(leaf)[n] * std::ldexp(1.0, 3 * tree.level(leaf));
  return sum;
}

TEST(TransferProperty, NodesRefinedAndCoarsenedComeBackBitForBit) {
  std::size_t more = 0;
  for_pairs(40, [&](const Octree& coarse, const Octree& fine, std::mt19937& random) {
    const Field<double> field = random_field(coarse, random);
    ASSERT_EQ(transfer_nodal(fine, transfer_nodal(coarse, field, fine), coarse).values(), field.values());
    more += fine.size() > coarse.size();
  });
  EXPECT_GT(more, 20u);
}

TEST(TransferProperty, NodesOfALinearFieldStayExactOffTheWalls) {
  for_pairs(40, [](const Octree& coarse, const Octree& fine, std::mt19937&) {
    const auto linear = [](const LatticeNode& n) { return 0.5 * n.x - 0.25 * n.y + 2.0 * n.z + 1; };
    const Field<double> field = level_set_of(coarse, linear).phi, carried = transfer_nodal(coarse, field, fine);
    const int last = static_cast<int>(coarse.side()) * kBlockSide - (1 << coarse.depth());
    for (std::size_t leaf = 0; leaf < fine.size(); ++leaf)
      for (int n = 0; n < 512; ++n) {
        const LatticeNode at = lattice_node(fine, leaf, n % 8, n / 8 % 8, n / 64);
        if (std::max({at.x, at.y, at.z}) <= last) {
          ASSERT_NEAR(carried.block(leaf)[n], linear(at), 1e-12);
        }
      }
  });
}

// Halving the cell quarters the error of a field carried from cells of twice the size.
TEST(TransferProperty, InterpolationIsOfSecondOrder) {
  const auto worst = [](int level) {
    const int depth = 4;
    std::vector<std::uint64_t> coarse_keys, fine_keys;
    for (const std::uint64_t m : all_blocks(depth - level)) coarse_keys.push_back(morton::key(m, level));
    for (const std::uint64_t m : all_blocks(depth - level + 1)) fine_keys.push_back(morton::key(m, level - 1));
    const Octree coarse = Octree::build_graded(depth, coarse_keys), fine = Octree::build_graded(depth, fine_keys);
    const auto smooth = [](const LatticeNode& n) { return std::sin(0.06 * n.x + 0.3) * std::cos(0.05 * n.y) + std::sin(0.07 * n.z); };
    const Field<double> carried = transfer_nodal(coarse, level_set_of(coarse, smooth).phi, fine);
    double error = 0;
    for (std::size_t leaf = 0; leaf < fine.size(); ++leaf)
      for (int n = 0; n < 512; ++n) {
        const LatticeNode at = lattice_node(fine, leaf, n % 8, n / 8 % 8, n / 64);
        if (std::max({at.x, at.y, at.z}) < 110) error = std::max(error, std::abs(carried.block(leaf)[n] - smooth(at)));
      }
    return error;
  };
  const double e3 = worst(3), e2 = worst(2), e1 = worst(1);
  RecordProperty("order", std::to_string(std::log2(e2 / e1)));
  EXPECT_GE(std::log2(e3 / e2), 1.9);
  EXPECT_GE(std::log2(e2 / e1), 1.95);
}

TEST(TransferProperty, ConservedSumsStayTheSameInEveryOctant) {
  for_pairs(40, [](const Octree& coarse, const Octree& fine, std::mt19937& random) {
    for (const Reconstruction how : {Reconstruction::constant, Reconstruction::linear}) {
      const Field<double> field = random_field(coarse, random), finer = transfer_conserved(coarse, field, fine, how);
      for (std::size_t leaf = 0; leaf < coarse.size(); ++leaf) {
        const LeafRange in = leaves_in(fine, coarse.key(leaf));
        const double scale = 5 * 512 * std::ldexp(1.0, 3 * coarse.level(leaf));
        ASSERT_NEAR(integral(fine, finer, in.begin, in.end), integral(coarse, field, leaf, leaf + 1), 1e-13 * scale);
      }
      const Field<double> back = transfer_conserved(fine, finer, coarse, how);
      for (std::size_t i = 0; i < field.values().size(); ++i) ASSERT_NEAR(back.values()[i], field.values()[i], 1e-13 * 20);
    }
    // Any field on the fine octree, not only what came from the coarse one.
    const Field<double> field = random_field(fine, random), coarser = transfer_conserved(fine, field, coarse);
    ASSERT_NEAR(integral(coarse, coarser, 0, coarse.size()), integral(fine, field, 0, fine.size()),
                1e-13 * 5 * 512 * std::ldexp(1.0, 3 * coarse.depth()));
  });
}

TEST(TransferProperty, CellMeansOfALinearFieldStayExact) {
  for_pairs(20, [](const Octree& coarse, const Octree& fine, std::mt19937&) {
    const auto means = [](const Octree& tree) {
      Field<double> field(tree.size(), 0);
      for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
        for (int n = 0; n < 512; ++n) {
          const LatticeNode at = lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64);
          const double half = 0.5 * (1 << tree.level(leaf));
          field.block(leaf)[n] = 0.5 * (at.x + half) - 3 * (at.y + half) + 0.125 * (at.z + half);
        }
      return field;
    };
    const Field<double> finer = transfer_conserved(coarse, means(coarse), fine), exact = means(fine);
    for (std::size_t i = 0; i < exact.values().size(); ++i) ASSERT_NEAR(finer.values()[i], exact.values()[i], 1e-10);
  });
}

TEST(TransferProperty, ListsAreUnitedOrInherited) {
  for_pairs(40, [](const Octree& coarse, const Octree& fine, std::mt19937& random) {
    SurfaceOctree grid;
    grid.octree = fine;
    grid.first_facet.push_back(0);
    for (std::size_t leaf = 0; leaf < fine.size(); ++leaf) {
      for (std::uint32_t f = 0; f < 20; ++f)
        if (random() % 9 == 0) grid.facets.push_back(f);
      grid.first_facet.push_back(grid.facets.size());
    }
    const SurfaceOctree merged = transfer_facets(grid, coarse), again = transfer_facets(merged, fine);
    for (std::size_t leaf = 0; leaf < fine.size(); ++leaf) {
      const std::uint32_t holder = coarse.find(fine.corner(leaf));
      const auto list = merged.facets_of(holder), inherited = again.facets_of(leaf);
      ASSERT_TRUE(std::is_sorted(list.begin(), list.end()));
      ASSERT_TRUE(std::includes(list.begin(), list.end(), grid.facets_of(leaf).begin(), grid.facets_of(leaf).end()));
      ASSERT_TRUE(std::equal(list.begin(), list.end(), inherited.begin(), inherited.end()));
    }
    for (std::size_t leaf = 0; leaf < coarse.size(); ++leaf)
      for (const std::uint32_t f : merged.facets_of(leaf)) {
        bool listed = false;
        for (std::size_t in = leaves_in(fine, coarse.key(leaf)).begin; in < leaves_in(fine, coarse.key(leaf)).end; ++in)
          listed = listed || std::binary_search(grid.facets_of(in).begin(), grid.facets_of(in).end(), f);
        ASSERT_TRUE(listed);
      }
  });
}

}  // namespace
}  // namespace burnish
