#include "closest_point_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>

#include "burnish/core/vec.h"
#include "kernel_rows.h"
#include "quintic.h"
#include "tricubic.h"

namespace burnish::detail {
namespace {

constexpr int kNewtonSteps = 10;
constexpr double kFlattest = 1e-16;     // squared gradient below which there is no direction
constexpr double kLeastCurvature = 0.05;  // of half the squared distance along the surface, which has 1 on a plane: below it, as on a plane
constexpr double kSlack = 0.1;          // cells by which an edge's linear crossing may be nearer than Newton's point
constexpr double kRefineSlack = 0.02;   // cells by which a refined point may be farther than the one it started from
constexpr double kRefineMove = 2;       // cells that a refined point may move
constexpr double kDistantMove = 8;      // the same for nodes of coarser leaves
constexpr int kRowsOfBlock = kBlockSide * kBlockSide;

// Steps shorter than this leave an error of their square: below the rounding of T. [T-REDIST-1]
template <class T>
constexpr double kShortStep = sizeof(T) == sizeof(float) ? 1e-3 : 1e-7;
// Where the quintic interpolant has the last word, what they leave along the surface counts: its square. [T-REDIST-5]
template <class T>
constexpr double kShortBeforeQuintic = sizeof(T) == sizeof(float) ? 0.03 : 3e-4;
constexpr double kSmoothSurface = 0.05;  // cells between the cubic's and the quintic's surface: beyond it phi is not smooth
// Bounds are this much below the squared distance, so that rounding alone never moves a node to another point.
template <class T>
constexpr T kBetter = 1 - 8 * std::numeric_limits<T>::epsilon();

template <class T>
BURNISH_INLINE int place_of(const Surroundings<T>& around, int i, int j, int k) {
  const int side = kBlockSide + 2 * around.width;
  return (i + around.width) + side * ((j + around.width) + side * (k + around.width));
}

struct Foot {
  Vec3 offset;  // from the node
  bool found = false;
};

// The cell in whose polynomial a point is looked for: kept until the point is well outside, so that the steps end at cell faces too.
struct Cell {
  std::array<int, 3> at{};
  bool within = false;

