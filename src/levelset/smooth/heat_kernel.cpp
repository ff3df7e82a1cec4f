#include "heat_kernel.h"

#include <cmath>
#include <cstring>
#include <numbers>

#include "../kernel_rows.h"

namespace burnish::detail {
namespace {

typedef float Floats __attribute__((vector_size(kBlockSide * sizeof(float))));

BURNISH_INLINE Floats load_floats(const float* from) {
  Floats row;
  std::memcpy(&row, from, sizeof row);
  return row;
}
BURNISH_INLINE void store_floats(const Floats& row, float* to) { std::memcpy(to, &row, sizeof row); }
BURNISH_INLINE Floats size_of(const Floats& v) { return v < 0 ? -v : v; }
BURNISH_INLINE Floats between(const Floats& v, float low, float high) {
  const Floats l = Floats{} + low, h = Floats{} + high;
  const Floats raised = v < l ? l : v;
  return raised > h ? h : raised;
}

// Distances: a pair of nodes of which one is none counts by the second difference of the last pair before it, at first by that of the nodes on the
// other side. [T-SMOOTH-3]
struct DistancePairs {
  float limit;

  BURNISH_INLINE Floats sum(const float* center, std::ptrdiff_t stride, const HeatTaps& taps) const {
    constexpr std::array<float, kHeatWidth> kGrowth{1, 4, 9.0f / 4, 16.0f / 9};  // of j^2
    const Floats c = load_floats(center), most = Floats{} + limit;
    Floats sum = c, bend = one_sided(center, stride);
#pragma GCC unroll 4
    for (std::size_t j = 0; j < kHeatWidth; ++j) {
      const std::ptrdiff_t off = static_cast<std::ptrdiff_t>(j + 1) * stride;
      const Floats a = load_floats(center + off), b = load_floats(center - off);
      const auto both = (size_of(a) < most) & (size_of(b) < most);
      bend = both ? (a - c) + (b - c) : bend * kGrowth[j];
      sum += bend * taps.weight[j];
    }
    return size_of(c) < most ? sum : c;
  }

 private:
  BURNISH_INLINE Floats one_sided(const float* center, std::ptrdiff_t stride) const {
    const Floats c = load_floats(center), most = Floats{} + limit, none{};
    const Floats a = load_floats(center + stride), a2 = load_floats(center + 2 * stride);
    const Floats b = load_floats(center - stride), b2 = load_floats(center - 2 * stride);
    const Floats up = ((size_of(a) < most) & (size_of(a2) < most)) ? (c - a) + (a2 - a) : none;
    return ((size_of(b) < most) & (size_of(b2) < most)) ? (c - b) + (b2 - b) : up;
  }
};

// Displacements: nothing flows from or to where they are unknown. [T-SMOOTH-4]
struct KnownPairs {
  BURNISH_INLINE Floats sum(const float* center, std::ptrdiff_t stride, const HeatTaps& taps) const {
    const Floats c = load_floats(center), most = Floats{} + 0.5f * kUnknown, none{};
    Floats sum = c;
#pragma GCC unroll 4
    for (std::size_t j = 0; j < kHeatWidth; ++j) {
      const std::ptrdiff_t off = static_cast<std::ptrdiff_t>(j + 1) * stride;
      const Floats a = load_floats(center + off), b = load_floats(center - off);
      sum += ((a < most ? a - c : none) + (b < most ? b - c : none)) * taps.weight[j];
    }
    return c < most ? sum : c;
  }
};

// Axis by axis: x in all rows, y in those of the block, z.
template <class Pairs>
BURNISH_INLINE void convolve(const float* in, const HeatTaps& taps, const Pairs& pairs, float* out) {
  constexpr std::size_t n = kHeatSide, b = kBlockSide, w = kHeatWidth;
  alignas(64) std::array<float, n * n * b> x;
  alignas(64) std::array<float, n * b * b> y;
  for (std::size_t row = 0; row < n * n; ++row) store_floats(pairs.sum(in + n * row + w, 1, taps), x.data() + b * row);
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t j = 0; j < b; ++j) store_floats(pairs.sum(x.data() + b * (j + w + n * k), b, taps), y.data() + b * (j + b * k));
  for (std::size_t row = 0; row < b * b; ++row) store_floats(pairs.sum(y.data() + b * (row + b * w), b * b, taps), out + b * row);
}

}  // namespace

