// Octree: a linear octree of blocks, balanced 2:1 over faces, edges and corners.
//
// The leaves tile a cube of 2^depth finest blocks a side. They are stored as one sorted array of Morton
// keys, so a leaf is an index and iteration runs along the Morton curve. The octree knows keys and
// neighbours, nothing of what a leaf carries: fields are arrays beside it (octree/field.h).
//
// Guarantees: the leaves are disjoint and cover the cube; two leaves that touch, be it in one corner,
// differ by at most one level; every neighbour link has its reverse.
//
// The balance works bottom-up on sorted sets of parents: the octants of level l that are refined force
// the parents of their 26 neighbours to be refined at level l + 1. Cost: two sorts per level.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/octree/morton.h"

namespace burnish {

enum class NeighborKind : std::uint8_t {
  same,     // a leaf of the same level
  coarser,  // a leaf one level up
  finer,    // 4, 2 or 1 leaves one level down: across a face, an edge, a corner
  wall,     // the end of the domain
};

// Directions are numbered 0..26 as (dx + 1) + 3 (dy + 1) + 9 (dz + 1); 13 is the leaf itself.
inline constexpr int kDirections = 27;
inline constexpr int kSelf = 13;
constexpr int direction(int dx, int dy, int dz) { return (dx + 1) + 3 * (dy + 1) + 9 * (dz + 1); }
constexpr std::array<int, 3> offset_of(int direction) {
  return {direction % 3 - 1, direction / 3 % 3 - 1, direction / 9 - 1};
}

class Octree {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // One block that is the whole domain.
  Octree();

  // The coarsest balanced octree of 2^depth finest blocks a side (depth <= morton::kMaxDepth) in which
  // every block of `finest` (interleaved positions, any order, duplicates allowed) is a leaf of level 0.
  // Throws Error{memory_limit} beyond 2^32 - 2 leaves.
  static Octree build(int depth, std::vector<std::uint64_t> finest);

  // The same for octants of any level: the coarsest balanced octree in which every octant of `keys` (Morton keys of level
  // <= depth, any order, duplicated and nested ones allowed) is a leaf or is divided further. `build` is the case of
  // keys of level 0.
  static Octree build_graded(int depth, std::vector<std::uint64_t> keys);

  int depth() const { return depth_; }
  std::size_t size() const { return keys_.size(); }
  // Finest blocks along a side of the domain.
  std::uint32_t side() const { return 1u << depth_; }

  std::uint64_t key(std::size_t leaf) const { return keys_[leaf]; }
  int level(std::size_t leaf) const { return morton::level(keys_[leaf]); }
  // Lower corner in finest blocks.
  morton::Position corner(std::size_t leaf) const { return morton::corner(keys_[leaf]); }

  // The leaf that holds the finest block at `p` (which must lie in the domain). One binary search.
  std::uint32_t find(const morton::Position& p) const;
  // The same, fast if that leaf is `near` or touches it.
  std::uint32_t find_near(std::uint32_t near, const morton::Position& p) const;
  // The leaf with exactly this key, or kNone.
  std::uint32_t find_key(std::uint64_t key) const;

  NeighborKind neighbor_kind(std::size_t leaf, int direction) const {
    return static_cast<NeighborKind>(links_[leaf * kDirections + static_cast<std::size_t>(direction)] >> 62);
  }
  // The neighbour of kind `same` or `coarser`.
  std::uint32_t neighbor(std::size_t leaf, int direction) const {
    return static_cast<std::uint32_t>(links_[leaf * kDirections + static_cast<std::size_t>(direction)]);
  }
  // All leaves that touch this one in that direction, in Morton order: none at a wall, one of the same
  // level or coarser, up to four finer ones.
  std::span<const std::uint32_t> neighbors(std::size_t leaf, int direction) const;

  // Heap bytes held.
  std::size_t bytes() const;

 private:
  void link();
  std::uint64_t link_of(std::size_t leaf, int direction, std::vector<std::uint32_t>& finer) const;

  int depth_ = 0;
  std::vector<std::uint64_t> keys_;
  // Per leaf and direction: kind in the top two bits; below it the leaf (same, coarser), or for `finer`
  // the count in bits 32..34 and the place of the first in finer_.
  std::vector<std::uint64_t> links_;
  std::vector<std::uint32_t> finer_;
  // Open-addressing table of leaf indices by key; a power of two in size.
  std::vector<std::uint32_t> table_;
};

}  // namespace burnish
