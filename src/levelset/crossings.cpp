#include "burnish/levelset/crossings.h"

#include <algorithm>
#include <array>
#include <atomic>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr double kRounding = 1e-12;  // of coordinates relative to a block, as part of the facet's extent

struct NodeRange {
  int begin, end;
};

NodeRange columns(double low, double high) {
  return {static_cast<int>(std::ceil(std::max(low - kTouching, 0.0))),
          static_cast<int>(std::floor(std::min(high + kTouching, kBlockSide - 1.0))) + 1};
}

// One facet seen along one axis of a block; coordinates relative to the block's corner. [T-SIGN-1]
class AxisView {
 public:
  AxisView(const std::array<Vec3, 3>& v, const Vec3& normal, double extent, int axis)
      : v_(v), axis_(axis), u_((axis + 1) % 3), w_((axis + 2) % 3), normal_(normal) {
    side_ = normal_[axis] > 0 ? 1 : -1;
    double longest = 0;
    for (std::size_t i = 0; i < 3; ++i) {
      const Vec3 e = v[(i + 1) % 3] - v[i];
      const double length = std::abs(e[u_]) + std::abs(e[w_]);  // in the sum norm
      slack_[i] = kTouching * length;
      longest = std::max(longest, length);
    }
    // Seen along the axis a sliver no wider than the tolerance: it has no depth of its own, all of it counts.
    edge_on_ = std::abs(normal_[axis]) <= kTouching * longest;
    depth_slack_ = kTouching;
    if (!edge_on_)
      depth_slack_ += kRounding * extent * (std::abs(normal_[u_]) + std::abs(normal_[w_])) / std::abs(normal_[axis]);
  }

  // Calls mark(k) for every edge k = 0..7 (from node k to k + 1) of column (i, j) that the facet crosses.
  template <class Mark>
  void column(int i, int j, Mark&& mark) const {
    if (!covers(i, j)) return;
    double low = low_(axis_), high = high_(axis_);
    if (!edge_on_) {
      const double depth = v_[0][axis_] - (normal_[u_] * (i - v_[0][u_]) + normal_[w_] * (j - v_[0][w_])) / normal_[axis_];
      const double least = low, most = high;
      low = std::clamp(depth - depth_slack_, least, most);
      high = std::clamp(depth + depth_slack_, least, most);
    }
    const int first = static_cast<int>(std::floor(std::max(low - kTouching, 0.0)));
    const int last = static_cast<int>(std::floor(std::min(high + kTouching, kBlockSide - 0.5)));
    if (high + kTouching < 0) return;
    for (int k = first; k <= last; ++k) mark(k);
  }

  double low_(int axis) const { return std::min({v_[0][axis], v_[1][axis], v_[2][axis]}); }
  double high_(int axis) const { return std::max({v_[0][axis], v_[1][axis], v_[2][axis]}); }

 private:
  bool covers(int i, int j) const {
    for (std::size_t k = 0; k < 3; ++k) {
      const Vec3 &p = v_[k], &q = v_[(k + 1) % 3];
      const double e = side_ * ((q[u_] - p[u_]) * (j - p[w_]) - (q[w_] - p[w_]) * (i - p[u_]));
      if (e < -slack_[k]) return false;
      if (edge_on_ && e > slack_[k]) return false;
    }
    return true;
  }

  const std::array<Vec3, 3>& v_;
  int axis_, u_, w_;
  Vec3 normal_;
  bool edge_on_;
  double side_;
  double depth_slack_;
  std::array<double, 3> slack_{};
};

// Calls visit(node, axis) for every lattice edge owned by the leaf that the facet crosses.
template <class Visit>
void for_each_crossing(const TriangleSoup& soup, const SurfaceOctree& grid, std::size_t leaf, std::uint32_t facet,
                       Visit&& visit) {
  const LatticeNode corner = lattice_node(grid.octree, leaf, 0, 0, 0);
  const Vec3 base{static_cast<double>(corner.x), static_cast<double>(corner.y), static_cast<double>(corner.z)};
  const double cell = static_cast<double>(1u << grid.octree.level(leaf));
  const auto local = [&](int i) { return (soup.corner(facet, i) - base) / cell; };
  const std::array<Vec3, 3> v{local(0), local(1), local(2)};
  const Vec3 low = min(min(v[0], v[1]), v[2]), high = max(max(v[0], v[1]), v[2]);
  for (int a = 0; a < 3; ++a)
    if (low[a] > kBlockSide + kTouching || high[a] < -kTouching) return;
  const Vec3 normal = cross(v[1] - v[0], v[2] - v[0]), reach = max(high, low * -1.0);
  const double extent = std::max({reach.x, reach.y, reach.z});
  const std::array<NodeRange, 3> range{columns(low.x, high.x), columns(low.y, high.y), columns(low.z, high.z)};
  for (int axis = 0; axis < 3; ++axis) {
    const auto u = static_cast<std::size_t>((axis + 1) % 3), w = static_cast<std::size_t>((axis + 2) % 3);
    const NodeRange ru = range[u], rw = range[w];
    if (ru.begin >= ru.end || rw.begin >= rw.end) continue;
    const AxisView view(v, normal, extent, axis);
    for (int j = rw.begin; j < rw.end; ++j)
      for (int i = ru.begin; i < ru.end; ++i)
        view.column(i, j, [&](int k) {
          std::array<int, 3> at{};
          at[u] = i;
          at[w] = j;
          at[static_cast<std::size_t>(axis)] = k;
          visit(at, axis);
        });
  }
}

