#include "weno_kernel.h"

#include <algorithm>
#include <cmath>
#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
#define BURNISH_DISPATCH __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define BURNISH_DISPATCH
#endif
// Inlined into every clone, so that it is compiled for that clone's processor.
#define BURNISH_INLINE inline __attribute__((always_inline))

namespace burnish::detail {
namespace {

constexpr double kSmooth = 1e-6;    // epsilon of the weights, slopes being 1
constexpr double kSharp = 0.3;     // what second differences at a crossing may differ by before they are limited, per cell
constexpr double kStair = 0.4;      // cells; what a node is farther than its nearest neighbour, at least
constexpr double kLeast = 1e-6;     // cells; what |phi| keeps, so that the sign does

typedef double Row __attribute__((vector_size(kBlockSide * sizeof(double))));
typedef float FloatRow __attribute__((vector_size(kBlockSide * sizeof(float))));
typedef std::int64_t Mask __attribute__((vector_size(kBlockSide * sizeof(std::int64_t))));

BURNISH_INLINE Row row_of(double v) { return Row{} + v; }
BURNISH_INLINE Row load(const double* from) {
  Row row;
  std::memcpy(&row, from, sizeof row);
  return row;
}
BURNISH_INLINE Row load(const float* from) {
  FloatRow row;
  std::memcpy(&row, from, sizeof row);
  return __builtin_convertvector(row, Row);
}
BURNISH_INLINE void store(const Row& row, double* to) { std::memcpy(to, &row, sizeof row); }
BURNISH_INLINE void store(const Row& row, float* to) {
  const FloatRow floats = __builtin_convertvector(row, FloatRow);
  std::memcpy(to, &floats, sizeof floats);
}
BURNISH_INLINE Row larger(const Row& a, const Row& b) { return a > b ? a : b; }
BURNISH_INLINE Row smaller(const Row& a, const Row& b) { return a < b ? a : b; }
BURNISH_INLINE Row magnitude(const Row& a) { return larger(a, -a); }
BURNISH_INLINE Row sign_of(const Row& a) { return a > Row{} ? row_of(1) : a < Row{} ? row_of(-1) : Row{}; }
BURNISH_INLINE Row root(const Row& a) {
  alignas(64) std::array<double, kBlockSide> values;
  store(a, values.data());
  for (double& v : values) v = std::sqrt(v);
  return load(values.data());
}
// A lane for every bit of a byte.
BURNISH_INLINE Mask lanes_of(std::uint8_t bits) {
  const Mask lane{1, 2, 4, 8, 16, 32, 64, 128};
  return ((Mask{} + static_cast<std::int64_t>(bits)) & lane) != Mask{};
}

// One-sided derivatives along an axis: of the polynomials to the left of the node and to the right.
struct OneSided {
  Row left, right;
};

// How far WENO's derivative is from the central one, from four second differences. [T-WENO-2]
BURNISH_INLINE Row weno_correction(const Row& a, const Row& b, const Row& c, const Row& d, const Row& ab2, const Row& bc2, const Row& cd2) {
  const Row u = a - 3 * b, v = b + c, w = 3 * c - d;
  const Row e0 = kSmooth + (13 * ab2 + 3 * (u * u)), e1 = kSmooth + (13 * bc2 + 3 * (v * v)), e2 = kSmooth + (13 * cd2 + 3 * (w * w));
  const Row p01 = e0 * e1, p02 = e0 * e2, p12 = e1 * e2;
  const Row a0 = p12 * p12, a1 = 6 * (p02 * p02), a2 = 3 * (p01 * p01);
  const Row bcd = b - 2 * c + d;
  return (a0 * (a - 2 * b + c) * (1.0 / 3) + a2 * bcd * (1.0 / 6)) / (a0 + a1 + a2) - bcd * (1.0 / 12);
}

// Of fifth order, from the node and three beyond it on each side. [T-WENO-1]
BURNISH_INLINE OneSided weno5(const Row (&v)[7]) {
  const Row d0 = v[1] - v[0], d1 = v[2] - v[1], d2 = v[3] - v[2], d3 = v[4] - v[3], d4 = v[5] - v[4], d5 = v[6] - v[5];
  const Row s0 = d1 - d0, s1 = d2 - d1, s2 = d3 - d2, s3 = d4 - d3, s4 = d5 - d4;
  const Row t0 = s0 - s1, t1 = s1 - s2, t2 = s2 - s3, t3 = s3 - s4;
  const Row q0 = t0 * t0, q1 = t1 * t1, q2 = t2 * t2, q3 = t3 * t3;
  const Row central = (7 * (d2 + d3) - (d1 + d4)) * (1.0 / 12);
  return {central - weno_correction(s0, s1, s2, s3, q0, q1, q2), central + weno_correction(s4, s3, s2, s1, q3, q2, q1)};
}

// What the two sides contribute to |grad phi| where phi's sign is `sign`: Godunov's choice. [T-PDE-2]
BURNISH_INLINE Row upwind(const OneSided& d, const Row& sign) { return larger(larger(sign * d.left, -(sign * d.right)), Row{}); }

struct Weno5 {
  static constexpr int kWidth = 3;
  BURNISH_INLINE static OneSided derivatives(const Row (&v)[7]) { return weno5(v); }
  // The slope at a node whose surface is `theta` away on one side, where `beyond` is two cells away; `next` and `second` are on the other
  // side. All values are those of phi made positive at the node. [T-PDE-5]
  BURNISH_INLINE static Row slope_at_crossing(const Row& theta, const Row& beyond, const Row& value, const Row& next, const Row& second) {
    const Row first = value / theta;
    const Row bend = (next - value - first) / (1 + theta);
    const Row bend_there = 0.5 * (first + beyond / (2 - theta)), bend_here = 0.5 * (second - 2 * next + value);
    const Row apart = bend - bend_there, cubic = bend - apart * (1.0 / 3);
    const Row limited = bend * bend_here > Row{} ? (magnitude(bend) < magnitude(bend_here) ? bend : bend_here) : Row{};
    const Row ratio = apart * apart * (1 / (kSharp * kSharp));
    const Row weight = beyond < Row{} ? 1 / (1 + ratio * ratio) : Row{};
    return first + theta * (limited + weight * (cubic - limited));
  }
};

struct FirstOrder {
  static constexpr int kWidth = 1;
  BURNISH_INLINE static OneSided derivatives(const Row (&v)[3]) { return {v[1] - v[0], v[2] - v[1]}; }
  BURNISH_INLINE static Row slope_at_crossing(const Row& theta, const Row&, const Row& value, const Row&, const Row&) { return value / theta; }
};

// The new values: phi after the stage, its sign and zeros kept. `lowest`: the least |phi| of the neighbours, negative across the surface. [T-PDE-1]
template <class T>
BURNISH_INLINE Row advanced(const Row& phi, const Row& start, const Row& squared_slope, const Row& step, const Row& lowest, const Stage<T>& stage) {
  const Row sign = sign_of(phi);
  const Row before = sign * phi;
  const Row moved = larger(before + step * (1 - root(squared_slope)), smaller(before, lowest + kStair));  // [T-PDE-11]
  const Row mixed = stage.keep * (sign * start) + (1 - stage.keep) * moved;
  return sign * smaller(larger(mixed, row_of(kLeast)), row_of(stage.limit));
}

// Sums over rows, in their order.
struct RowSums {
  Row squared{}, least = row_of(1e300);
  template <class T>
  BURNISH_INLINE void add(const Row& change, const Row& value, const Stage<T>& stage) {
    const Row rate = change * (1 / stage.step), size = magnitude(value);
    squared += size < row_of(stage.counted) ? rate * rate : Row{};
    least = smaller(least, size);
  }
  BURNISH_INLINE StageSums total() const {
    StageSums sums{0, least[0]};
    for (int i = 0; i < kBlockSide; ++i) {
      sums.squared_rate += squared[i];
      sums.least = least[i] < sums.least ? least[i] : sums.least;
    }
    return sums;
  }
};

template <class Scheme, class T>
BURNISH_INLINE void advance_row(const HaloBlock& halo, const Stage<T>& stage, int j, int k, RowSums& sums) {
  constexpr int width = Scheme::kWidth;
  const double* center = &halo.values[HaloBlock::index(0, j, k)];
  const std::size_t first = node_index(0, j, k);
  const Row phi = load(center), sign = sign_of(phi);
  Row squared_slope{}, lowest = row_of(1e300);
  for (const int stride : HaloBlock::kStride) {
    Row v[2 * width + 1];
    for (int n = -width; n <= width; ++n) v[n + width] = load(center + n * stride);
    lowest = smaller(lowest, smaller(sign * v[width - 1], sign * v[width + 1]));
    const Row slope = upwind(Scheme::derivatives(v), sign);
    squared_slope += slope * slope;
  }
  const Row start = load(stage.start + first), own = start * (1 / stage.scale);
  const Row value = advanced(phi, own, squared_slope, row_of(stage.step), lowest, stage);
  if (stage.still == nullptr) {
    sums.add(value - own, value, stage);
    return store(value * stage.scale, stage.out + first);
  }
  const Mask still = lanes_of(stage.still[first / kBlockSide]);
  const Row kept = still ? own : value;
  sums.add(kept - own, kept, stage);
  store(still ? start : value * stage.scale, stage.out + first);
}

template <class T>
BURNISH_INLINE void keep_row(const Stage<T>& stage, int j, int k, RowSums& sums) {
  const Row start = load(stage.start + node_index(0, j, k));
  sums.add(Row{}, start * (1 / stage.scale), stage);
  store(start, stage.out + node_index(0, j, k));
}

// The values around eight nodes of a block, in lanes.
class Lanes {
 public:
  BURNISH_INLINE Lanes(const HaloBlock& halo, const CutNodes& cut) {
    for (std::size_t n = 0; n < kBlockSide; ++n) {
      const int node = cut.node[n];
      center_[n] = &halo.values[HaloBlock::index(node % 8, node / 8 % 8, node / 64)];
    }
  }
  BURNISH_INLINE Row at(int offset) const {
    alignas(64) std::array<double, kBlockSide> lanes;
    for (std::size_t n = 0; n < kBlockSide; ++n) lanes[n] = center_[n][offset];
    return load(lanes.data());
  }