HeatTaps::HeatTaps(double t) : time(t) {
  const double variance = 2 * t;
  std::array<double, kHeatWidth + 1> w;
  for (int j = 0; j <= kHeatWidth; ++j) w[static_cast<std::size_t>(j)] = t > 0 ? std::exp(-j * j / (2 * variance)) / std::sqrt(2 * std::numbers::pi * variance) : 0;
  // Two of them are corrected so that the second and the fourth moment are those of the Gaussian.
  const std::size_t p = t < 0.25 ? 1 : 3, q = p + 1;
  double second = variance, fourth = 3 * variance * variance;
  for (std::size_t j = 1; j <= kHeatWidth; ++j) {
    const double j2 = static_cast<double>(j * j);
    second -= 2 * w[j] * j2;
    fourth -= 2 * w[j] * j2 * j2;
  }
  const double p2 = static_cast<double>(p * p), q2 = static_cast<double>(q * q);
  w[p] += (q2 * second - fourth) / (2 * p2 * (q2 - p2));
  w[q] += (fourth - p2 * second) / (2 * q2 * (q2 - p2));
  for (std::size_t j = 0; j < kHeatWidth; ++j) weight[j] = static_cast<float>(w[j + 1]);
}

BURNISH_DISPATCH
void heat_source(const std::array<float, kHeatNodes>& phi, const HeatTaps& taps, float limit, float domain, float* out) {
  convolve(phi.data(), taps, DistancePairs{limit}, out);
  const float per_time = static_cast<float>(0.5 / taps.time);
  for (std::size_t k = 0; k < kBlockSide; ++k)
    for (std::size_t j = 0; j < kBlockSide; ++j) {
      float* to = out + kBlockSide * (j + kBlockSide * k);
      const Floats d = load_floats(phi.data() + kHeatWidth + kHeatSide * (j + kHeatWidth + kHeatSide * (k + kHeatWidth)));
      const Floats moved = load_floats(to) - d;
      const Floats at_surface = moved / between(1 - d * moved * per_time, 0.75f, 4.0f / 3);
      store_floats(size_of(d) < domain ? at_surface : Floats{} + kUnknown, to);
    }
}

BURNISH_DISPATCH
void heat_pass(const std::array<float, kHeatNodes>& moved, const HeatTaps& taps, float* out) { convolve(moved.data(), taps, KnownPairs{}, out); }

BURNISH_DISPATCH
void heat_bends(const std::array<float, kBendNodes>& phi, Bends& bends) {
  constexpr std::ptrdiff_t x = 1, y = kBendSide, z = kBendSide * kBendSide;
  for (std::size_t k = 0; k < kBlockSide; ++k)
    for (std::size_t j = 0; j < kBlockSide; ++j) {
      const float* center = phi.data() + 1 + kBendSide * (j + 1 + kBendSide * (k + 1));
      const auto at = [&](std::ptrdiff_t off) __attribute__((always_inline)) { return load_floats(center + off); };
      const Floats c = at(0);
      const auto twice = [&](std::ptrdiff_t a) __attribute__((always_inline)) { return (at(a) - c) + (at(-a) - c); };
      const auto mixed = [&](std::ptrdiff_t a, std::ptrdiff_t b) __attribute__((always_inline)) {
        return 0.25f * ((at(a + b) - at(a - b)) - (at(b - a) - at(-a - b)));
      };
      const Floats xx = twice(x), yy = twice(y), zz = twice(z), xy = mixed(x, y), xz = mixed(x, z), yz = mixed(y, z);
      const std::size_t row = kBlockSide * (j + kBlockSide * k);
      store_floats(xx + yy + zz, bends.trace.data() + row);
      store_floats(xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz), bends.square.data() + row);
    }
}

}  // namespace burnish::detail
