#include "burnish/octree/field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <optional>

#include "lattice_lookup.h"

namespace burnish {
namespace {

using namespace detail;

double lerp(double a, double b, double t) { return a + t * (b - a); }

// `node_value` of a node in the given leaf, without a search, if all corners it needs are the leaf's own.
template <class T>
std::optional<double> value_within(const Octree& tree, const Field<T>& field, std::uint32_t leaf, const LatticeNode& node) {
  const int l = tree.level(leaf);
  const morton::Position c = tree.corner(leaf);
  const std::array<std::int32_t, 3> local{node.x - static_cast<std::int32_t>(c.x) * kBlockSide,
                                          node.y - static_cast<std::int32_t>(c.y) * kBlockSide,
                                          node.z - static_cast<std::int32_t>(c.z) * kBlockSide};
  const std::int32_t mask = (1 << l) - 1;
  std::array<int, 3> low{};
  std::array<double, 3> t{};
  for (std::size_t a = 0; a < 3; ++a) {
    low[a] = local[a] >> l;
    t[a] = static_cast<double>(local[a] & mask) / (mask + 1);
    if (low[a] < 0 || low[a] + (t[a] > 0) >= kBlockSide) return std::nullopt;
  }
  const T* values = field.block(leaf);
  if (!field.stores(leaf)) return values[0];
  const auto v = [&](int i, int j, int k) -> double { return values[node_index(low[0] + i, low[1] + j, low[2] + k)]; };
  const auto along_x = [&](int j, int k) { return t[0] == 0 ? v(0, j, k) : lerp(v(0, j, k), v(1, j, k), t[0]); };
  const auto along_y = [&](int k) { return t[1] == 0 ? along_x(0, k) : lerp(along_x(0, k), along_x(1, k), t[1]); };
  return t[2] == 0 ? along_y(0) : lerp(along_y(0), along_y(1), t[2]);
}

}  // namespace

StoredNode next_node(const Octree& tree, std::size_t leaf, std::size_t node, int axis) {
  constexpr std::array<std::size_t, 3> kStride{1, kBlockSide, kBlockSide * kBlockSide};
  const std::size_t stride = kStride[static_cast<std::size_t>(axis)];
  if (node / stride % kBlockSide < kBlockSide - 1) return {static_cast<std::uint32_t>(leaf), static_cast<std::uint32_t>(node + stride)};
  const int dir = direction(axis == 0, axis == 1, axis == 2);
  const NeighborKind kind = tree.neighbor_kind(leaf, dir);
  if (kind == NeighborKind::wall) return {};
  if (kind == NeighborKind::same)
    return {tree.neighbor(leaf, dir), static_cast<std::uint32_t>(node - stride * (kBlockSide - 1))};
  const int n = static_cast<int>(node);
  const LatticeNode at = lattice_node(tree, leaf, n % kBlockSide + (axis == 0), n / kBlockSide % kBlockSide + (axis == 1),
                                      n / kBlockSide / kBlockSide + (axis == 2));
  const std::uint32_t other = kind == NeighborKind::coarser ? tree.neighbor(leaf, dir) : tree.find(block_of(at));
  const int level = tree.level(other);
  const LatticeNode corner = lattice_node(tree, other, 0, 0, 0);
  const std::array<std::int32_t, 3> local{at.x - corner.x, at.y - corner.y, at.z - corner.z};
  if (((local[0] | local[1] | local[2]) & ((1 << level) - 1)) != 0) return {};
  return {other, static_cast<std::uint32_t>(node_index(local[0] >> level, local[1] >> level, local[2] >> level))};
}

template <class T>
double detail::node_value_near(const Octree& tree, const Field<T>& field, std::uint32_t near, const LatticeNode& node) {
  // Beyond the wall there is no node to interpolate to: the coarse node below continues.
  const LocatedNode located = locate(tree, near, node);
  const std::uint32_t leaf = located.leaf;
  if (located.is_stored()) return field.block(leaf)[located.place()];
  if (const auto quick = value_within(tree, field, leaf, node)) return *quick;
  std::array<std::array<std::int32_t, 2>, 3> ends{};
  std::array<double, 3> t{};
  const std::array<std::int32_t, 3> at{node.x, node.y, node.z};
  for (std::size_t a = 0; a < 3; ++a) {
    const std::int32_t rest = located.local[a] & located.mask;
    ends[a] = {at[a] - rest, at[a] - rest + (rest ? located.mask + 1 : 0)};
    t[a] = static_cast<double>(rest) / (located.mask + 1);
  }
  const auto corner_value = [&](int x, int y, int z) {  // [T-HALO-1]
    return node_value_near(tree, field, leaf, {ends[0][static_cast<std::size_t>(x)], ends[1][static_cast<std::size_t>(y)],
                                               ends[2][static_cast<std::size_t>(z)]});
  };
  const auto along_x = [&](int y, int z) {
    return t[0] == 0 ? corner_value(0, y, z) : lerp(corner_value(0, y, z), corner_value(1, y, z), t[0]);
  };
  const auto along_y = [&](int z) { return t[1] == 0 ? along_x(0, z) : lerp(along_x(0, z), along_x(1, z), t[1]); };
  return t[2] == 0 ? along_y(0) : lerp(along_y(0), along_y(1), t[2]);
}

template double detail::node_value_near(const Octree&, const Field<float>&, std::uint32_t, const LatticeNode&);
template double detail::node_value_near(const Octree&, const Field<double>&, std::uint32_t, const LatticeNode&);

template <class T>
double node_value(const Octree& tree, const Field<T>& field, LatticeNode node) {
  return node_value_near(tree, field, tree.find(block_of(clamped(tree, node))), node);
}

template <class T>
double sample(const Octree& tree, const Field<T>& field, double x, double y, double z) {
  const LatticeNode at = clamped(tree, {static_cast<std::int32_t>(std::floor(x)), static_cast<std::int32_t>(std::floor(y)),
                                        static_cast<std::int32_t>(std::floor(z))});
  const std::uint32_t leaf = tree.find(block_of(at));
  const int l = tree.level(leaf);
  const std::int32_t size = 1 << l;
  const LatticeNode low{at.x & ~(size - 1), at.y & ~(size - 1), at.z & ~(size - 1)};
  const double tx = (x - low.x) / size, ty = (y - low.y) / size, tz = (z - low.z) / size;
  const auto v = [&](int i, int j, int k) {
    return node_value_near(tree, field, leaf, {low.x + i * size, low.y + j * size, low.z + k * size});
  };
  const auto plane = [&](int k) {
    return lerp(lerp(v(0, 0, k), v(1, 0, k), tx), lerp(v(0, 1, k), v(1, 1, k), tx), ty);
  };
  return lerp(plane(0), plane(1), tz);
}

template <class T>
void gather(const Octree& tree, const Field<T>& field, std::size_t leaf, int width, T* dense) {
  const int side = kBlockSide + 2 * width;
  const auto at = [&](int i, int j, int k) -> T& {
    return dense[(i + width) + side * ((j + width) + side * (k + width))];
  };
  for (int dir = 0; dir < kDirections; ++dir) {
    const auto [dx, dy, dz] = offset_of(dir);
    const Range rx = halo_range(dx, width), ry = halo_range(dy, width), rz = halo_range(dz, width);
    if (tree.neighbor_kind(leaf, dir) == NeighborKind::same) {
      const T* source = field.block(tree.neighbor(leaf, dir));
      const std::size_t run = sizeof(T) * static_cast<std::size_t>(rx.end - rx.begin);
      for (int k = rz.begin; k < rz.end; ++k)
        for (int j = ry.begin; j < ry.end; ++j)
          std::memcpy(&at(rx.begin, j, k),
                      source + node_index(rx.begin - kBlockSide * dx, j - kBlockSide * dy, k - kBlockSide * dz), run);
      continue;
    }
    // The leaves of another level there, which hold nearly all that is asked for.
    const std::span<const std::uint32_t> beyond = tree.neighbors(leaf, dir);
    const auto value = [&](const LatticeNode& node) {
      for (const std::uint32_t other : beyond)
        if (const auto quick = value_within(tree, field, other, node)) return *quick;
      return node_value_near(tree, field, beyond.empty() ? static_cast<std::uint32_t>(leaf) : beyond.front(), node);
    };
    for (int k = rz.begin; k < rz.end; ++k)
      for (int j = ry.begin; j < ry.end; ++j)
        for (int i = rx.begin; i < rx.end; ++i) at(i, j, k) = static_cast<T>(value(lattice_node(tree, leaf, i, j, k)));
  }
}

template double node_value(const Octree&, const Field<float>&, LatticeNode);
template double node_value(const Octree&, const Field<double>&, LatticeNode);
template double sample(const Octree&, const Field<float>&, double, double, double);
template double sample(const Octree&, const Field<double>&, double, double, double);
template void gather(const Octree&, const Field<float>&, std::size_t, int, float*);
template void gather(const Octree&, const Field<double>&, std::size_t, int, double*);

}  // namespace burnish