 private:
  std::array<const double*, kBlockSide> center_;
};

// One-sided derivatives along an axis at cut nodes; `all` reaches three to each side.
template <class Scheme>
BURNISH_INLINE OneSided cut_derivatives(const Row (&all)[7], const Row& sign, const Row& below, const Row& above) {
  constexpr int width = Scheme::kWidth;
  Row v[2 * width + 1], p[7];
  for (int n = -width; n <= width; ++n) v[n + width] = all[n + 3];
  for (int n = 0; n < 7; ++n) p[n] = sign * all[n];
  OneSided d = Scheme::derivatives(v);
  const Row to_left = below > Row{} ? below : row_of(1), to_right = above > Row{} ? above : row_of(1);
  const Row left = above > Row{} ? p[3] / to_left : Scheme::slope_at_crossing(to_left, p[1], p[3], p[4], p[5]);
  const Row right = below > Row{} ? p[3] / to_right : Scheme::slope_at_crossing(to_right, p[5], p[3], p[2], p[1]);
  d.left = below > Row{} ? sign * left : d.left;
  d.right = above > Row{} ? -sign * right : d.right;
  return d;
}

// Eight cut nodes at once: gathered, computed in lanes, scattered. [T-PDE-5]
template <class Scheme, class T>
BURNISH_INLINE void advance_cut(const HaloBlock& halo, const Stage<T>& stage, const CutNodes& cut, RowSums& sums) {
  alignas(64) std::array<double, kBlockSide> lanes;
  for (std::size_t n = 0; n < kBlockSide; ++n) lanes[n] = stage.start[cut.node[n]];
  const Row own = load(lanes.data()) * (1 / stage.scale);
  const Lanes around(halo, cut);
  const Row phi = around.at(0), sign = sign_of(phi);
  Row squared_slope{}, lowest = row_of(1e300);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    Row all[7];
    for (int n = -3; n <= 3; ++n)
      all[n + 3] = n >= -Scheme::kWidth && n <= Scheme::kWidth ? around.at(n * HaloBlock::kStride[axis]) : Row{};
    lowest = smaller(lowest, smaller(sign * all[2], sign * all[4]));
    const Row below = load(cut.crossing[2 * axis].data()), above = load(cut.crossing[2 * axis + 1].data());
    const Row slope = upwind(cut_derivatives<Scheme>(all, sign, below, above), sign);
    squared_slope += slope * slope;
  }
  const Row value = advanced(phi, own, squared_slope, load(cut.step.data()) * stage.step, lowest, stage);
  const Mask lane{0, 1, 2, 3, 4, 5, 6, 7};
  const Mask counts = lane < (Mask{} + static_cast<std::int64_t>(cut.count));
  sums.add(counts ? value - own : Row{}, value, stage);
  store(value * stage.scale, lanes.data());
  for (std::size_t n = 0; n < cut.count; ++n) stage.out[cut.node[n]] = static_cast<T>(lanes[n]);
}

template <class Scheme, class T>
BURNISH_INLINE StageSums advance(const HaloBlock& halo, const Stage<T>& stage) {
  RowSums sums;
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j)
      if (stage.still == nullptr || stage.still[j + kBlockSide * k] != 0xff)
        advance_row<Scheme>(halo, stage, j, k, sums);
      else
        keep_row(stage, j, k, sums);
  for (std::size_t c = 0; c < stage.cut_count; ++c) advance_cut<Scheme>(halo, stage, stage.cut[c], sums);
  return sums.total();
}

