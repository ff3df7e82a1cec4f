// The tricubic interpolant of a level set's nodes, at any point of its domain. [T-EXPORT-2]
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "burnish/levelset/level_set.h"

namespace burnish {

// Works in one leaf after the other, whose nodes with their surroundings it keeps: for points that follow each other. Not from several threads.
class TricubicSampler {
 public:
  explicit TricubicSampler(const LevelSet& set) : set_(set) {}

  // Phi in finest cells at a point of the domain, in lattice coordinates.
  double operator()(const Vec3& p);

 private:
  static constexpr int kWidth = 2, kSide = kBlockSide + 2 * kWidth;

  // Of the first node of a stencil, which is one below the cell's.
  static std::size_t place(int i, int j, int k) { return static_cast<std::size_t>(i + kWidth - 1 + kSide * (j + kWidth - 1 + kSide * (k + kWidth - 1))); }
  void enter(std::uint32_t leaf);

  const LevelSet& set_;
  std::uint32_t leaf_ = Octree::kNone;
  Vec3 corner_;
  double cell_ = 1;
  std::array<float, std::size_t{kSide} * kSide * kSide> values_{};
};

}  // namespace burnish