  BURNISH_INLINE void follow(const Vec3& y, int width) {
    within = true;
    for (int a = 0; a < 3; ++a) {
      int& c = at[static_cast<std::size_t>(a)];
      const double t = y[a] - c;
      if (!(t >= -0.125 && t <= 1.125)) c = static_cast<int>(std::floor(y[a]));
      within = within && c > -width && c < kBlockSide + width - 2;
    }
  }
};

// How far to move from y towards the closest point of x on the surface. [T-REDIST-1]
BURNISH_INLINE Vec3 newton_step(const SecondOrder& f, double g2, const Vec3& r) {
  const Vec3& g = f.gradient;
  const double inverse = 1 / g2, off = f.value * inverse, lambda = dot(r, g) * inverse;
  // Tangents at right angles, neither of unit length: that costs no root.
  const bool along_x = std::abs(g.x) > std::abs(g.z);
  const Vec3 t1{along_x ? -g.y : 0, along_x ? g.x : -g.z, along_x ? 0 : g.y}, t2 = cross(g, t1);
  const double l1 = squared_norm(t1), l2 = g2 * l1;
  const Vec3 h1 = f.hessian(t1), h2 = f.hessian(t2);
  double m11 = l1 + lambda * dot(t1, h1), m22 = l2 + lambda * dot(t2, h2), m12 = lambda * dot(t1, h2);
  double r1 = dot(r, t1), r2 = dot(r, t2), det = m11 * m22 - m12 * m12;
  if (m11 > kLeastCurvature * l1 && m22 > kLeastCurvature * l2 && det > kLeastCurvature * l1 * l2) {
    r1 += off * lambda * dot(h1, g);
    r2 += off * lambda * dot(h2, g);
  } else {
    m11 = l1;
    m22 = l2;
    m12 = 0;
    det = l1 * l2;
  }
  const double solve = 1 / det, along1 = (m22 * r1 - m12 * r2) * solve, along2 = (m11 * r2 - m12 * r1) * solve;
  return t1 * along1 + t2 * along2 - g * off;
}

// From y along the gradient to the quintic interpolant's surface. False where its nodes are not all there, or phi is not smooth. [T-REDIST-5]
template <class T>
BURNISH_INLINE bool move_to_quintic(const Surroundings<T>& around, const Cell& cell, const Vec3& gradient, double g2, Vec3& y) {
  const auto [i, j, k] = cell.at;
  const int low = 2 - around.width, high = kBlockSide + around.width - 4;
  if (i < low || j < low || k < low || i > high || j > high || k > high) return false;
  const T* corner = around.phi + place_of(around, i - 2, j - 2, k - 2);
  const Vec3 move = gradient * (-triquintic(corner, kBlockSide + 2 * around.width, y - Vec3{double(i), double(j), double(k)}) / g2);
  if (!(squared_norm(move) <= kSmoothSurface * kSmoothSurface)) return false;
  y += move;
  return true;
}

// The closest point of node x, from y on; `sign` is that of phi at x.
template <class T>
BURNISH_INLINE Foot closest_from(const Surroundings<T>& around, const Vec3& x, Vec3 y, double sign, double reach) {
  Cell cell;
  for (int a = 0; a < 3; ++a) cell.at[static_cast<std::size_t>(a)] = -1000;
  const int side = kBlockSide + 2 * around.width;
  double enough = kShortBeforeQuintic<T>;
  for (int step = 0; step < kNewtonSteps; ++step) {
    cell.follow(y, around.width);
    if (!cell.within) return {};
    const auto [i, j, k] = cell.at;
    const SecondOrder f = tricubic(around.phi + place_of(around, i - 1, j - 1, k - 1), side, y - Vec3{double(i), double(j), double(k)});
    const double g2 = squared_norm(f.gradient);
    if (!(g2 > kFlattest)) return {};
    Vec3 move = newton_step(f, g2, x - y);
    const double length2 = squared_norm(move);
    if (length2 > 1) move *= 1 / std::sqrt(length2);
    y += move;
    if (!(length2 < enough * enough)) continue;
    if (enough > kShortStep<T> && !move_to_quintic(around, cell, f.gradient, g2, y)) {
      enough = kShortStep<T>;
      if (!(length2 < enough * enough)) continue;
    }
    const Vec3 d = y - x;
    // The surface must be met from the node's own side.
    return {d, squared_norm(d) <= reach * reach && sign * dot(d, f.gradient) <= 1e-3 * std::sqrt(g2)};
  }
  return {};
}

// The nearest crossing of the node's own edges, by linear interpolation; infinite if none is crossed.
template <class T>
BURNISH_INLINE double own_crossing(const T* phi, int side) {
  double least = std::numeric_limits<double>::infinity();
  for (const int step : {1, -1, side, -side, side * side, -side * side}) {
    const double p = phi[0], q = phi[step];
    if ((p >= 0) != (q >= 0)) least = std::min(least, p / (p - q));
  }
  return least;
}

// The closest crossing of the lattice edges within one node. [T-REDIST-1]
template <class T>
Vec3 closest_edge_crossing(const T* center, int side) {
  Vec3 best;
  double least = std::numeric_limits<double>::infinity();
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        for (int axis = 0; axis < 3; ++axis) {
          const T* from = center + dx + side * (dy + side * dz);
          const double p = from[0], q = from[axis == 0 ? 1 : axis == 1 ? side : side * side];
          if ((p >= 0) == (q >= 0)) continue;
          Vec3 d{double(dx), double(dy), double(dz)};
          d[axis] += p / (p - q);
          if (squared_norm(d) >= least) continue;
          least = squared_norm(d);
          best = d;
        }
  return best;
}

template <class T>
BURNISH_INLINE Foot seed_node(const Surroundings<T>& around, int i, int j, int k) {
  const int side = kBlockSide + 2 * around.width;
  const T* center = around.phi + place_of(around, i, j, k);
  const Vec3 x{double(i), double(j), double(k)};
  const double sign = center[0] >= 0 ? 1 : -1, own = own_crossing(center, side) + kSlack;
  Vec3 start;
  for (int attempt = 0; attempt < 2; ++attempt) {
    const Foot foot = closest_from(around, x, x + start, sign, kSeedReach);
    if (foot.found && squared_norm(foot.offset) <= own * own) return foot;
    if (attempt == 0) start = closest_edge_crossing(center, side);
  }
  return {start, false};
}

template <class Visit>
BURNISH_INLINE void for_each_bit(const NodeBits& bits, Visit&& visit) {
  for (int row = 0; row < kRowsOfBlock; ++row)
    for (unsigned left = bits[static_cast<std::size_t>(row)]; left != 0; left &= left - 1)
      visit(std::countr_zero(left), row % kBlockSide, row / kBlockSide);
}

template <class T>
BURNISH_INLINE void seed_block(const Surroundings<T>& around, const NodeBits& beside, ClosestPoints<T>& points, NodeBits& exact) {
  for_each_bit(beside, [&](int i, int j, int k) __attribute__((always_inline)) {
    const Foot foot = seed_node(around, i, j, k);
    put(points, node_index(i, j, k), foot.offset, foot.found);
    if (foot.found) add(exact, node_index(i, j, k));
  });
}

BURNISH_INLINE int octant_of(double at) { return at < 0 ? -1 : at >= kBlockSide ? 1 : 0; }

// Never much farther than the point it starts from, nor far from that.
template <class T>
BURNISH_INLINE Foot refined(const Surroundings<T>& around, const Vec3& x, const Vec3& offset, double sign, double most) {
  Foot foot = closest_from(around, x, x + offset, sign, norm(offset) + kRefineSlack);
  foot.found = foot.found && squared_norm(foot.offset - offset) <= most * most;
  return foot;
}

template <class T>
BURNISH_INLINE void refine_distant(const Surroundings<T>& around, DistantNode& node) {
  const Foot foot = refined(around, node.at, node.offset, node.sign, kDistantMove);
  node.refined = foot.found;
  if (foot.found) node.offset = foot.offset;
}

template <class T>
BURNISH_INLINE void refine_block(const Surroundings<T>& around, double reach, std::uint32_t octants, ClosestPoints<T>& points,
                                 NodeBits& exact) {
  const double limit = (reach + 0.25) * (reach + 0.25);
  for (int row = 0; row < kRowsOfBlock; ++row)
    for (int i = 0; i < kBlockSide; ++i) {
      const int j = row % kBlockSide, k = row / kBlockSide;
      const std::size_t n = node_index(i, j, k);
      if (points.bound[n] > limit || has(exact, n)) continue;
      const Vec3 x{double(i), double(j), double(k)}, d{points.x[n], points.y[n], points.z[n]}, y = x + d;
      if (((octants >> direction(octant_of(y.x), octant_of(y.y), octant_of(y.z))) & 1) == 0) continue;
      const double sign = around.phi[place_of(around, i, j, k)] >= 0 ? 1 : -1;
      const Foot foot = refined(around, x, d, sign, kRefineMove);
      if (!foot.found) continue;
      put(points, n, foot.offset, true);
      add(exact, n);
    }
}

// Eight values in vector registers of whatever width the processor has.
template <class T>
struct Vectors;
template <>
struct Vectors<float> {
  typedef float Row __attribute__((vector_size(kBlockSide * sizeof(float))));
  typedef std::int32_t Mask __attribute__((vector_size(kBlockSide * sizeof(float))));
};
template <>
struct Vectors<double> {
  typedef double Row __attribute__((vector_size(kBlockSide * sizeof(double))));
  typedef std::int64_t Mask __attribute__((vector_size(kBlockSide * sizeof(double))));
};
template <class T>
using Row = typename Vectors<T>::Row;
template <class T>
using Mask = typename Vectors<T>::Mask;
typedef std::int8_t Bytes __attribute__((vector_size(kBlockSide)));

template <class T>
BURNISH_INLINE Row<T> load_row(const T* from) {
  Row<T> row;
  std::memcpy(&row, from, sizeof row);
  return row;
}
template <class T>
BURNISH_INLINE void store_row(const Row<T>& row, T* to) {
  std::memcpy(to, &row, sizeof row);
}

// A bit per lane.
template <class T>
BURNISH_INLINE std::uint8_t bits_of(const Mask<T>& mask) {
  const Bytes bytes = __builtin_convertvector(mask, Bytes);
  std::uint64_t all;
  std::memcpy(&all, &bytes, sizeof all);
  return static_cast<std::uint8_t>(((all & 0x8040201008040201u) * 0x0101010101010101u) >> 56);
}
template <class T>
BURNISH_INLINE Mask<T> lanes_of(unsigned bits) {
  const Mask<T> bit{1, 2, 4, 8, 16, 32, 64, 128};
  return (bit & static_cast<std::conditional_t<sizeof(T) == 4, std::int32_t, std::int64_t>>(bits)) != 0;
}
template <class T>
BURNISH_INLINE T least_of(const Row<T>& row) {
  T least = row[0];
  for (int i = 1; i < kBlockSide; ++i) least = std::min(least, row[i]);
  return least;
}

template <class T>
BURNISH_INLINE NodeBits beside_surface_in(const Surroundings<T>& around) {
  constexpr int side = kBlockSide + 2;
  std::array<std::uint16_t, std::size_t{side} * side> negative;  // ten bits, of nodes -1 to 8
  for (int k = -1; k <= kBlockSide; ++k)
    for (int j = -1; j <= kBlockSide; ++j) {
      const T* row = around.phi + place_of(around, -1, j, k);
      const unsigned low = bits_of<T>(load_row(row) < T{0});
      negative[static_cast<std::size_t>((j + 1) + side * (k + 1))] =
          static_cast<std::uint16_t>(low | unsigned{row[8] < T{0}} << 8 | unsigned{row[9] < T{0}} << 9);
    }
  NodeBits beside;
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j) {
      unsigned some = 0, all = ~0u;
      for (int c = 0; c < 3; ++c)
        for (int b = 0; b < 3; ++b) {
          const unsigned row = negative[static_cast<std::size_t>((j + b) + side * (k + c))];
          some |= row;
          all &= row;
        }
      some = some | some >> 1 | some >> 2;
      all = all & all >> 1 & all >> 2;
      beside[static_cast<std::size_t>(j + kBlockSide * k)] = static_cast<std::uint8_t>(some & ~all);
    }
  return beside;
}

template <class T>
BURNISH_INLINE T publish_block(const ClosestPoints<T>& points, double radius, NodeBits& open, PublishedPoints<T>& out) {
  const T r2 = static_cast<T>(radius * radius), infinite = std::numeric_limits<T>::infinity();
  Row<T> least = Row<T>{} + infinite;
  for (std::size_t row = 0; row < kRowsOfBlock; ++row) {
    out.nodes[row] = 0;
    if (open[row] == 0) continue;
    const std::size_t n = row * kBlockSide;
    const Row<T> bound = load_row(&points.bound[n]);
    const Mask<T> is_open = lanes_of<T>(open[row]), comes = is_open & (bound <= r2);
    const Row<T> stays = (is_open & ~comes) ? bound : Row<T>{} + infinite;
    least = stays < least ? stays : least;
    const std::uint8_t bits = bits_of<T>(comes);
    if (bits == 0) continue;
    open[row] = static_cast<std::uint8_t>(open[row] & ~bits);
    out.nodes[row] = bits;
    store_row<T>(comes ? load_row(&points.x[n]) : Row<T>{} + infinite, &out.x[n]);
    store_row<T>(load_row(&points.y[n]), &out.y[n]);
    store_row<T>(load_row(&points.z[n]), &out.z[n]);
  }
  return least_of<T>(least);
}

// The best point for the nodes of a row so far.
template <class T>
struct Best {
  Row<T> x, y, z, d2;
  Mask<T> better;

