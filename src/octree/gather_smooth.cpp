#include <array>
#include <cstring>
#include <vector>

#include "burnish/octree/field.h"
#include "lattice_lookup.h"

namespace burnish {
namespace {

using namespace detail;

// Lagrange weights at t in [0, 1) for nodes 1 - points/2 ... points/2. [T-HALO-2]
template <int points>
std::array<double, points> lagrange_weights(double t) {
  std::array<double, points> weights;
  constexpr int first = 1 - points / 2;
  for (int i = 0; i < points; ++i) {
    double w = 1;
    for (int j = 0; j < points; ++j)
      if (j != i) w *= (t - (first + j)) / (i - j);
    weights[static_cast<std::size_t>(i)] = w;
  }
  return weights;
}

// What one axis contributes to an interpolated node: coarse nodes first, first + step, ... with their weights.
template <int points>
struct AxisStencil {
  std::int32_t first = 0, step = 0;
  int count = 1;
  std::array<double, points> weights{1};

  AxisStencil(std::int32_t at, std::int32_t rest, std::int32_t cell) : first(at - rest), step(cell) {
    if (rest == 0) return;
    first -= (points / 2 - 1) * cell;
    count = points;
    weights = lagrange_weights<points>(static_cast<double>(rest) / cell);
  }
};

// The value at any lattice node: stored, or interpolated from the nodes of the leaf's own level, which may be interpolated themselves.
template <int points, class T>
double smooth_value(const Octree& tree, const Field<T>& field, std::uint32_t near, const LatticeNode& node) {
  const LocatedNode at = locate(tree, near, node);
  if (!field.stores(at.leaf)) return field.block(at.leaf)[0];
  if (at.is_stored()) return field.block(at.leaf)[at.place()];
  const std::int32_t cell = at.mask + 1;
  const AxisStencil<points> x(node.x, at.local[0] & at.mask, cell), y(node.y, at.local[1] & at.mask, cell), z(node.z, at.local[2] & at.mask, cell);
  double sum = 0;
  for (int c = 0; c < z.count; ++c)
    for (int b = 0; b < y.count; ++b)
      for (int a = 0; a < x.count; ++a)
        sum += x.weights[static_cast<std::size_t>(a)] * y.weights[static_cast<std::size_t>(b)] * z.weights[static_cast<std::size_t>(c)] *
               smooth_value<points>(tree, field, at.leaf, {x.first + a * x.step, y.first + b * y.step, z.first + c * z.step});
  return sum;
}

// The part of a halo that lies in one coarser leaf: every second node is that leaf's lattice's, the others are half-way between.
template <int points, class T>
class CoarsePatch {
 public:
  // Halo nodes low ... high - 1 of `leaf`, in its own cells.
  CoarsePatch(const Octree& tree, const Field<T>& field, std::size_t leaf, std::uint32_t coarse, const std::array<Range, 3>& halo) {
    for (std::size_t a = 0; a < 3; ++a) {
      low_[a] = (halo[a].begin >> 1) - (points / 2 - 1);
      side_[a] = ((halo[a].end - 1) >> 1) + points / 2 + 1 - low_[a];
    }
    values_.resize(static_cast<std::size_t>(side_[0] * side_[1] * side_[2]));
    double* out = values_.data();
    for (int k = 0; k < side_[2]; ++k)
      for (int j = 0; j < side_[1]; ++j)
        for (int i = 0; i < side_[0]; ++i)
          *out++ = smooth_value<points>(tree, field, coarse, lattice_node(tree, leaf, 2 * (low_[0] + i), 2 * (low_[1] + j), 2 * (low_[2] + k)));
  }

  double operator()(int i, int j, int k) const {
    const Axis x = axis(i, 0), y = axis(j, 1), z = axis(k, 2);
    double sum = 0;
    for (int c = 0; c < z.count; ++c) {
      double plane = 0;
      for (int b = 0; b < y.count; ++b) {
        const double* row = &values_[static_cast<std::size_t>(x.first + side_[0] * (y.first + b + side_[1] * (z.first + c)))];
        double line = 0;
        for (int a = 0; a < x.count; ++a) line += x.weights[a] * row[a];
        plane += y.weights[b] * line;
      }
      sum += z.weights[c] * plane;
    }
    return sum;
  }

 private:
  struct Axis {
    int first, count;
    const double* weights;
  };

  Axis axis(int i, std::size_t a) const {
    static const std::array<double, 1> on{1};
    static const std::array<double, points> between = lagrange_weights<points>(0.5);
    const int below = (i >> 1) - low_[a];
    return (i & 1) == 0 ? Axis{below, 1, on.data()} : Axis{below - (points / 2 - 1), points, between.data()};
  }

  std::array<int, 3> low_{}, side_{};
  std::vector<double> values_;
};

template <int points, class T>
void gather_smooth_with(const Octree& tree, const Field<T>& field, std::size_t leaf, int width, T* dense) {
  const int side = kBlockSide + 2 * width;
  const auto at = [&](int i, int j, int k) -> T& { return dense[(i + width) + side * ((j + width) + side * (k + width))]; };
  for (int dir = 0; dir < kDirections; ++dir) {
    const auto [dx, dy, dz] = offset_of(dir);
    const std::array<Range, 3> halo{halo_range(dx, width), halo_range(dy, width), halo_range(dz, width)};
    const auto fill = [&](auto&& value) {
      for (int k = halo[2].begin; k < halo[2].end; ++k)
        for (int j = halo[1].begin; j < halo[1].end; ++j)
          for (int i = halo[0].begin; i < halo[0].end; ++i) at(i, j, k) = static_cast<T>(value(i, j, k));
    };
    const NeighborKind kind = tree.neighbor_kind(leaf, dir);
    if (kind == NeighborKind::same) {
      const T* source = field.block(tree.neighbor(leaf, dir));
      const std::size_t run = sizeof(T) * static_cast<std::size_t>(halo[0].end - halo[0].begin);
      for (int k = halo[2].begin; k < halo[2].end; ++k)
        for (int j = halo[1].begin; j < halo[1].end; ++j)
          std::memcpy(&at(halo[0].begin, j, k), source + node_index(halo[0].begin - kBlockSide * dx, j - kBlockSide * dy, k - kBlockSide * dz), run);
    } else if (kind == NeighborKind::coarser) {
      const std::uint32_t coarse = tree.neighbor(leaf, dir);
      if (field.stores(coarse))
        fill(CoarsePatch<points, T>(tree, field, leaf, coarse, halo));
      else
        fill([value = field.block(coarse)[0]](int, int, int) { return value; });
    } else {
      fill([&](int i, int j, int k) { return smooth_value<points>(tree, field, static_cast<std::uint32_t>(leaf), lattice_node(tree, leaf, i, j, k)); });
    }
  }
}

}  // namespace

template <class T>
void gather_smooth(const Octree& tree, const Field<T>& field, std::size_t leaf, int width, HaloOrder order, T* dense) {
  if (order == HaloOrder::cubic)
    gather_smooth_with<4>(tree, field, leaf, width, dense);
  else
    gather_smooth_with<6>(tree, field, leaf, width, dense);
}

template void gather_smooth(const Octree&, const Field<float>&, std::size_t, int, HaloOrder, float*);
template void gather_smooth(const Octree&, const Field<double>&, std::size_t, int, HaloOrder, double*);

}  // namespace burnish
