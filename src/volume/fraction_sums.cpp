#include "fraction_sums.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr double kRounding = 1e-9;
constexpr std::size_t kGrain = 4096;

struct Sums {
  double volume = 0, worst = 0;
  std::size_t clamped = 0, mixed = 0;
};

Sums clamp_range(const CellGeometry& geometry, std::vector<double>& alpha, std::size_t begin, std::size_t end) {
  Sums sums;
  for (std::size_t c = begin; c < end; ++c) {
    // Coordinates whose products overflow give no number.
    const bool is_number = std::isfinite(alpha[c]);
    const double inside = is_number ? std::clamp(alpha[c], 0.0, 1.0) : 0, outside = is_number ? std::abs(alpha[c] - inside) : 1;
    if (outside > kRounding) ++sums.clamped;
    sums.worst = std::max(sums.worst, outside);
    if (inside > 0 && inside < 1) ++sums.mixed;
    alpha[c] = inside;
    sums.volume += inside * geometry.volume[c];
  }
  return sums;
}

}  // namespace

void clamp_and_sum(const CellGeometry& geometry, VolumeFractions& result) {
  const Sums sums = parallel_reduce(
      result.alpha.size(), kGrain, Sums{},
      [&](std::size_t begin, std::size_t end) { return clamp_range(geometry, result.alpha, begin, end); },
      [](const Sums& a, const Sums& b) { return Sums{a.volume + b.volume, std::max(a.worst, b.worst), a.clamped + b.clamped, a.mixed + b.mixed}; });
  result.volume = sums.volume;
  result.clamped = sums.clamped;
  result.mixed = sums.mixed;
  result.worst_clamp = sums.clamped > 0 ? sums.worst : 0;
}

}  // namespace burnish
