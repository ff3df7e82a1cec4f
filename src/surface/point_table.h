// PointTable: distinct coordinate triples, numbered in the order of their first appearance.
//
// Open addressing with linear probing, at most half full. A slot holds the number of its point and 32
// bits of the hash, so that a probe reads a point's coordinates only when it almost certainly is equal.
// Keys are looked up long after `prefetch` was called for them: the misses of several keys overlap.
#pragma once

#include <bit>
#include <cstdint>
#include <utility>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish {

__extension__ using Uint128 = unsigned __int128;

// A hash of the coordinates, equal for -0 and +0. All 64 bits are well mixed.
inline std::uint64_t hash_of(const Vec3& p) {
  const auto bits = [](double v) { return std::bit_cast<std::uint64_t>(v + 0.0); };
  const auto mix = [](std::uint64_t a, std::uint64_t b) {
    const auto wide = static_cast<Uint128>(a) * b;
    return static_cast<std::uint64_t>(wide) ^ static_cast<std::uint64_t>(wide >> 64);
  };
  const std::uint64_t xy = mix(bits(p.x) ^ 0x9e3779b97f4a7c15u, bits(p.y) ^ 0xbf58476d1ce4e5b9u);
  return mix(xy ^ 0x94d049bb133111ebu, bits(p.z) ^ 0xd6e8feb86659fd93u);
}

class PointTable {
 public:
  explicit PointTable(std::size_t expected_points);

  void prefetch(std::uint64_t hash) const { __builtin_prefetch(&slots_[hash & mask_]); }

  // The number of the point equal to `p`, which is added if there is none. `hash` is hash_of(p).
  std::uint32_t insert(const Vec3& p, std::uint64_t hash) {
    const std::uint32_t tag = static_cast<std::uint32_t>(hash >> 32);
    std::uint64_t at = hash & mask_;
    while (slots_[at].number != kFree) {
      if (slots_[at].tag == tag && points_[slots_[at].number] == p) return slots_[at].number;
      at = (at + 1) & mask_;
    }
    slots_[at] = {tag, static_cast<std::uint32_t>(points_.size())};
    points_.push_back(p);
    if (2 * points_.size() > slots_.size()) grow();
    return static_cast<std::uint32_t>(points_.size() - 1);
  }
  std::uint32_t insert(const Vec3& p) { return insert(p, hash_of(p)); }

  // The number of the point equal to `p`, or kFree.
  std::uint32_t find(const Vec3& p) const;

  const std::vector<Vec3>& points() const { return points_; }
  std::vector<Vec3> take_points() { return std::move(points_); }

  static constexpr std::uint32_t kFree = 0xffffffffu;

 private:
  struct Slot {
    std::uint32_t tag = 0;
    std::uint32_t number = kFree;
  };

  void grow();

  std::vector<Slot> slots_;
  std::uint64_t mask_ = 0;
  std::vector<Vec3> points_;
};

}  // namespace burnish
