#include "burnish/octree/octree.h"

#include <algorithm>
#include <utility>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

using morton::Position;

constexpr std::size_t kLinkGrain = 2048;

constexpr std::uint64_t hash_of(std::uint64_t key) {
  key *= 0x9e3779b97f4a7c15ull;
  return key ^ key >> 29;
}

constexpr std::uint64_t packed(NeighborKind kind, std::uint64_t value) {
  return static_cast<std::uint64_t>(kind) << 62 | value;
}

}  // namespace

Octree::Octree() : keys_{morton::key(0, 0)} { link(); }

Octree Octree::build(int depth, std::vector<std::uint64_t> finest) {
  for (std::uint64_t& block : finest) block = morton::key(block, 0);
  return build_graded(depth, std::move(finest));
}

std::uint32_t Octree::find_key(std::uint64_t key) const {
  const std::size_t mask = table_.size() - 1;
  for (std::size_t slot = hash_of(key) & mask;; slot = (slot + 1) & mask) {
    const std::uint32_t leaf = table_[slot];
    if (leaf == kNone || keys_[leaf] == key) return leaf;
  }
}

std::uint32_t Octree::find(const Position& p) const {
  const std::uint64_t finest = morton::key(morton::interleave(p), 0);
  // The leaf that holds `finest` has the last key whose subtree does not begin behind it.
  auto it = std::upper_bound(keys_.begin(), keys_.end(), finest);
  const auto holds = [&](std::uint64_t key) {
    const std::uint64_t reach = (std::uint64_t{1} << (3 * morton::level(key))) - 1;
    return key - reach <= finest && finest <= key + reach;
  };
  if (it == keys_.end() || !holds(*it)) --it;
  return static_cast<std::uint32_t>(it - keys_.begin());
}

std::uint32_t Octree::find_near(std::uint32_t near, const Position& p) const {
  const auto holds = [&](std::uint32_t leaf) {
    const int l = level(leaf);
    const Position c = corner(leaf);
    return (p.x ^ c.x) >> l == 0 && (p.y ^ c.y) >> l == 0 && (p.z ^ c.z) >> l == 0;
  };
  const Position c = corner(near);
  const std::uint32_t size = 1u << level(near);
  const auto side = [&](std::uint32_t x, std::uint32_t low) { return x < low ? -1 : x - low >= size ? 1 : 0; };
  const int dir = direction(side(p.x, c.x), side(p.y, c.y), side(p.z, c.z));
  if (dir == kSelf) return near;
  const NeighborKind kind = neighbor_kind(near, dir);
  if (kind == NeighborKind::same || kind == NeighborKind::coarser) {
    const std::uint32_t other = neighbor(near, dir);
    return holds(other) ? other : find(p);
  }
  for (const std::uint32_t other : neighbors(near, dir))
    if (holds(other)) return other;
  return find(p);
}

std::uint64_t Octree::link_of(std::size_t leaf, int dir, std::vector<std::uint32_t>& finer) const {
  const int l = level(leaf);
  const Position p = morton::deinterleave(keys_[leaf] >> (3 * l + 1));
  const auto [dx, dy, dz] = offset_of(dir);
  const std::uint32_t side_here = 1u << (depth_ - l);
  const Position q{p.x + static_cast<std::uint32_t>(dx), p.y + static_cast<std::uint32_t>(dy),
                   p.z + static_cast<std::uint32_t>(dz)};
  if (q.x >= side_here || q.y >= side_here || q.z >= side_here) return packed(NeighborKind::wall, kNone);
  const std::uint64_t m = morton::interleave(q);
  if (const auto same = find_key(morton::key(m, l)); same != kNone) return packed(NeighborKind::same, same);
  if (const auto up = find_key(morton::key(m >> 3, l + 1)); up != kNone) return packed(NeighborKind::coarser, up);
  const std::uint64_t first = finer.size();
  std::uint64_t count = 0;
  for (std::uint64_t child = 0; child < 8; ++child) {
    // Of the neighbour's children, those on the side that faces this leaf.
    const bool faces = (dx == 0 || (dx > 0) == !(child & 1)) && (dy == 0 || (dy > 0) == !(child & 2)) &&
                       (dz == 0 || (dz > 0) == !(child & 4));
    if (!faces) continue;
    finer.push_back(find_key(morton::key(m << 3 | child, l - 1)));
    ++count;
  }
  return packed(NeighborKind::finer, count << 32 | first);
}

void Octree::link() {
  table_.assign(std::bit_ceil(keys_.size() * 2 + 2), kNone);
  const std::size_t mask = table_.size() - 1;
  for (std::size_t i = 0; i < keys_.size(); ++i) {
    std::size_t slot = hash_of(keys_[i]) & mask;
    while (table_[slot] != kNone) slot = (slot + 1) & mask;
    table_[slot] = static_cast<std::uint32_t>(i);
  }
  links_.resize(keys_.size() * kDirections);
  // Every chunk numbers its finer neighbours from 0; then its links move to where these come to stand.
  std::vector<std::vector<std::uint32_t>> finer((keys_.size() + kLinkGrain - 1) / kLinkGrain);
  parallel_ranges(keys_.size(), kLinkGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i)
      for (int d = 0; d < kDirections; ++d)
        links_[i * kDirections + static_cast<std::size_t>(d)] =
            d == kSelf ? packed(NeighborKind::same, i) : link_of(i, d, finer[begin / kLinkGrain]);
  });
  std::vector<std::size_t> first(finer.size());
  for (std::size_t c = 0; c < finer.size(); ++c) first[c] = finer[c].size();
  finer_.resize(exclusive_scan_in_place(first));
  parallel_ranges(keys_.size(), kLinkGrain, [&](std::size_t begin, std::size_t end) {
    const std::size_t c = begin / kLinkGrain;
    std::copy(finer[c].begin(), finer[c].end(), finer_.begin() + static_cast<std::ptrdiff_t>(first[c]));
    for (std::size_t i = begin * kDirections; i < end * kDirections; ++i)
      if (static_cast<NeighborKind>(links_[i] >> 62) == NeighborKind::finer) links_[i] += first[c];
  });
}

std::span<const std::uint32_t> Octree::neighbors(std::size_t leaf, int dir) const {
  const std::uint64_t& entry = links_[leaf * kDirections + static_cast<std::size_t>(dir)];
  switch (neighbor_kind(leaf, dir)) {
    case NeighborKind::wall: return {};
    case NeighborKind::finer:
      return {finer_.data() + static_cast<std::uint32_t>(entry), static_cast<std::size_t>(entry >> 32 & 7)};
    default: break;
  }
  const std::uint32_t other = static_cast<std::uint32_t>(entry);
  // A view of one index needs storage that outlives the call: the hash table holds every leaf's.
  std::size_t slot = hash_of(keys_[other]) & (table_.size() - 1);
  while (table_[slot] != other) slot = (slot + 1) & (table_.size() - 1);
  return {&table_[slot], 1};
}

std::size_t Octree::bytes() const {
  return keys_.capacity() * 8 + links_.capacity() * 8 + finer_.capacity() * 4 + table_.capacity() * 4;
}

}  // namespace burnish
