// Random octrees with level jumps, for property tests.
#pragma once

#include <algorithm>
#include <cstdint>
#include <random>
#include <vector>

#include "burnish/octree/octree.h"

namespace burnish::test {

// Up to `most` distinct or repeated finest blocks of a domain of 2^depth blocks a side. Every other draw is clustered, so
// that steep gradings and large uniform parts both occur.
inline std::vector<std::uint64_t> random_finest(std::mt19937& random, int depth, int most) {
  const std::uint32_t side = 1u << depth;
  std::uniform_int_distribution<std::uint32_t> any(0, side - 1);
  std::uniform_int_distribution<int> count(1, most), step(-1, 1);
  std::vector<std::uint64_t> finest;
  const bool clustered = random() % 2 == 0;
  morton::Position p{any(random), any(random), any(random)};
  for (int n = count(random); n > 0; --n) {
    finest.push_back(morton::interleave(p));
    const auto walk = [&](std::uint32_t x) {
      return clustered ? static_cast<std::uint32_t>(std::clamp(static_cast<int>(x) + step(random), 0, static_cast<int>(side) - 1))
                       : any(random);
    };
    p = {walk(p.x), walk(p.y), walk(p.z)};
  }
  return finest;
}

inline Octree random_octree(std::mt19937& random, int depth, int most) {
  return Octree::build(depth, random_finest(random, depth, most));
}

}  // namespace burnish::test
