#include "burnish/octree/octree.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>
#include <set>

#include "burnish/core/parallel.h"
#include "support/random_octree.h"

namespace burnish {
namespace {

using namespace test;
using morton::Position;

// A leaf's cube, in finest blocks.
struct Cube {
  std::array<std::int64_t, 3> low, high;

  explicit Cube(std::uint64_t key) {
    const Position c = morton::corner(key);
    low = {c.x, c.y, c.z};
    for (std::size_t a = 0; a < 3; ++a) high[a] = low[a] + (std::int64_t{1} << morton::level(key));
  }
  bool touches(const Cube& b) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (low[a] > b.high[a] || high[a] < b.low[a]) return false;
    return true;
  }
  bool holds(const Position& p) const {
    const std::array<std::int64_t, 3> at{p.x, p.y, p.z};
    for (std::size_t a = 0; a < 3; ++a)
      if (at[a] < low[a] || at[a] >= high[a]) return false;
    return true;
  }
};

// Runs check(tree, finest) on random trees of depth 0 to `deepest`; a failure names the seed.
template <class Check>
void for_random_trees(unsigned seeds, int deepest, int most, Check&& check) {
  for (unsigned seed = 1; seed <= seeds; ++seed) {
    std::mt19937 random(seed);
    const int depth = static_cast<int>(random() % static_cast<unsigned>(deepest + 1));
    SCOPED_TRACE(testing::Message() << "seed " << seed << ", depth " << depth);
    const std::vector<std::uint64_t> finest = random_finest(random, depth, most);
    check(Octree::build(depth, finest), finest, random);
    if (testing::Test::HasFatalFailure()) return;
  }
}

// The coarsest balanced tree by definition: split what holds a finest block, then what touches too small a leaf.
std::vector<std::uint64_t> coarsest_balanced(int depth, const std::vector<std::uint64_t>& finest) {
  std::set<std::uint64_t> leaves{morton::key(0, depth)};
  const auto must_split = [&](std::uint64_t key) {
    const int level = morton::level(key);
    if (level == 0) return false;
    const Cube cube(key);
    for (const std::uint64_t block : finest)
      if (cube.holds(morton::deinterleave(block))) return true;
    return std::any_of(leaves.begin(), leaves.end(), [&](std::uint64_t other) {
      return morton::level(other) < level - 1 && cube.touches(Cube(other));
    });
  };
  for (bool changed = true; changed;) {
    changed = false;
    const std::vector<std::uint64_t> before(leaves.begin(), leaves.end());
    for (const std::uint64_t key : before) {
      if (!must_split(key)) continue;
      const int l = morton::level(key);
      leaves.erase(key);
      for (std::uint64_t child = 0; child < 8; ++child)
        leaves.insert(morton::key((key >> (3 * l + 1)) << 3 | child, l - 1));
      changed = true;
    }
  }
  return {leaves.begin(), leaves.end()};
}

std::vector<std::uint64_t> keys_of(const Octree& tree) {
  std::vector<std::uint64_t> keys;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) keys.push_back(tree.key(leaf));
  return keys;
}

TEST(MortonProperty, SpreadPutsBitKAt3K) {
  for (int k = 0; k < morton::kMaxDepth; ++k) EXPECT_EQ(morton::spread(1u << k), std::uint64_t{1} << 3 * k);
  EXPECT_EQ(morton::spread(0xfffff), 0x1249249249249249ull & ((std::uint64_t{1} << 60) - 1));
  EXPECT_EQ(morton::spread(0x100000), 0u);
}

TEST(MortonProperty, RoundTripsUpTo20Bits) {
  std::mt19937_64 random(7);
  for (int i = 0; i < 20'000; ++i) {
    const auto any = [&] { return static_cast<std::uint32_t>(random() & 0xfffff) >> (random() % 20); };
    const Position p{any(), any(), any()};
    ASSERT_EQ(morton::compact(morton::spread(p.x)), p.x);
    ASSERT_EQ(morton::compact(morton::spread(p.x) | ~0x1249249249249249ull), p.x) << "foreign bits must not matter";
    const std::uint64_t m = morton::interleave(p);
    ASSERT_EQ(morton::deinterleave(m), p);
    const int level = static_cast<int>(random() % 20);
    const Position at{p.x >> level, p.y >> level, p.z >> level};
    const std::uint64_t key = morton::key(morton::interleave(at), level);
    ASSERT_EQ(morton::level(key), level);
    ASSERT_EQ(morton::corner(key), (Position{at.x << level, at.y << level, at.z << level}));
    if (level < morton::kMaxDepth - 1) {
      ASSERT_EQ(morton::parent(key), morton::key(morton::interleave({at.x / 2, at.y / 2, at.z / 2}), level + 1));
    }
  }
}

