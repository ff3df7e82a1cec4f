// Lagrange polynomials on equidistant nodes, by their coefficients.
#pragma once

#include <array>
#include <cstddef>

namespace burnish::detail {

// Entry p: the coefficient of t^p in the polynomial that is 1 at node i - origin and 0 at the other nodes j - origin, j = 0 ... points - 1.
template <int points>
constexpr std::array<double, points> lagrange_coefficients(int i, double origin) {
  std::array<double, points> c{1};
  int degree = 0;
  for (int j = 0; j < points; ++j) {
    if (j == i) continue;
    // Times (t - (j - origin)) / (i - j).
    for (int p = ++degree; p >= 0; --p) {
      const auto at = static_cast<std::size_t>(p);
      c[at] = ((p > 0 ? c[at - 1] : 0) - (j - origin) * c[at]) / (i - j);
    }
  }
  return c;
}

}  // namespace burnish::detail
