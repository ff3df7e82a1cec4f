// Triquintic interpolation of node values: sixth order. For units that are compiled for vectors.
#pragma once

#include <array>
#include <cstddef>

#include "burnish/core/vec.h"
#include "kernel_rows.h"
#include "lagrange.h"

namespace burnish::detail {

// Row p: the coefficients of t^p in the Lagrange polynomials of nodes -2, -1, 0, 1, 2, 3, and two lanes of zeros. [T-REDIST-5]
constexpr std::array<std::array<double, kBlockSide>, 6> quintic_coefficients() {
  std::array<std::array<double, kBlockSide>, 6> table{};
  for (std::size_t i = 0; i < 6; ++i) {
    const std::array<double, 6> c = lagrange_coefficients<6>(static_cast<int>(i), 2);
    for (std::size_t p = 0; p < 6; ++p) table[p][i] = c[p];
  }
  return table;
}

inline constexpr auto kQuinticPolynomials = quintic_coefficients();

BURNISH_INLINE Row quintic_weights(double t) {
  Row weights = load(kQuinticPolynomials[5].data());
  for (std::size_t p = 5; p-- > 0;) weights = weights * t + load(kQuinticPolynomials[p].data());
  return weights;
}

// The interpolant through 6 x 6 x 6 values from `corner` on, rows of `side` apart, at t: (0, 0, 0) is the third node along each axis. Rows are read two
// values beyond the last node.
template <class T>
BURNISH_INLINE double triquintic(const T* corner, int side, const Vec3& t) {
  const Row wx = quintic_weights(t.x), wy = quintic_weights(t.y), wz = quintic_weights(t.z);
  Row sum{};
  for (int c = 0; c < 6; ++c) {
    const T* row = corner + c * side * side;
    Row plane{};
    for (int b = 0; b < 6; ++b) plane += load(row + b * side) * wy[b];
    sum += plane * wz[c];
  }
  sum *= wx;
  return ((sum[0] + sum[1]) + (sum[2] + sum[3])) + (sum[4] + sum[5]);
}

}  // namespace burnish::detail
