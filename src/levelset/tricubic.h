// Tricubic interpolation of node values, with first and second derivatives. For units that are compiled for vectors.
#pragma once

#include <cstddef>
#include <cstring>

#include "burnish/core/vec.h"

// Inlined into every clone of its callers, so that it is compiled for that clone's processor.
#ifndef BURNISH_INLINE
#define BURNISH_INLINE inline __attribute__((always_inline))
#endif

namespace burnish::detail {

struct SecondOrder {
  double value;
  Vec3 gradient;
  double xx, xy, yy, xz, yz, zz;

  BURNISH_INLINE Vec3 hessian(const Vec3& v) const {
    return {xx * v.x + xy * v.y + xz * v.z, xy * v.x + yy * v.y + yz * v.z, xz * v.x + yz * v.y + zz * v.z};
  }
};

typedef double Four __attribute__((vector_size(4 * sizeof(double))));
typedef float FourFloats __attribute__((vector_size(4 * sizeof(float))));

BURNISH_INLINE Four load_four(const double* from) {
  Four four;
  std::memcpy(&four, from, sizeof four);
  return four;
}
BURNISH_INLINE Four load_four(const float* from) {
  FourFloats four;
  std::memcpy(&four, from, sizeof four);
  return __builtin_convertvector(four, Four);
}

// The sums of four vectors' lanes: the dot products once they are multiplied.
BURNISH_INLINE Four sums(const Four& a, const Four& b, const Four& c, const Four& d) {
  const Four ab = __builtin_shufflevector(a, b, 0, 4, 2, 6) + __builtin_shufflevector(a, b, 1, 5, 3, 7);
  const Four cd = __builtin_shufflevector(c, d, 0, 4, 2, 6) + __builtin_shufflevector(c, d, 1, 5, 3, 7);
  return __builtin_shufflevector(ab, cd, 0, 1, 4, 5) + __builtin_shufflevector(ab, cd, 2, 3, 6, 7);
}

// Weights of the cubic Lagrange polynomial through nodes -1, 0, 1, 2 at t, and their derivatives. [T-REDIST-2]
struct CubicWeights {
  Four value, slope, bend;

  BURNISH_INLINE explicit CubicWeights(double t) {
    const Four c3{-1. / 6, 1. / 2, -1. / 2, 1. / 6}, c2{1. / 2, -1, 1. / 2, 0}, c1{-1. / 3, -1. / 2, 1, -1. / 6}, c0{0, 1, 0, 0};
    value = ((c3 * t + c2) * t + c1) * t + c0;
    slope = (c3 * (3 * t) + c2 * 2.) * t + c1;
    bend = c3 * (6 * t) + c2 * 2.;
  }
};

// The interpolant through 4 x 4 x 4 values from `corner` on, rows of `side` apart, at t: (0, 0, 0) is the second node along each axis.
template <class T>
BURNISH_INLINE SecondOrder tricubic(const T* corner, int side, const Vec3& t) {
  const CubicWeights wx(t.x), wy(t.y), wz(t.z);
  Four f{}, f_y{}, f_yy{}, f_z{}, f_yz{}, f_zz{};  // as functions of x: lines of four nodes
  for (int b = 0; b < 4; ++b) {
    const T* row = corner + side * b;
    const Four r0 = load_four(row), r1 = load_four(row + side * side), r2 = load_four(row + 2 * side * side),
               r3 = load_four(row + 3 * side * side);
    const Four p = (r0 * wz.value[0] + r1 * wz.value[1]) + (r2 * wz.value[2] + r3 * wz.value[3]);
    const Four p_z = (r0 * wz.slope[0] + r1 * wz.slope[1]) + (r2 * wz.slope[2] + r3 * wz.slope[3]);
    const Four p_zz = (r0 * wz.bend[0] + r1 * wz.bend[1]) + (r2 * wz.bend[2] + r3 * wz.bend[3]);
    f += p * wy.value[b];
    f_y += p * wy.slope[b];
    f_yy += p * wy.bend[b];
    f_z += p_z * wy.value[b];
    f_yz += p_z * wy.slope[b];
    f_zz += p_zz * wy.value[b];
  }
  const Four first = sums(f * wx.value, f * wx.slope, f_y * wx.value, f_z * wx.value);
  const Four second = sums(f * wx.bend, f_y * wx.slope, f_yy * wx.value, f_z * wx.slope);
  const Four third = sums(f_yz * wx.value, f_zz * wx.value, Four{}, Four{});
  return {first[0], {first[1], first[2], first[3]}, second[0], second[1], second[2], second[3], third[0], third[1]};
}

}  // namespace burnish::detail