TEST(OctreeProperty, LeavesAreDisjointAndCoverTheCube) {
  for_random_trees(300, 6, 30, [](const Octree& tree, const auto&, auto&) {
    std::uint64_t volume = 0, next = 1;  // keys of finest blocks are odd: 1, 3, 5, ...
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
      const std::uint64_t blocks = std::uint64_t{1} << 3 * tree.level(leaf);
      ASSERT_EQ(tree.key(leaf) - (blocks - 1), next) << "leaf " << leaf << " does not begin where the last one ended";
      next = tree.key(leaf) + (blocks - 1) + 2;
      volume += blocks;
    }
    ASSERT_EQ(volume, std::uint64_t{1} << 3 * tree.depth());
  });
}

TEST(OctreeProperty, RequestedBlocksAreFinestLeaves) {
  for_random_trees(300, 6, 30, [](const Octree& tree, const auto& finest, auto&) {
    for (const std::uint64_t block : finest) {
      const std::uint32_t leaf = tree.find_key(morton::key(block, 0));
      ASSERT_NE(leaf, Octree::kNone);
      ASSERT_EQ(tree.level(leaf), 0);
      ASSERT_EQ(tree.corner(leaf), morton::deinterleave(block));
    }
  });
}

TEST(OctreeProperty, IsTheCoarsestBalancedTree) {
  for_random_trees(40, 4, 5, [](const Octree& tree, const auto& finest, auto&) {
    ASSERT_EQ(keys_of(tree), coarsest_balanced(tree.depth(), finest));
  });
}

// By brute force over all pairs: touching leaves differ by one level at most and know each other.
TEST(OctreeProperty, BalancedOverFacesEdgesAndCornersAndLinkedBothWays) {
  for_random_trees(60, 6, 6, [](const Octree& tree, const auto&, auto&) {
    const auto knows = [&](std::size_t a, std::size_t b) {
      for (int dir = 0; dir < kDirections; ++dir) {
        const auto others = tree.neighbors(a, dir);
        if (dir != kSelf && std::find(others.begin(), others.end(), b) != others.end()) return true;
      }
      return false;
    };
    std::vector<Cube> cubes;
    for (const std::uint64_t key : keys_of(tree)) cubes.emplace_back(key);
    for (std::size_t a = 0; a < tree.size(); ++a)
      for (std::size_t b = 0; b < a; ++b) {
        const bool touch = cubes[a].touches(cubes[b]);
        if (touch) {
          ASSERT_LE(std::abs(tree.level(a) - tree.level(b)), 1) << "leaves " << a << " and " << b;
          ASSERT_TRUE(knows(a, b) && knows(b, a)) << "leaves " << a << " and " << b;
        }
      }
  });
}

TEST(OctreeProperty, EveryLinkHasItsReverse) {
  for_random_trees(200, 6, 30, [](const Octree& tree, const auto&, auto&) {
    for (std::uint32_t leaf = 0; leaf < tree.size(); ++leaf)
      for (int dir = 0; dir < kDirections; ++dir) {
        if (dir == kSelf) {
          ASSERT_EQ(tree.neighbor(leaf, dir), leaf);
          continue;
        }
        const int back = kDirections - 1 - dir;
        const auto others = tree.neighbors(leaf, dir);
        const auto [dx, dy, dz] = offset_of(dir);
        switch (tree.neighbor_kind(leaf, dir)) {
          case NeighborKind::wall: ASSERT_TRUE(others.empty()); break;
          case NeighborKind::same:
            ASSERT_EQ(others.size(), 1u);
            ASSERT_EQ(others[0], tree.neighbor(leaf, dir));
            ASSERT_EQ(tree.level(others[0]), tree.level(leaf));
            ASSERT_EQ(tree.neighbor(others[0], back), leaf);
            break;
          case NeighborKind::finer:
            ASSERT_EQ(others.size(), std::size_t{1} << (3 - std::abs(dx) - std::abs(dy) - std::abs(dz)));
            ASSERT_TRUE(std::is_sorted(others.begin(), others.end()));
            for (const std::uint32_t fine : others) {
              ASSERT_EQ(tree.level(fine), tree.level(leaf) - 1);
              ASSERT_EQ(tree.neighbor_kind(fine, back), NeighborKind::coarser);
              ASSERT_EQ(tree.neighbor(fine, back), leaf);
            }
            break;
          case NeighborKind::coarser: {
            ASSERT_EQ(others.size(), 1u);
            const std::uint32_t coarse = tree.neighbor(leaf, dir);
            ASSERT_EQ(others[0], coarse);
            ASSERT_EQ(tree.level(coarse), tree.level(leaf) + 1);
            bool found = false;  // beside an edge the coarse leaf may be across a face too: some direction has it
            for (int d = 0; d < kDirections && !found; ++d) {
              const auto fine = tree.neighbors(coarse, d);
              found = d != kSelf && std::find(fine.begin(), fine.end(), leaf) != fine.end();
            }
            ASSERT_TRUE(found) << "leaf " << leaf << ", direction " << dir;
          }
        }
      }
  });
}

