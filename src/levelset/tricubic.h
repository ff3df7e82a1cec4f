// Tricubic interpolation in a dense block of node values.
#pragma once

#include <array>
#include <cmath>

#include "burnish/core/vec.h"

namespace burnish::detail {

struct ValueAndGradient {
  double value;
  Vec3 gradient;
};

// Weights of the cubic Lagrange polynomial through nodes -1, 0, 1, 2 at t in [0, 1], and their derivatives. [T-REDIST-2]
struct CubicWeights {
  std::array<double, 4> value, slope;

  explicit CubicWeights(double t) {
    const double a = t + 1, b = t, c = t - 1, d = t - 2;
    value = {-b * c * d / 6, a * c * d / 2, -a * b * d / 2, a * b * c / 6};
    slope = {-(c * d + b * d + b * c) / 6, (c * d + a * d + a * c) / 2, -(b * d + a * d + a * b) / 2,
             (b * c + a * c + a * b) / 6};
  }
};

// Fourth-order interpolation of `dense` (side^3 values, x fastest) at p, in node coordinates of the array. p must keep
// one node from the array's lower and two from its upper faces.
template <int side>
ValueAndGradient tricubic(const double* dense, const Vec3& p) {
  const int i = static_cast<int>(std::floor(p.x)), j = static_cast<int>(std::floor(p.y)), k = static_cast<int>(std::floor(p.z));
  const CubicWeights wx(p.x - i), wy(p.y - j), wz(p.z - k);
  ValueAndGradient result{0, {}};
  for (int c = 0; c < 4; ++c) {
    double plane = 0, plane_x = 0, plane_y = 0;
    for (int b = 0; b < 4; ++b) {
      const double* row = dense + (i - 1) + side * ((j - 1 + b) + side * (k - 1 + c));
      double line = 0, line_x = 0;
      for (std::size_t a = 0; a < 4; ++a) {
        line += wx.value[a] * row[a];
        line_x += wx.slope[a] * row[a];
      }
      const auto bb = static_cast<std::size_t>(b);
      plane += wy.value[bb] * line;
      plane_x += wy.value[bb] * line_x;
      plane_y += wy.slope[bb] * line;
    }
    const auto cc = static_cast<std::size_t>(c);
    result.value += wz.value[cc] * plane;
    result.gradient.x += wz.value[cc] * plane_x;
    result.gradient.y += wz.value[cc] * plane_y;
    result.gradient.z += wz.slope[cc] * plane;
  }
  return result;
}

}  // namespace burnish::detail
