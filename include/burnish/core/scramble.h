// A bijection on 64 bits whose output passes for random: for hashes, and for random numbers that are the same everywhere.
#pragma once

#include <cstdint>

namespace burnish {

// The finalizer of SplitMix64 (Steele, Lea and Flood, 2014). scramble(0) == 0: add kScrambleStep to what may be 0, or to get the next number of a sequence.
inline constexpr std::uint64_t kScrambleStep = 0x9e3779b97f4a7c15u;
constexpr std::uint64_t scramble(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9u;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebu;
  return x ^ (x >> 31);
}

}  // namespace burnish