template <class T>
BURNISH_INLINE void fill_rows(const T* from, int side, int axis, int width, double scale, HaloBlock& halo) {
  // The layers across a face along y or z; `side` is -1 or 1. A block without a neighbour goes on as its last layer.
  for (int n = 0; n < width; ++n)
    for (int m = 0; m < kBlockSide; ++m) {
      const int to = side < 0 ? n - width : kBlockSide + n, source = side < 0 ? kBlockSide - width + n : n;
      const Row row = load(from + (axis == 1 ? node_index(0, source, m) : node_index(0, m, source)));
      store(row * scale, &halo.at(0, axis == 1 ? to : m, axis == 1 ? m : to));
    }
}

template <class T>
BURNISH_INLINE void fill_blocks(const BlockFaces<T>& blocks, double scale, int width, HaloBlock& halo) {
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j) {
      const std::size_t row = node_index(0, j, k);
      store(load(blocks.own + row) * scale, &halo.at(0, j, k));
      const T* below = blocks.across[0];
      const T* above = blocks.across[1];
      for (int n = 0; n < width; ++n) {
        halo.at(-1 - n, j, k) = (below != nullptr ? below[row + static_cast<std::size_t>(kBlockSide - 1 - n)] : blocks.own[row]) * scale;
        halo.at(kBlockSide + n, j, k) = (above != nullptr ? above[row + static_cast<std::size_t>(n)] : blocks.own[row + kBlockSide - 1]) * scale;
      }
    }
  for (int axis = 1; axis < 3; ++axis)
    for (const int side : {-1, 1}) {
      const T* across = blocks.across[static_cast<std::size_t>(2 * axis + (side > 0))];
      if (across != nullptr) {
        fill_rows(across, side, axis, width, scale, halo);
        continue;
      }
      for (int n = 0; n < width; ++n)
        for (int m = 0; m < kBlockSide; ++m) {
          const int to = side < 0 ? -1 - n : kBlockSide + n, source = side < 0 ? 0 : kBlockSide - 1;
          store(load(&halo.at(0, axis == 1 ? source : m, axis == 1 ? m : source)), &halo.at(0, axis == 1 ? to : m, axis == 1 ? m : to));
        }
    }
}

}  // namespace

BURNISH_DISPATCH void fill(const BlockFaces<float>& blocks, double scale, int width, HaloBlock& halo) { fill_blocks(blocks, scale, width, halo); }
BURNISH_DISPATCH void fill(const BlockFaces<double>& blocks, double scale, int width, HaloBlock& halo) { fill_blocks(blocks, scale, width, halo); }

BURNISH_DISPATCH StageSums weno5_stage(const HaloBlock& halo, const Stage<float>& stage) { return advance<Weno5>(halo, stage); }
BURNISH_DISPATCH StageSums weno5_stage(const HaloBlock& halo, const Stage<double>& stage) { return advance<Weno5>(halo, stage); }
BURNISH_DISPATCH StageSums first_order_stage(const HaloBlock& halo, const Stage<float>& stage) { return advance<FirstOrder>(halo, stage); }
BURNISH_DISPATCH StageSums first_order_stage(const HaloBlock& halo, const Stage<double>& stage) { return advance<FirstOrder>(halo, stage); }

}  // namespace burnish::detail