  // From the neighbours of the row at (dy, dz) from it.
  BURNISH_INLINE void take(const FrontPoints<T>& front, int j, int k, int dy, int dz) {
    for (int dx = -1; dx <= 1; ++dx) {
      const std::size_t at = front.index(dx, j + dy, k + dz);
      const Row<T> px = load_row(&front.x[at]) + static_cast<T>(dx), py = load_row(&front.y[at]) + static_cast<T>(dy),
                   pz = load_row(&front.z[at]) + static_cast<T>(dz);
      const Row<T> found = px * px + (py * py + pz * pz);
      const Mask<T> nearer = found < d2;
      x = nearer ? px : x;
      y = nearer ? py : y;
      z = nearer ? pz : z;
      d2 = nearer ? found : d2;
      better |= nearer;
    }
  }
};

template <class T>
BURNISH_INLINE T spread_block(const FrontPoints<T>& front, double settled, ClosestPoints<T>& points, NodeBits& open, NodeBits& exact) {
  const Row<T> infinite = Row<T>{} + std::numeric_limits<T>::infinity(), low = Row<T>{} + static_cast<T>(settled * settled);
  Row<T> least = infinite;
  for (int k = 0; k < kBlockSide; ++k)
    for (int j = 0; j < kBlockSide; ++j) {
      const std::array<unsigned, 3> sources{front.rows_around(j, k - 1), front.rows_around(j, k), front.rows_around(j, k + 1)};
      if ((sources[0] | sources[1] | sources[2]) == 0) continue;
      const auto row = static_cast<std::size_t>(j + kBlockSide * k), n = row * kBlockSide;
      const Row<T> own = load_row(&points.bound[n]);
      const Mask<T> wants = own > low;
      if (bits_of<T>(wants) == 0) continue;
      Best<T> best{{}, {}, {}, wants ? own : Row<T>{}, {}};
      for (int dz = -1; dz <= 1; ++dz)
        for (int dy = -1; dy <= 1; ++dy)
          if ((sources[static_cast<std::size_t>(dz + 1)] >> (dy + 1) & 1) != 0) best.take(front, j, k, dy, dz);
      const std::uint8_t bits = bits_of<T>(best.better);
      if (bits == 0) continue;
      const Row<T> bound = best.d2 * kBetter<T>;
      store_row<T>(best.better ? best.x : load_row(&points.x[n]), &points.x[n]);
      store_row<T>(best.better ? best.y : load_row(&points.y[n]), &points.y[n]);
      store_row<T>(best.better ? best.z : load_row(&points.z[n]), &points.z[n]);
      store_row<T>(best.better ? bound : own, &points.bound[n]);
      const Row<T> fresh = best.better ? bound : infinite;
      least = fresh < least ? fresh : least;
      open[row] |= bits;
      exact[row] = static_cast<std::uint8_t>(exact[row] & ~bits);
    }
  return least_of<T>(least);
}

}  // namespace

