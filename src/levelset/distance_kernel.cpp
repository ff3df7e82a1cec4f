#include "distance_kernel.h"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <new>

#include "kernel_rows.h"

namespace burnish::detail {
namespace {

// Slivers whose height over their longest side is below the root of this have no reliable plane; their edges serve.
constexpr double kFlat = 1e-22;
// Triangles whose height over their longest side is above the root of this have unit vectors good to 1e-13.
constexpr double kWellShaped = 1e-6;

BURNISH_INLINE double largest_of(const Row& row) {
  Row other = __builtin_shufflevector(row, row, 4, 5, 6, 7, 0, 1, 2, 3);
  Row most = row < other ? other : row;
  other = __builtin_shufflevector(most, most, 2, 3, 0, 1, 6, 7, 4, 5);
  most = most < other ? other : most;
  return std::max(most[0], most[1]);
}

// A well-shaped triangle prepared for many rows: seven functions of the point, each linear, say where it is. [T-DIST-1]
class WellShaped {
 public:
  BURNISH_INLINE explicit WellShaped(const std::array<Vec3, 3>& v) {
    const Vec3 n = cross(v[1] - v[0], v[2] - v[0]);
    const Vec3 unit = n / norm(n);  // divided, so that it is exact along the axes
    set(kHeight, unit, v[0]);
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 e = v[(i + 1) % 3] - v[i];
      length_[i] = norm(e);
      const Vec3 t = e / length_[i];
      set(kAlong + i, t, v[i]);
      set(kInwards + i, cross(unit, t), v[i]);
    }
  }

  // Squared distances of the eight points (x + i, y, z), i = 0..7.
  BURNISH_INLINE Row squared_distances(double x, double y, double z) const {
    alignas(64) std::array<double, kBlockSide> base;  // the functions at (x, y, z)
    store(load(x0_.data()) * x + (load(y_.data()) * y + (load(z_.data()) * z + load(origin_.data()))), base.data());
    Row in_plane = row_of(1e300), inside = row_of(1e300);
    for (std::size_t i = 0; i < 3; ++i) {
      const Row across = x_[kInwards + i] + base[kInwards + i], at = x_[kAlong + i] + base[kAlong + i];
      const Row beyond = at - smaller(row_of(length_[i]), larger(Row{}, at));
      in_plane = smaller(in_plane, across * across + beyond * beyond);
      inside = smaller(inside, across);
    }
    const Row above = x_[kHeight] + base[kHeight];
    return above * above + (inside >= Row{} ? Row{} : in_plane);
  }

 private:
  // The height above the plane; in the plane, how far inwards from each edge, and how far along it.
  static constexpr std::size_t kHeight = 0, kInwards = 1, kAlong = 4;

  BURNISH_INLINE void set(std::size_t function, const Vec3& direction, const Vec3& zero_at) {
    x_[function] = Row{0, 1, 2, 3, 4, 5, 6, 7} * direction.x;
    x0_[function] = direction.x;
    y_[function] = direction.y;
    z_[function] = direction.z;
    origin_[function] = -dot(direction, zero_at);
  }

  std::array<Row, 7> x_;  // of each function, what x adds for the eight points of a row
  alignas(64) std::array<double, kBlockSide> x0_{}, y_{}, z_{}, origin_{};
  std::array<double, 3> length_;
};

BURNISH_INLINE double inverse_or_zero(double v) { return v > 0 ? 1 / v : 0; }

// Any other triangle: slivers, and those without area. Edges with inverse squared lengths, normal with inverse squared length.
struct AnyShape {
  std::array<Vec3, 3> v;
  std::array<Vec3, 3> edge;
  std::array<double, 3> inverse_edge;  // 1 / |edge|^2, or 0
  Vec3 n;
  double inverse_n;                    // 1 / |n|^2, or 0 for a triangle without area
  std::array<Vec3, 3> inwards;         // normals of the edges in the triangle's plane: n x edge

  BURNISH_INLINE explicit AnyShape(const std::array<Vec3, 3>& corners) {
    const double ab2 = squared_norm(corners[1] - corners[0]), bc2 = squared_norm(corners[2] - corners[1]),
                 ca2 = squared_norm(corners[0] - corners[2]);
    // The longest edge is to be the last one: see `height` below.
    const std::size_t first = ab2 > ca2 && ab2 >= bc2 ? 1 : bc2 > ca2 ? 2 : 0;
    for (std::size_t i = 0; i < 3; ++i) v[i] = corners[(first + i) % 3];
    for (std::size_t i = 0; i < 3; ++i) {
      edge[i] = v[(i + 1) % 3] - v[i];
      inverse_edge[i] = inverse_or_zero(squared_norm(edge[i]));
    }
    n = cross(edge[0], v[2] - v[0]);
    const double n2 = squared_norm(n), longest = squared_norm(edge[2]);
    inverse_n = n2 > kFlat * longest * longest ? 1 / n2 : 0;  // [T-DIST-2]
    for (std::size_t i = 0; i < 3; ++i) inwards[i] = cross(n, edge[i]);
  }