// The kind of a link is what a search for the block across the face, edge or corner says.
TEST(OctreeProperty, LinksAgreeWithFind) {
  for_random_trees(200, 6, 30, [](const Octree& tree, const auto&, auto&) {
    const std::int64_t side = tree.side();
    for (std::uint32_t leaf = 0; leaf < tree.size(); ++leaf)
      for (int dir = 0; dir < kDirections; ++dir) {
        const auto offset = offset_of(dir);
        const Cube cube(tree.key(leaf));
        std::array<std::int64_t, 3> at{};
        bool outside = false;
        for (std::size_t a = 0; a < 3; ++a) {
          at[a] = offset[a] > 0 ? cube.high[a] : offset[a] < 0 ? cube.low[a] - 1 : cube.low[a];
          outside = outside || at[a] < 0 || at[a] >= side;
        }
        ASSERT_EQ(tree.neighbor_kind(leaf, dir) == NeighborKind::wall, outside);
        if (outside) continue;
        const auto found = tree.find({static_cast<std::uint32_t>(at[0]), static_cast<std::uint32_t>(at[1]), static_cast<std::uint32_t>(at[2])});
        const auto others = tree.neighbors(leaf, dir);
        ASSERT_NE(std::find(others.begin(), others.end(), found), others.end());
      }
  });
}

TEST(OctreeProperty, FindAgreesWithBruteForce) {
  for_random_trees(60, 6, 20, [](const Octree& tree, const auto&, std::mt19937& random) {
    std::vector<Cube> cubes;
    for (const std::uint64_t key : keys_of(tree)) cubes.emplace_back(key);
    for (int i = 0; i < 200; ++i) {
      const auto any = [&] { return static_cast<std::uint32_t>(random() % tree.side()); };
      const Position p{any(), any(), any()};
      const auto holder = std::find_if(cubes.begin(), cubes.end(), [&](const Cube& c) { return c.holds(p); });
      ASSERT_EQ(tree.find(p), static_cast<std::uint32_t>(holder - cubes.begin()));
    }
    for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
      ASSERT_EQ(tree.find_key(tree.key(leaf)), leaf);
      if (tree.level(leaf) < tree.depth()) {
        ASSERT_EQ(tree.find_key(morton::parent(tree.key(leaf))), Octree::kNone);
      }
    }
  });
}

TEST(OctreeProperty, DeepestTreeHasOneChainOfRefinements) {
  const std::uint32_t last = (1u << morton::kMaxDepth) - 1;
  const Octree tree = Octree::build(morton::kMaxDepth, {morton::interleave({last, last, last})});
  // A block in a corner: each level splits one octant of the last, and the balance asks for no more.
  EXPECT_EQ(tree.size(), 1u + 7u * morton::kMaxDepth);
  std::uint64_t volume = 0;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) volume += std::uint64_t{1} << 3 * tree.level(leaf);
  EXPECT_EQ(volume, std::uint64_t{1} << 60);
  EXPECT_EQ(tree.level(tree.find({last, last, last})), 0);
  EXPECT_EQ(tree.level(tree.find({0, 0, 0})), morton::kMaxDepth - 1);
}

TEST(OctreeProperty, WithoutFinestBlocksIsOneLeaf) {
  for (const int depth : {0, 1, 5, morton::kMaxDepth}) {
    const Octree tree = Octree::build(depth, {});
    ASSERT_EQ(tree.size(), 1u);
    EXPECT_EQ(tree.level(0), depth);
    EXPECT_EQ(tree.find({tree.side() - 1, 0, 0}), 0u);
  }
}

TEST(OctreeProperty, SameTreeForAnyOrderAndNumberOfThreads) {
  std::mt19937 random(11);
  std::vector<std::uint64_t> finest;
  for (int i = 0; i < 3000; ++i) finest.push_back(random() % (std::uint64_t{1} << 18));
  std::vector<std::uint64_t> keys;
  {
    const ThreadLimit one(1);
    keys = keys_of(Octree::build(6, finest));
  }
  const ThreadLimit four(4);
  std::shuffle(finest.begin(), finest.end(), random);
  EXPECT_EQ(keys_of(Octree::build(6, finest)), keys);
}

}  // namespace
}  // namespace burnish
