#include "curvature_kernel.h"

#include <cmath>
#include <cstring>

#include "kernel_rows.h"
#include "lagrange.h"

namespace burnish::detail {
namespace {

using Lanes = std::array<double, kBlockSide>;

// One lane per node of the stencil: weights of the value, the first and the second derivative as polynomials in the place s = -1/2 ... 1/2
// between the two middle nodes; coefficient [d] belongs to s^d.
template <int most>
struct Basis {
  static constexpr int kDegree = most;
  std::array<Lanes, most + 1> value{}, first{}, second{};
};

// [T-CURV-3]
template <int points>
constexpr Basis<points - 1> lagrange_basis() {
  Basis<points - 1> basis;
  for (int i = 0; i < points; ++i) {
    const std::array<double, points> c = lagrange_coefficients<points>(i, 0.5 * (points - 1));
    const auto lane = static_cast<std::size_t>(i);
    for (std::size_t d = 0; d < points; ++d) {
      basis.value[d][lane] = c[d];
      if (d >= 1) basis.first[d - 1][lane] = static_cast<double>(d) * c[d];
      if (d >= 2) basis.second[d - 2][lane] = static_cast<double>(d * (d - 1)) * c[d];
    }
  }
  return basis;
}

// [T-CURV-4]: differences at the two middle nodes, times 1/2 - s and 1/2 + s.
constexpr Basis<1> central_basis() {
  Basis<1> basis;
  basis.value = {Lanes{0, 0.5, 0.5, 0}, Lanes{0, -1, 1, 0}};
  basis.first = {Lanes{-0.25, -0.25, 0.25, 0.25}, Lanes{0.5, -0.5, -0.5, 0.5}};
  basis.second = {Lanes{0.5, -0.5, -0.5, 0.5}, Lanes{-1, 3, -3, 1}};
  return basis;
}

alignas(64) constexpr auto kCubic = lagrange_basis<4>();
alignas(64) constexpr auto kQuintic = lagrange_basis<6>();
alignas(64) constexpr auto kSeptic = lagrange_basis<8>();
alignas(64) constexpr auto kCentral = central_basis();

template <int degree, std::size_t size>
BURNISH_INLINE Row horner(const std::array<Lanes, size>& c, double s) {
  Row sum = load(c[degree].data());
#pragma GCC unroll 8
  for (int d = degree - 1; d >= 0; --d) sum = sum * s + load(c[static_cast<std::size_t>(d)].data());
  return sum;
}

// What an axis contributes: the stencil's lowest node, and the weights there.
template <int points, int degree, bool with_second>
struct Axis {
  int first;
  Row value, slope, bend;

