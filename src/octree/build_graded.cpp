// The coarsest balanced octree with octants of given levels, bottom-up on sorted sets of octants that have children.
#include <algorithm>
#include <array>
#include <cassert>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/octree/octree.h"
#include "counts.h"

namespace burnish {
namespace {

using Octants = std::vector<std::uint64_t>;  // interleaved positions in units of one level's octants

constexpr std::size_t kGrain = 8192;

void sort_unique(Octants& octants) {
  parallel_sort(octants);
  octants.erase(std::unique(octants.begin(), octants.end()), octants.end());
}

Octants concatenated(std::vector<Octants>& parts) {
  Octants all;
  std::size_t total = 0;
  for (const Octants& part : parts) total += part.size();
  all.reserve(total);
  for (Octants& part : parts) {
    all.insert(all.end(), part.begin(), part.end());
    Octants().swap(part);
  }
  return all;
}

// The parents of the 27 octants around one: at most 8, per axis those of p - 1 and p + 1. [T-OCT-2]
void add_parents_around(std::uint64_t octant, std::uint32_t side, Octants& parents) {
  const morton::Position p = morton::deinterleave(octant);
  const auto range = [side](std::uint32_t at) {
    return std::array<std::uint32_t, 2>{(at == 0 ? 0 : at - 1) / 2, std::min(at + 1, side - 1) / 2};
  };
  const auto rx = range(p.x), ry = range(p.y), rz = range(p.z);
  for (std::uint32_t z = rz[0]; z <= rz[1]; ++z)
    for (std::uint32_t y = ry[0]; y <= ry[1]; ++y)
      for (std::uint32_t x = rx[0]; x <= rx[1]; ++x) parents.push_back(morton::interleave({x, y, z}));
}

// One level up, the octants around those of `octants`, which are sorted; duplicates are possible.
Octants parents_around(const Octants& octants, std::uint32_t side) {
  std::vector<Octants> parts((octants.size() + kGrain - 1) / kGrain);
  parallel_ranges(octants.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    Octants& part = parts[begin / kGrain];
    for (std::size_t i = begin; i < end; ++i) add_parents_around(octants[i], side, part);
    std::sort(part.begin(), part.end());
    part.erase(std::unique(part.begin(), part.end()), part.end());
  });
  return concatenated(parts);
}

// refined[l]: the octants of level l that have children, sorted. [T-OCT-5]
std::vector<Octants> refined_octants(int depth, const std::vector<std::uint64_t>& keys) {
  const auto levels = static_cast<std::size_t>(depth) + 1;
  std::vector<Octants> refined(levels);
  for (const std::uint64_t key : keys) {
    const int l = morton::level(key);
    assert(key != 0 && l <= depth);
    if (l < depth) refined[static_cast<std::size_t>(l) + 1].push_back(key >> (3 * l + 4));
  }
  for (std::size_t l = 1; l < levels; ++l) {
    if (l > 1) {
      const Octants around = parents_around(refined[l - 1], 1u << (static_cast<std::size_t>(depth) + 1 - l));
      refined[l].insert(refined[l].end(), around.begin(), around.end());
    }
    sort_unique(refined[l]);
  }
  return refined;
}

// Children of `parents` that have no children themselves; both lists are sorted, and so is the result.
void add_leaves(const Octants& parents, const Octants& with_children, int level, std::vector<std::uint64_t>& keys) {
  auto next = with_children.begin();
  for (const std::uint64_t parent : parents)
    for (std::uint64_t child = 0; child < 8; ++child) {
      const std::uint64_t octant = parent << 3 | child;
      while (next != with_children.end() && *next < octant) ++next;
      if (next == with_children.end() || *next != octant) keys.push_back(morton::key(octant, level));
    }
}

}  // namespace

Octree Octree::build_graded(int depth, std::vector<std::uint64_t> keys) {
  const std::vector<Octants> refined = refined_octants(depth, std::exchange(keys, {}));
  Octree tree;
  tree.depth_ = depth;
  tree.keys_.clear();
  if (refined.back().empty()) tree.keys_.push_back(morton::key(0, depth));
  for (int l = 0; l < depth; ++l)
    add_leaves(refined[static_cast<std::size_t>(l) + 1], refined[static_cast<std::size_t>(l)], l, tree.keys_);
  require_blocks(tree.keys_.size());
  parallel_sort(tree.keys_);
  tree.link();
  return tree;
}

}  // namespace burnish