template <class PerLeaf>
void for_each_near_leaf(const SurfaceOctree& grid, Progress& progress, PerLeaf&& per_leaf) {
  parallel_ranges(grid.octree.size(), 32, [&](std::size_t begin, std::size_t end) {
    progress.check();
    for (std::size_t leaf = begin; leaf < end; ++leaf)
      if (grid.near_surface(leaf)) per_leaf(leaf);
  });
}

// Per node three bits like those of `crossed`: crossed edges with both ends on one side. False if there are none.
bool find_idle_edges(const SurfaceOctree& grid, const Field<std::uint8_t>& crossed, const Field<std::uint8_t>& inside, std::size_t leaf,
                     std::array<std::uint8_t, kBlockNodes>& idle) {
  const std::uint8_t* bits = crossed.block(leaf);
  const std::uint8_t* in = inside.block(leaf);
  std::uint8_t any = 0;
  for (std::size_t n = 0; n < kBlockNodes; ++n) {
    idle[n] = 0;
    for (int axis = 0; bits[n] >> axis != 0; ++axis) {
      if (!(bits[n] >> axis & 1)) continue;
      const StoredNode end = next_node(grid.octree, leaf, n, axis);
      if (end.leaf != Octree::kNone && inside.block(end.leaf)[end.node] == in[n]) idle[n] |= static_cast<std::uint8_t>(1u << axis);
    }
    any |= idle[n];
  }
  return any != 0;
}

}  // namespace

Field<std::uint8_t> crossed_edges(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, Progress& progress) {
  Field<std::uint8_t> crossed = field_over<std::uint8_t>(grid, 0, 0);
  for_each_near_leaf(grid, progress, [&](std::size_t leaf) {
    std::uint8_t* bits = crossed.block(leaf);
    for (const std::uint32_t f : grid.facets_of(leaf))
      for_each_crossing(lattice_soup, grid, leaf, f, [&](const std::array<int, 3>& at, int axis) {
        bits[node_index(at[0], at[1], at[2])] |= static_cast<std::uint8_t>(1u << axis);
      });
  });
  return crossed;
}

std::vector<char> facets_across_idle_edges(const TriangleSoup& lattice_soup, const SurfaceOctree& grid,
                                           const Field<std::uint8_t>& crossed, const Field<std::uint8_t>& inside, Progress& progress) {
  std::vector<char> found(lattice_soup.facets.size(), 0);
  for_each_near_leaf(grid, progress, [&](std::size_t leaf) {
    std::array<std::uint8_t, kBlockNodes> idle;
    if (!find_idle_edges(grid, crossed, inside, leaf, idle)) return;
    for (const std::uint32_t f : grid.facets_of(leaf))
      for_each_crossing(lattice_soup, grid, leaf, f, [&](const std::array<int, 3>& at, int axis) {
        if (idle[node_index(at[0], at[1], at[2])] >> axis & 1) std::atomic_ref<char>(found[f]).store(1, std::memory_order_relaxed);
      });
  });
  return found;
}

std::vector<FacetSides> facet_sides(const TriangleSoup& lattice_soup, const SurfaceOctree& grid,
                                    const Field<std::uint8_t>& inside, const std::vector<char>& wanted, Progress& progress) {
  // One byte of flags a facet; blocks that share a facet only ever set bits, so order does not matter.
  std::vector<std::uint8_t> flags(lattice_soup.facets.size(), 0);
  for_each_near_leaf(grid, progress, [&](std::size_t leaf) {
    for (const std::uint32_t f : grid.facets_of(leaf)) {
      if (!wanted[f]) continue;
      std::uint8_t seen = 0;
      for_each_crossing(lattice_soup, grid, leaf, f, [&](const std::array<int, 3>& at, int axis) {
        const std::size_t node = node_index(at[0], at[1], at[2]);
        const StoredNode end = next_node(grid.octree, leaf, node, axis);
        if (end.leaf == Octree::kNone) return;
        const bool here = inside.block(leaf)[node] != 0, next = inside.block(end.leaf)[end.node] != 0;
        seen |= static_cast<std::uint8_t>(here != next ? 1 : here ? 2 : 4);
      });
      if (seen) std::atomic_ref<std::uint8_t>(flags[f]).fetch_or(seen, std::memory_order_relaxed);
    }
  });
  std::vector<FacetSides> sides(flags.size());
  for (std::size_t f = 0; f < flags.size(); ++f)
    sides[f] = {(flags[f] & 1) != 0, (flags[f] & 2) != 0, (flags[f] & 4) != 0};
  return sides;
}

}  // namespace burnish
