// FieldSampler: the trilinear interpolant of a level set, for callers that ask for one point after the other, millions of times.
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/progress.h"
#include "burnish/core/vec.h"
#include "burnish/levelset/level_set.h"

namespace burnish::detail {

// Thrown by the sampler, through whoever called it, when it was asked too often.
struct TooManyCalls {};

// The same interpolant as `sample`. Outside the domain, and where it is no number, it is kOutside. Leaves are copied with their upper
// halo when they are first asked for, 3 kB each; the last one is tried first. Not for several threads.
class FieldSampler {
 public:
  static constexpr double kOutside = -1;

  FieldSampler(const LevelSet& level_set, Progress& progress);

  // phi at p. Throws TooManyCalls beyond the limit, and what Progress::check throws.
  double operator()(const Vec3& p);
  bool is_inside(const Vec3& p) { return (*this)(p) >= 0; }

  // A zero between a and b, to 1e-5 in phi, if exactly one of them is inside. [T-DELAUNAY-1] None to the ninth question in a row for the same a and b: the
  // mesher asks again for as long as rounding keeps it from using the answer, and would do so for ever.
  std::optional<Vec3> crossing(Vec3 a, Vec3 b);
  // The nearest zero along phi's gradient, to the same accuracy; p itself if there is none within `reach`.
  Vec3 projected(const Vec3& p, double reach);

  std::size_t calls() const { return calls_; }
  // Calls that are left from here on.
  void limit(std::size_t calls) { limit_ = calls_ + calls; }

 private:
  static constexpr int kSide = kBlockSide + 1;
  static constexpr std::size_t kValues = kSide * kSide * kSide;

  void enter_leaf(const std::array<std::int32_t, 3>& at);
  void load(std::uint32_t leaf);
  void check();
  bool clip(Vec3& a, Vec3& b) const;
  Vec3 gradient(const Vec3& p);

  const LevelSet& set_;
  Progress& progress_;
  std::int32_t side_;               // of the domain, in finest cells
  std::vector<std::uint32_t> slot_;  // per leaf: its place in values_, or kNone
  std::vector<float> values_;
  std::size_t calls_ = 0, limit_ = std::numeric_limits<std::size_t>::max() / 2;
  std::array<Vec3, 2> last_ends_{};
  int repeats_ = 0;
  // The leaf that was asked last.
  std::uint32_t leaf_ = 0;
  std::array<std::int32_t, 3> corner_{};
  std::int32_t extent_ = 0;
  double per_cell_ = 1;  // 1 / its cell
  std::size_t first_ = 0;
};

}  // namespace burnish::detail