  BURNISH_INLINE Axis(const Basis<degree>& basis, double p) : first(first_node(points, p)), bend{} {
    constexpr bool is_polynomial = degree == points - 1;  // derivatives of lower degree
    const double s = p - (first + 0.5 * (points - 1));
    value = horner<degree>(basis.value, s);
    slope = horner<is_polynomial ? degree - 1 : degree>(basis.first, s);
    if constexpr (with_second) bend = horner<is_polynomial ? degree - 2 : degree>(basis.second, s);
  }
};

// Sums of the lanes of eight rows, one per lane, pairs first.
BURNISH_INLINE Row pair_sums(const Row& a, const Row& b) {
  return __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14) + __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
}
BURNISH_INLINE Row quad_sums(const Row& a, const Row& b) {
  return __builtin_shufflevector(a, b, 0, 1, 8, 9, 4, 5, 12, 13) + __builtin_shufflevector(a, b, 2, 3, 10, 11, 6, 7, 14, 15);
}
BURNISH_INLINE Row octet_sums(const Row& a, const Row& b) {
  return __builtin_shufflevector(a, b, 0, 1, 2, 3, 8, 9, 10, 11) + __builtin_shufflevector(a, b, 4, 5, 6, 7, 12, 13, 14, 15);
}

template <int points, int degree>
BURNISH_INLINE void jet_with(const Basis<degree>& basis, const double* phi, const Vec3& p, Jet& jet) {
  const Axis<points, degree, true> x(basis, p.x), y(basis, p.y), z(basis, p.z);
  alignas(64) std::array<double, kBlockSide> y0, y1, y2, z0, z1, z2;
  store(y.value, y0.data()), store(y.slope, y1.data()), store(y.bend, y2.data());
  store(z.value, z0.data()), store(z.slope, z1.data()), store(z.bend, z2.data());
  const double* corner = phi + x.first + kJetSide * (y.first + kJetSide * z.first);
  // Names: derivatives in y and in z.
  Row f00{}, f10{}, f20{}, f01{}, f11{}, f02{};
  for (std::size_t b = 0; b < points; ++b) {
    Row g0{}, g1{}, g2{};
#pragma GCC unroll 8
    for (std::size_t c = 0; c < points; ++c) {
      const Row row = load(corner + kJetSide * (b + kJetSide * c));
      g0 += row * z0[c];
      g1 += row * z1[c];
      g2 += row * z2[c];
    }
    f00 += g0 * y0[b];
    f10 += g0 * y1[b];
    f20 += g0 * y2[b];
    f01 += g1 * y0[b];
    f11 += g1 * y1[b];
    f02 += g2 * y0[b];
  }
  const Row most = octet_sums(quad_sums(pair_sums(f00 * x.value, f00 * x.slope), pair_sums(f10 * x.value, f01 * x.value)),
                              quad_sums(pair_sums(f00 * x.bend, f10 * x.slope), pair_sums(f01 * x.slope, f20 * x.value)));
  const Row last = quad_sums(pair_sums(f11 * x.value, f02 * x.value), Row{});
  jet = {most[0], {most[1], most[2], most[3]}, most[4], most[5], most[6], most[7], last[0] + last[4], last[1] + last[5]};
}

BURNISH_INLINE std::size_t part_of(int node) { return node < kJetWidth ? 0 : node < kJetWidth + kBlockSide ? 1 : 2; }

template <class T>
BURNISH_INLINE void fill_with(const T* gathered, double scale, const JetLimits& limits, JetBlock& block) {
  std::array<std::uint16_t, JetBlock::kRowMasks> rows;
  for (int z = 0; z < kJetSide; ++z)
    for (int y = 0; y < kJetSide; ++y) {
      const auto row = static_cast<std::size_t>(y + kJetSide * z);
      const double* limit = limits[part_of(y) + 3 * part_of(z)].data();
      unsigned bits = 0;
      for (int half = 0; half < 2; ++half) {
        const int x = kBlockSide * half;
        const Row v = load_scaled(gathered + kJetSide * row + x, scale);
        store(v, block.phi.data() + kJetSide * row + x);
        bits |= bits_of((v < Row{} ? -v : v) >= load(limit + x)) << x;
      }
      rows[row] = static_cast<std::uint16_t>(bits);
    }
  // Boxes of four rows, of six, of eight.
  for (std::size_t k = 0; k < 3; ++k) {
    const std::size_t points = 4 + 2 * k, ends = kJetSide - points + 1;
    std::array<std::uint16_t, JetBlock::kRowMasks> layers;
    for (std::size_t row = 0; row < kJetSide * ends; ++row) {
      unsigned any = 0;
      for (std::size_t c = 0; c < points; ++c) any |= rows[row + kJetSide * c];
      layers[row] = static_cast<std::uint16_t>(any);
    }
    for (std::size_t z = 0; z < ends; ++z)
      for (std::size_t y = 0; y < ends; ++y) {
        unsigned any = 0;
        for (std::size_t b = 0; b < points; ++b) any |= layers[y + b + kJetSide * z];
        block.clamped[k][y + kJetSide * z] = static_cast<std::uint16_t>(any);
      }
  }
}

// By components, for loops over many points.
struct Components {
  double x, y, z;
  BURNISH_INLINE Components operator*(double s) const { return {x * s, y * s, z * s}; }
  BURNISH_INLINE Components operator+(const Components& b) const { return {x + b.x, y + b.y, z + b.z}; }
};
BURNISH_INLINE double inner(const Components& a, const Components& b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
BURNISH_INLINE Components outer(const Components& a, const Components& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
BURNISH_INLINE Components unit(const Components& a) { return a * (1 / std::sqrt(inner(a, a))); }
BURNISH_INLINE void put(const Components& a, std::size_t n, std::array<JetBatch::Lanes, 3>& to) { to[0][n] = a.x, to[1][n] = a.y, to[2][n] = a.z; }

}  // namespace

BURNISH_DISPATCH
void principal_curvatures(const JetBatch& jets, std::size_t count, CurvatureBatch& curvatures) {
  for (std::size_t i = 0; i < count; ++i) {
    const Components g{jets.gradient[0][i], jets.gradient[1][i], jets.gradient[2][i]};
    const double inverse = 1 / std::sqrt(inner(g, g));
    const Components n = g * -inverse;
    // A tangent frame that depends on the normal alone: u is orthogonal to the axis that the normal is farthest from.
    const double ax = std::abs(n.x), ay = std::abs(n.y), az = std::abs(n.z);
    const double ex = ((ax <= ay) & (ax <= az)) ? 1 : 0, ey = ay <= az ? 1 - ex : 0, ez = 1 - ex - ey;
    const Components u = unit(outer({ex, ey, ez}, n)), v = outer(n, u);
    const auto times = [&](const Components& a) __attribute__((always_inline)) {
      return Components{jets.xx[i] * a.x + jets.xy[i] * a.y + jets.xz[i] * a.z, jets.xy[i] * a.x + jets.yy[i] * a.y + jets.yz[i] * a.z,
                        jets.xz[i] * a.x + jets.yz[i] * a.y + jets.zz[i] * a.z};
    };
    const Components hu = times(u), hv = times(v);
    const double uu = -inner(u, hu) * inverse, uv = -inner(u, hv) * inverse, vv = -inner(v, hv) * inverse;
    const double mean = 0.5 * (uu + vv), d = 0.5 * (uu - vv), r = std::sqrt(d * d + uv * uv);
    curvatures.k1[i] = mean + r;
    curvatures.k2[i] = mean - r;
    // cos and sin of half the angle of (d, uv): the larger one first, without cancellation. At umbilics u.
    const double some = r > 0 ? r : 1, large = std::sqrt(0.5 * (some + std::abs(d)) / some), small = 0.5 * std::abs(uv) / (some * large);
    const double c = d < 0 ? small : large, s = d < 0 ? large : small;
    const Components along = unit(u * c + v * (uv < 0 ? -s : s));
    put(n, i, curvatures.normal);
    put(along, i, curvatures.direction1);
    put(outer(n, along), i, curvatures.direction2);
  }
}

BURNISH_DISPATCH
void fill(const float* gathered, double scale, const JetLimits& limits, JetBlock& block) { fill_with(gathered, scale, limits, block); }

BURNISH_DISPATCH
void fill(const double* gathered, double scale, const JetLimits& limits, JetBlock& block) { fill_with(gathered, scale, limits, block); }

BURNISH_DISPATCH
void cubic(const JetBlock& block, const Vec3& p, double& value, Vec3& gradient) {
  const Axis<4, 3, false> x(kCubic, p.x), y(kCubic, p.y), z(kCubic, p.z);
  alignas(64) std::array<double, kBlockSide> y0, y1, z0, z1;
  store(y.value, y0.data()), store(y.slope, y1.data());
  store(z.value, z0.data()), store(z.slope, z1.data());
  const double* corner = block.phi.data() + x.first + kJetSide * (y.first + kJetSide * z.first);
  Row f00{}, f10{}, f01{};
#pragma GCC unroll 4
  for (std::size_t b = 0; b < 4; ++b) {
    Row g0{}, g1{};
#pragma GCC unroll 4
    for (std::size_t c = 0; c < 4; ++c) {
      const Row row = load(corner + kJetSide * (b + kJetSide * c));
      g0 += row * z0[c];
      g1 += row * z1[c];
    }
    f00 += g0 * y0[b];
    f10 += g0 * y1[b];
    f01 += g1 * y0[b];
  }
  const Row sums = quad_sums(pair_sums(f00 * x.value, f00 * x.slope), pair_sums(f10 * x.value, f01 * x.value));
  value = sums[0] + sums[4];
  gradient = {sums[1] + sums[5], sums[2] + sums[6], sums[3] + sums[7]};
}

BURNISH_DISPATCH
void jet_of_second_order(const JetBlock& block, const Vec3& p, Jet& jet) { jet_with<4>(kCentral, block.phi.data(), p, jet); }

BURNISH_DISPATCH
void jet_of_fourth_order(const JetBlock& block, const Vec3& p, Jet& jet) { jet_with<6>(kQuintic, block.phi.data(), p, jet); }

BURNISH_DISPATCH
void jet_of_sixth_order(const JetBlock& block, const Vec3& p, Jet& jet) { jet_with<8>(kSeptic, block.phi.data(), p, jet); }

}  // namespace burnish::detail
