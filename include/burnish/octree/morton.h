// Morton keys of octants: where an octant is and how large, in one sortable 64-bit number.
//
// An octant of level l is a cube of 2^l x 2^l x 2^l finest blocks. Its key is
//
//     key = ((interleave(X, Y, Z) << 1) | 1) << 3 l
//
// with (X, Y, Z) its position in units of its own size: bits of x at 3k, of y at 3k+1, of z at 3k+2. The
// marker bit makes the level readable (a third of the trailing zeros) and sorts disjoint octants along the
// Morton curve; all descendants of an octant form one range of keys. Positions have up to 20 bits.
#pragma once

#include <bit>
#include <cstdint>

namespace burnish::morton {

inline constexpr int kMaxDepth = 20;

// Spreads the low 20 bits of v: bit k moves to bit 3k.
constexpr std::uint64_t spread(std::uint64_t v) {
  v &= 0xfffff;
  v = (v | v << 32) & 0x001f00000000ffffull;
  v = (v | v << 16) & 0x001f0000ff0000ffull;
  v = (v | v << 8) & 0x100f00f00f00f00full;
  v = (v | v << 4) & 0x10c30c30c30c30c3ull;
  v = (v | v << 2) & 0x1249249249249249ull;
  return v;
}

// The inverse of `spread`: gathers every third bit.
constexpr std::uint32_t compact(std::uint64_t v) {
  v &= 0x1249249249249249ull;
  v = (v | v >> 2) & 0x10c30c30c30c30c3ull;
  v = (v | v >> 4) & 0x100f00f00f00f00full;
  v = (v | v >> 8) & 0x001f0000ff0000ffull;
  v = (v | v >> 16) & 0x001f00000000ffffull;
  v = (v | v >> 32) & 0xfffff;
  return static_cast<std::uint32_t>(v);
}

// A position in units of some level's octants, or of finest blocks.
struct Position {
  std::uint32_t x = 0, y = 0, z = 0;
  friend constexpr bool operator==(const Position&, const Position&) = default;
};

constexpr std::uint64_t interleave(const Position& p) {
  return spread(p.x) | spread(p.y) << 1 | spread(p.z) << 2;
}
constexpr Position deinterleave(std::uint64_t m) { return {compact(m), compact(m >> 1), compact(m >> 2)}; }

constexpr std::uint64_t key(std::uint64_t interleaved, int level) {  // [T-OCT-1]
  return (interleaved << 1 | 1) << (3 * level);
}
constexpr int level(std::uint64_t key) { return std::countr_zero(key) / 3; }
// Position of the octant's lower corner in finest blocks.
constexpr Position corner(std::uint64_t key) {
  const int l = level(key);
  const Position p = deinterleave(key >> (3 * l + 1));
  return {p.x << l, p.y << l, p.z << l};
}
constexpr std::uint64_t parent(std::uint64_t key) {
  const int l = level(key);
  return ((key >> (3 * l + 4)) << 1 | 1) << (3 * (l + 1));
}

}  // namespace burnish::morton
