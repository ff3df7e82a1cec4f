#include "nodal_curvature_kernel.h"

#include <array>
#include <cmath>

#include "curvature_formula.h"
#include "kernel_rows.h"

namespace burnish::detail {
namespace {

constexpr std::ptrdiff_t kSide = kBlockSide + 2 * kNodalWidth;
constexpr std::ptrdiff_t kX = 1, kY = kSide, kZ = kSide * kSide;  // to the next node
constexpr double kFlat = 1e-12, kSharpest = 2;                    // as the flow has it [T-CURV-1]

// [T-CURV-6]
template <int order, class At>
BURNISH_INLINE Row first_difference(const At& at) {
  if constexpr (order == 2) return 0.5 * (at(1) - at(-1));
  return (2.0 / 3) * (at(1) - at(-1)) - (1.0 / 12) * (at(2) - at(-2));
}
template <int order, class At>
BURNISH_INLINE Row second_difference(const At& at) {
  if constexpr (order == 2) return at(1) - 2 * at(0) + at(-1);
  return (4.0 / 3) * (at(1) + at(-1)) - (1.0 / 12) * (at(2) + at(-2)) - 2.5 * at(0);
}

template <int order>
BURNISH_INLINE void differentiate_row(const double* p, double* cubes, double* squares) {
  const auto along = [p](std::ptrdiff_t step) { return [=](int n) __attribute__((always_inline)) { return load(p + n * step); }; };
  const auto mixed = [p](std::ptrdiff_t inner, std::ptrdiff_t outer) __attribute__((always_inline)) {
    return first_difference<order>([=](int m) __attribute__((always_inline)) {
      return first_difference<order>([=](int n) __attribute__((always_inline)) { return load(p + n * inner + m * outer); });
    });
  };
  const Row x = first_difference<order>(along(kX)), y = first_difference<order>(along(kY)), z = first_difference<order>(along(kZ));
  store(curvature_times_cube(x, y, z, second_difference<order>(along(kX)), second_difference<order>(along(kY)), second_difference<order>(along(kZ)),
                             mixed(kX, kY), mixed(kX, kZ), mixed(kY, kZ)),
        cubes);
  store(x * x + y * y + z * z, squares);
}

template <int order>
BURNISH_INLINE void differentiate(const double* phi, double* cubes, double* squares) {
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j) {
      const std::size_t n = node_index(0, j, k);
      differentiate_row<order>(phi + kNodalWidth * (kX + kY + kZ) + j * kY + k * kZ, cubes + n, squares + n);
    }
}

template <class T>
BURNISH_INLINE void nodal_curvatures_of(const T* gathered, double scale, int order, double* curvatures) {
  std::array<double, kNodalNodes> phi;
  static_assert(kNodalNodes % kBlockSide == 0);
  for (std::size_t n = 0; n < kNodalNodes; n += kBlockSide) store(load_scaled(gathered + n, scale), &phi[n]);
  alignas(64) std::array<double, kBlockNodes> cubes, squares;
  if (order == 2)
    differentiate<2>(phi.data(), cubes.data(), squares.data());
  else
    differentiate<4>(phi.data(), cubes.data(), squares.data());
  for (std::size_t n = 0; n < kBlockNodes; ++n) {
    const double kappa = -cubes[n] / (squares[n] * std::sqrt(squares[n]));
    const double most = kappa > kSharpest ? kSharpest : kappa < -kSharpest ? -kSharpest : kappa;
    curvatures[n] = squares[n] < kFlat ? 0 : most;
  }
}

}  // namespace

BURNISH_DISPATCH
void nodal_curvatures(const float* gathered, double scale, int order, double* curvatures) { nodal_curvatures_of(gathered, scale, order, curvatures); }

BURNISH_DISPATCH
void nodal_curvatures(const double* gathered, double scale, int order, double* curvatures) { nodal_curvatures_of(gathered, scale, order, curvatures); }

}  // namespace burnish::detail