  BURNISH_INLINE Row squared_distances(double x0, double y, double z) const {
    const Row x = Row{0, 1, 2, 3, 4, 5, 6, 7} + x0;
    Row best = row_of(1e300), inside = row_of(1e300);
    Row u, v_, w;
    for (std::size_t i = 0; i < 3; ++i) {
      const Row px = x - v[i].x;
      const double py = y - v[i].y, pz = z - v[i].z;
      // The closest point of the edge, by its parameter clamped to [0, 1].
      Row s = (px * edge[i].x + (py * edge[i].y + pz * edge[i].z)) * inverse_edge[i];
      s = smaller(larger(s, Row{}), row_of(1));
      u = px - s * edge[i].x, v_ = py - s * edge[i].y, w = pz - s * edge[i].z;
      best = smaller(best, u * u + v_ * v_ + w * w);
      inside = smaller(inside, px * inwards[i].x + (py * inwards[i].y + pz * inwards[i].z));
    }
    if (!(inverse_n > 0)) return best;
    // The plane's distance where the projection falls inside all three edges, measured from the closest point of the longest
    // edge: nothing inside a sliver is far from it, so that the error of a sliver's normal does no harm.
    const Row height = u * n.x + (v_ * n.y + w * n.z);
    return inside >= Row{} ? height * height * inverse_n : best;
  }
};

BURNISH_INLINE bool is_well_shaped(const std::array<Vec3, 3>& v) {
  const double longest = std::max({squared_norm(v[1] - v[0]), squared_norm(v[2] - v[1]), squared_norm(v[0] - v[2])});
  return squared_norm(cross(v[1] - v[0], v[2] - v[0])) > kWellShaped * longest * longest;
}

template <class Triangle>
BURNISH_INLINE void update_row(const Triangle& triangle, double facet, int r, int j, int k, const NodeRows nodes) {
  const Row found = triangle.squared_distances(kBlockSide * r, j, k);
  const std::size_t row = nodes.row_index(r, j, k);
  double* squared = nodes.squared + row * kBlockSide;
  double* id = nodes.id + row * kBlockSide;
  const Row old = load(squared);
  const Mask nearer = found < old;
  const Row least = nearer ? found : old;
  store(least, squared);
  store(nearer ? row_of(facet) : load(id), id);
  nodes.row_max[row] = largest_of(least);
}

BURNISH_INLINE double distance_to_range(double x, double low, double high) { return std::max({low - x, x - high, 0.0}); }

// Where an item is to be scattered to: its triangle is prepared when the first row wants it.
template <class Triangle>
BURNISH_INLINE void scatter_item(const ScatterItem& item, double reach, double limit, const NodeRows nodes) {
  bool prepared = false;
  alignas(64) unsigned char memory[sizeof(Triangle)];
  auto* triangle = reinterpret_cast<Triangle*>(memory);
  const int first_layer = static_cast<int>(std::max(item.low.z - reach, 0.0));
  const int last_layer = static_cast<int>(std::min(item.high.z + reach, nodes.depth - 1.0));
  for (int r = 0; r < nodes.rows; ++r) {
    const double dx = std::max({item.low.x - (kBlockSide * r + kBlockSide - 1), kBlockSide * r - item.high.x, 0.0});
    if (dx * dx >= limit) continue;
    for (int first = 0; first < nodes.height; first += kBlockSide) {
      const Row y = Row{0, 1, 2, 3, 4, 5, 6, 7} + static_cast<double>(first);
      const Row dy = larger(larger(item.low.y - y, y - item.high.y), Row{});
      const Row dxy2 = dy * dy + dx * dx;
      for (int k = first_layer; k <= last_layer; ++k) {
        const double dz = distance_to_range(k, item.low.z, item.high.z);
        const Row bound = dxy2 + dz * dz;  // of the squared distances of whole rows [T-DIST-3]
        const Row most = smaller(load(nodes.row_max + nodes.row_index(r, first, k)), row_of(limit));
        std::uint64_t left = bytes_of(bound < most);
        if (left == 0) continue;
        if (!prepared) new (triangle) Triangle(item.corners);
        prepared = true;
        while (left != 0) {
          const int j = std::countr_zero(left) / 8;
          left &= ~(std::uint64_t{0xff} << (8 * j));
          update_row(*triangle, item.facet, r, first + j, k, nodes);
        }
      }
    }
  }
}

}  // namespace

BURNISH_DISPATCH
void scatter(const ScatterItem* items, std::size_t count, double reach, NodeRows nodes) {
  const double limit = std::nextafter(reach * reach, 1e300);
  for (std::size_t i = 0; i < count; ++i)
    if (is_well_shaped(items[i].corners))
      scatter_item<WellShaped>(items[i], reach, limit, nodes);
    else
      scatter_item<AnyShape>(items[i], reach, limit, nodes);
}

BURNISH_DISPATCH
void roots(const double* squared, float* distance) {
  for (std::size_t i = 0; i < kBlockNodes; ++i) distance[i] = static_cast<float>(std::sqrt(squared[i]));
}

}  // namespace burnish::detail
