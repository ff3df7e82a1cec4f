#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <random>
#include <set>

#include "burnish/core/parallel.h"
#include "burnish/octree/octree.h"
#include "support/random_octree.h"

namespace burnish {
namespace {

using namespace test;
using Keys = std::vector<std::uint64_t>;

std::uint64_t blocks_of(std::uint64_t key) { return std::uint64_t{1} << 3 * morton::level(key); }

// Whether `inner` is `outer` or lies in it.
bool lies_in(std::uint64_t inner, std::uint64_t outer) {
  const std::uint64_t reach = blocks_of(outer) - 1;
  return outer - reach <= inner && inner <= outer + reach;
}

// Whether the closed cubes meet.
bool touch(std::uint64_t a, std::uint64_t b) {
  const morton::Position p = morton::corner(a), q = morton::corner(b);
  const std::uint32_t sa = 1u << morton::level(a), sb = 1u << morton::level(b);
  const auto meet = [&](std::uint32_t x, std::uint32_t y) { return x <= y + sb && y <= x + sa; };
  return meet(p.x, q.x) && meet(p.y, q.y) && meet(p.z, q.z);
}

Keys keys_of(const Octree& tree) {
  Keys keys;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) keys.push_back(tree.key(leaf));
  return keys;
}

Keys random_keys(std::mt19937& random, int depth, int most) {
  Keys keys;
  for (const std::uint64_t block : random_finest(random, depth, most)) {
    // Low levels more often, so that nested keys and steep gradings both occur.
    const int level = static_cast<int>(std::min(random() % static_cast<unsigned>(depth + 1), random() % static_cast<unsigned>(depth + 1)));
    keys.push_back(morton::key(block >> 3 * level, level));
  }
  return keys;
}

// The coarsest balanced tree by definition: split what holds a smaller key, then what touches too small a leaf.
Keys coarsest_balanced(int depth, const Keys& keys) {
  std::set<std::uint64_t> leaves{morton::key(0, depth)};
  const auto must_split = [&](std::uint64_t leaf) {
    const int level = morton::level(leaf);
    return std::any_of(keys.begin(), keys.end(), [&](std::uint64_t key) { return key != leaf && lies_in(key, leaf) && morton::level(key) < level; }) ||
           std::any_of(leaves.begin(), leaves.end(), [&](std::uint64_t other) { return morton::level(other) < level - 1 && touch(leaf, other); });
  };
  for (bool changed = true; changed;) {
    changed = false;
    for (const std::uint64_t leaf : Keys(leaves.begin(), leaves.end())) {
      if (!must_split(leaf)) continue;
      const int l = morton::level(leaf);
      leaves.erase(leaf);
      for (std::uint64_t child = 0; child < 8; ++child) leaves.insert(morton::key((leaf >> (3 * l + 1)) << 3 | child, l - 1));
      changed = true;
    }
  }
  return {leaves.begin(), leaves.end()};
}

TEST(GradedOctreeProperty, IsTheCoarsestBalancedTree) {
  for (unsigned seed = 1; seed <= 150; ++seed) {
    std::mt19937 random(seed);
    const int depth = static_cast<int>(seed % 5);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth);
    const Keys keys = random_keys(random, depth, 8);
    ASSERT_EQ(keys_of(Octree::build_graded(depth, keys)), coarsest_balanced(depth, keys));
  }
}

TEST(GradedOctreeProperty, KeysAreLeavesOrDividedAndNeighboursDifferByOneLevel) {
  for (unsigned seed = 1; seed <= 100; ++seed) {
    std::mt19937 random(seed);
    const int depth = 3 + static_cast<int>(random() % 5);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth);
    const Keys keys = random_keys(random, depth, 40);
    const Octree tree = Octree::build_graded(depth, keys);
    std::uint64_t volume = 0;
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
      volume += blocks_of(tree.key(leaf));
      for (int d = 0; d < kDirections; ++d)
        for (const std::uint32_t other : tree.neighbors(leaf, d)) ASSERT_LE(std::abs(tree.level(leaf) - tree.level(other)), 1);
    }
    ASSERT_EQ(volume, std::uint64_t{1} << 3 * depth);
    for (const std::uint64_t key : keys) {
      const std::uint32_t leaf = tree.find(morton::corner(key));
      ASSERT_TRUE(lies_in(tree.key(leaf), key));
    }
  }
}

// No eight sibling leaves can be merged: a key lies in their parent, or a leaf beside it is two levels finer.
TEST(GradedOctreeProperty, NothingCanBeMerged) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    std::mt19937 random(seed);
    const int depth = 3 + static_cast<int>(random() % 3);
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth);
    const Keys keys = random_keys(random, depth, 12);
    const Octree tree = Octree::build_graded(depth, keys);
    for (std::uint32_t leaf = 0; leaf + 7 < tree.size(); ++leaf) {
      const std::uint64_t parent = morton::parent(tree.key(leaf));
      if (tree.level(leaf) == depth || tree.level(leaf + 7) != tree.level(leaf) || morton::parent(tree.key(leaf + 7)) != parent) continue;
      const bool asked_for = std::any_of(keys.begin(), keys.end(), [&](std::uint64_t key) { return key != parent && lies_in(key, parent); });
      bool finer_beside = false;
      for (std::uint32_t child = leaf; child < leaf + 8; ++child)
        for (int d = 0; d < kDirections; ++d) finer_beside = finer_beside || tree.neighbor_kind(child, d) == NeighborKind::finer;
      ASSERT_TRUE(asked_for || finer_beside) << "leaf " << leaf;
    }
  }
}

TEST(GradedOctreeProperty, BuildIsTheCaseOfFinestKeys) {
  for (unsigned seed = 1; seed <= 60; ++seed) {
    SCOPED_TRACE(testing::Message() << "seed " << seed);
    std::mt19937 random(seed);
    const int depth = static_cast<int>(random() % 7);
    const Keys finest = random_finest(random, depth, 30);
    Keys keys;
    for (const std::uint64_t block : finest) keys.push_back(morton::key(block, 0));
    ASSERT_EQ(keys_of(Octree::build_graded(depth, keys)), keys_of(Octree::build(depth, finest)));
  }
}

TEST(GradedOctreeProperty, SameTreeForAnyOrderAndNumberOfThreads) {
  std::mt19937 random(5);
  Keys keys;
  for (int i = 0; i < 30'000; ++i) {
    const int level = static_cast<int>(random() % 3);
    keys.push_back(morton::key(random() % (std::uint64_t{1} << 3 * (7 - level)), level));
  }
  const auto build = [&](int threads) {
    const ThreadLimit limit(threads);
    return keys_of(Octree::build_graded(7, keys));
  };
  const Keys one = build(1);
  std::shuffle(keys.begin(), keys.end(), random);
  EXPECT_EQ(build(4), one);
}

TEST(GradedOctreeProperty, WithoutKeysOrWithTheRootIsOneLeaf) {
  EXPECT_EQ(Octree::build_graded(5, {}).size(), 1u);
  EXPECT_EQ(Octree::build_graded(5, {morton::key(0, 5)}).size(), 1u);
  EXPECT_EQ(Octree::build_graded(0, {morton::key(0, 0)}).size(), 1u);
  EXPECT_EQ(Octree::build_graded(5, {morton::key(3, 4)}).size(), 8u);
}

}  // namespace
}  // namespace burnish