#define BURNISH_INSTANTIATE(T)                                                                                                           \
  template <>                                                                                                                            \
  BURNISH_DISPATCH NodeBits beside_surface(const Surroundings<T>& around) {                                                             \
    return beside_surface_in(around);                                                                                                    \
  }                                                                                                                                      \
  template <>                                                                                                                            \
  BURNISH_DISPATCH void seed(const Surroundings<T>& around, const NodeBits& beside, ClosestPoints<T>& points, NodeBits& exact) {       \
    seed_block(around, beside, points, exact);                                                                                           \
  }                                                                                                                                      \
  template <>                                                                                                                            \
  BURNISH_DISPATCH void refine(const Surroundings<T>& around, double reach, std::uint32_t octants, ClosestPoints<T>& points,             \
                               NodeBits& exact) {                                                                                       \
    refine_block(around, reach, octants, points, exact);                                                                                 \
  }                                                                                                                                      \
  template <>                                                                                                                            \
  BURNISH_DISPATCH void refine(const Surroundings<T>& around, DistantNode& node) {                                                       \
    refine_distant(around, node);                                                                                                        \
  }                                                                                                                                      \
  template <>                                                                                                                            \
  BURNISH_DISPATCH T publish(const ClosestPoints<T>& points, double radius, NodeBits& open, PublishedPoints<T>& out) {                  \
    return publish_block(points, radius, open, out);                                                                                     \
  }                                                                                                                                      \
  template <>                                                                                                                            \
  BURNISH_DISPATCH T spread(const FrontPoints<T>& front, double settled, ClosestPoints<T>& points, NodeBits& open, NodeBits& exact) {  \
    return spread_block(front, settled, points, open, exact);                                                                            \
  }

BURNISH_INSTANTIATE(float)
BURNISH_INSTANTIATE(double)

}  // namespace burnish::detail
