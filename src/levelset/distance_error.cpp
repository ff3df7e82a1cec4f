// The error criterion of adapt.h: how far off a block's trilinear interpolant is.
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/levelset/adapt.h"
#include "distance_kernel.h"
#include "facet_sides.h"

namespace burnish {
namespace {

constexpr double kUnknown = std::numeric_limits<double>::infinity();
constexpr double kCellDiagonal = 1.7321;  // of a unit cell: the corners of cells with a point of the surface are nearer
constexpr std::size_t kBatch = 256;  // facets scattered at a time

using detail::swapped;

// Nodes of a block cut into n^3 cells, upper faces included: i + (n + 1) (j + (n + 1) k).
using NodeValues = std::vector<double>;

std::size_t node_at(int side, int i, int j, int k) { return static_cast<std::size_t>(i + side * (j + side * k)); }

// Calls visit(i, j, k, n) for all nodes in order.
template <class Visit>
void for_each_node(int side, Visit&& visit) {
  std::size_t n = 0;
  for (int k = 0; k < side; ++k)
    for (int j = 0; j < side; ++j)
      for (int i = 0; i < side; ++i) visit(i, j, k, n++);
}

// Distances at the nodes, in lattice units, scattered from facets as in distance.cpp, on rows of eight along the axis to which the surface
// is most parallel. `bounds`: for each node what its distance is known to be below; 0 where nobody asks for it, as for what fills up
// the last rows.
class NodeDistances {
 public:
  NodeDistances(const OctantFacets& octant, int cells, const NodeValues& bounds)
      : octant_(octant), spacing_(kBlockSide * octant.cell() / cells) {
    choose_axis();
    const int rows = cells / kBlockSide + 1;
    nodes_ = {rows, rows * kBlockSide, cells + 1, nullptr, nullptr, nullptr};
    const std::size_t count = nodes_.row_index(rows, 0, 0);
    squared_.assign(count * kBlockSide, 0.0);
    id_.assign(count * kBlockSide, static_cast<double>(kNoFacet));
    row_max_.resize(count);
    for_each_node(cells + 1, [&](int i, int j, int k, std::size_t n) {
      const double bound = bounds[n] / spacing_;
      squared_[slot(i, j, k)] = bound * bound;
    });
    for (std::size_t row = 0; row < count; ++row)
      row_max_[row] = *std::max_element(&squared_[row * kBlockSide], &squared_[row * kBlockSide] + kBlockSide);
    nodes_.squared = squared_.data();
    nodes_.id = id_.data();
    nodes_.row_max = row_max_.data();
    scatter(std::sqrt(*std::max_element(row_max_.begin(), row_max_.end())));
  }

  Vec3 position(int i, int j, int k) const {
    return octant_.corner + Vec3{static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)} * spacing_;
  }
  double distance(int i, int j, int k) const { return std::sqrt(squared_[slot(i, j, k)]) * spacing_; }
  // The closest facet, or kNoFacet if none was below the bound.
  std::uint32_t facet(int i, int j, int k) const { return static_cast<std::uint32_t>(id_[slot(i, j, k)]); }
  double spacing() const { return spacing_; }

 private:
  std::size_t slot(int i, int j, int k) const {
    const std::array<int, 3> at = axis_ == 0 ? std::array{i, j, k} : axis_ == 1 ? std::array{j, i, k} : std::array{k, j, i};
    return nodes_.row_index(at[0] / kBlockSide, at[1], at[2]) * kBlockSide + static_cast<std::size_t>(at[0] % kBlockSide);
  }

  void choose_axis() {
    Vec3 across;
    for (const std::uint32_t f : octant_.facets) {
      const Vec3 n = facet_normal_2a(octant_.soup, f);
      across += Vec3{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    }
    axis_ = detail::row_axis(across);
  }

  void scatter(double reach) {
    std::vector<detail::ScatterItem> items;
    for (std::size_t first = 0; first < octant_.facets.size(); first += kBatch) {
      items.clear();
      for (const std::uint32_t f : octant_.facets.subspan(first, std::min(kBatch, octant_.facets.size() - first))) {
        const auto local = [&](int i) { return swapped((octant_.soup.corner(f, i) - octant_.corner) / spacing_, axis_); };
        items.push_back(detail::item_of(local(0), local(1), local(2), f));
      }
      detail::scatter(items.data(), items.size(), std::min(0.5, reach), nodes_);
      detail::scatter(items.data(), items.size(), reach, nodes_);
    }
  }

  const OctantFacets& octant_;
  const double spacing_;   // lattice units
  int axis_ = 0;
  detail::NodeRows nodes_{};
  std::vector<double> squared_, id_, row_max_;
};

double lerp(double a, double b, double t) { return a + t * (b - a); }

// The trilinear interpolant of the (8 + 1)^3 values at a point in cells of the block; kUnknown if a corner is.
double interpolated(const NodeValues& values, const Vec3& p, double most) {
  std::array<int, 3> low{};
  std::array<double, 3> t{};
  for (std::size_t a = 0; a < 3; ++a) {
    const double x = p[static_cast<int>(a)];
    low[a] = std::min(static_cast<int>(x), kBlockSide - 1);
    t[a] = x - low[a];
  }
  std::array<double, 8> v{};
  for (std::size_t c = 0; c < 8; ++c) {
    const int i = low[0] + static_cast<int>(c & 1), j = low[1] + static_cast<int>(c >> 1 & 1), k = low[2] + static_cast<int>(c >> 2);
    v[c] = values[node_at(kBlockSide + 1, i, j, k)];
    if (!(std::abs(v[c]) <= most)) return kUnknown;
  }
  return lerp(lerp(lerp(v[0], v[1], t[0]), lerp(v[2], v[3], t[0]), t[1]), lerp(lerp(v[4], v[5], t[0]), lerp(v[6], v[7], t[0]), t[1]), t[2]);
}

// The part [begin, end] of the segment p + s (q - p) within the cube [0, 8]^3; empty if end < begin.
std::array<double, 2> clipped(const Vec3& p, const Vec3& q) {
  double begin = 0, end = 1;
  for (int a = 0; a < 3; ++a) {
    const double d = q[a] - p[a];
    if (d == 0) {
      if (p[a] < 0 || p[a] > kBlockSide) return {1, 0};
      continue;
    }
    const double s = -p[a] / d, t = (kBlockSide - p[a]) / d;
    begin = std::max(begin, std::min(s, t));
    end = std::min(end, std::max(s, t));
  }
  return {begin, end};
}

class DistanceError : public RefinementCriterion {
 public:
  DistanceError(const TriangleSoup& soup, const ErrorOptions& options) : normals_(soup), options_(options) {}
  std::string_view name() const override { return "error"; }

  bool divides(const OctantFacets& octant) const override {  // [T-ADAPT-1]
    const NodeValues values = coarse_values(octant);
    return misses_surface(octant, values) || misses_finer_nodes(octant, values);
  }

 private:
  // Signed distances at the block's own nodes; kUnknown beyond what (a) and (b) ask for. A node farther from the surface than from the node before
  // it lies on the same side.
  NodeValues coarse_values(const OctantFacets& octant) const {
    constexpr int side = kBlockSide + 1;
    const double reach = std::max(kCellDiagonal, std::min(options_.checked, options_.band)) * octant.cell();
    const NodeDistances nodes(octant, kBlockSide, NodeValues(side * side * side, reach));
    NodeValues values(side * side * side, kUnknown);
    for_each_node(side, [&](int i, int j, int k, std::size_t n) {
      const std::uint32_t facet = nodes.facet(i, j, k);
      if (facet == kNoFacet) return;
      const double distance = nodes.distance(i, j, k);
      const double before = i > 0 ? values[n - 1] : j > 0 ? values[n - side] : k > 0 ? values[n - side * side] : kUnknown;
      const bool inside = distance > nodes.spacing() && before != kUnknown ? before > 0 : normals_.is_behind(nodes.position(i, j, k), facet);
      values[n] = inside ? distance : -distance;
    });
    return values;
  }

  bool misses_surface(const OctantFacets& octant, const NodeValues& values) const {
    const auto misses = [&](const Vec3& p) {
      if (std::min({p.x, p.y, p.z}) < 0 || std::max({p.x, p.y, p.z}) > kBlockSide) return false;
      return !(std::abs(interpolated(values, p, kUnknown)) <= options_.tolerance);
    };
    return std::any_of(octant.facets.begin(), octant.facets.end(), [&](std::uint32_t f) {
      const auto local = [&](int i) { return (octant.soup.corner(f, i) - octant.corner) / octant.cell(); };
      const std::array<Vec3, 3> v{local(0), local(1), local(2)};
      if (misses((v[0] + v[1] + v[2]) / 3.0)) return true;
      for (std::size_t i = 0; i < 3; ++i) {
        const Vec3 &p = v[i], &q = v[(i + 1) % 3];
        const auto [begin, end] = clipped(p, q);
        if (end < begin) continue;
        const int pieces = static_cast<int>(std::ceil(2 * (end - begin) * norm(q - p)));
        for (int n = 0; n <= pieces; ++n)
          if (misses(p + (q - p) * (pieces == 0 ? begin : begin + (end - begin) * n / pieces))) return true;
      }
      return false;
    });
  }

  // At the nodes between the block's own, in cells whose corners are all known and near enough.
  bool misses_finer_nodes(const OctantFacets& octant, const NodeValues& values) const {
    constexpr int side = 2 * kBlockSide + 1;
    const double most = std::min(options_.checked, options_.band) * octant.cell();
    const double spacing = 0.5 * octant.cell();
    NodeValues interpolants(side * side * side, kUnknown), bounds(side * side * side, 0);
    bool any = false;
    for_each_node(side, [&](int i, int j, int k, std::size_t n) {
      if ((i | j | k) % 2 == 0) return;
      interpolants[n] = interpolated(values, Vec3{0.5 * i, 0.5 * j, 0.5 * k}, most);
      if (interpolants[n] == kUnknown) return;
      any = true;
      bounds[n] = std::min(options_.band * octant.cell(), (nearest_corner(values, i, j, k) + step(i, j, k) * spacing) * (1 + 1e-9));
    });
    if (!any) return false;
    const NodeDistances nodes(octant, 2 * kBlockSide, bounds);
    bool misses = false;
    for_each_node(side, [&](int i, int j, int k, std::size_t n) {
      if (misses || interpolants[n] == kUnknown) return;
      const std::uint32_t facet = nodes.facet(i, j, k);
      if (facet == kNoFacet) return;
      const double distance = nodes.distance(i, j, k);
      const bool inside = distance > step(i, j, k) * spacing ? values[node_at(kBlockSide + 1, i / 2, j / 2, k / 2)] > 0
                                                             : normals_.is_behind(nodes.position(i, j, k), facet);
      misses = !(std::abs(interpolants[n] - (inside ? distance : -distance)) <= options_.tolerance);
    });
    return misses;
  }

  // The least distance of the block's own nodes around a finer one.
  static double nearest_corner(const NodeValues& values, int i, int j, int k) {
    double least = kUnknown;
    for (int z = k / 2; z <= (k + 1) / 2; ++z)
      for (int y = j / 2; y <= (j + 1) / 2; ++y)
        for (int x = i / 2; x <= (i + 1) / 2; ++x) least = std::min(least, std::abs(values[node_at(kBlockSide + 1, x, y, z)]));
    return least;
  }

  // From the block's own nodes around a finer one, in finer cells.
  static double step(int i, int j, int k) { return std::sqrt(static_cast<double>(i % 2 + j % 2 + k % 2)); }

  const detail::PseudoNormals normals_;
  const ErrorOptions options_;
};

}  // namespace

std::unique_ptr<RefinementCriterion> distance_error(const TriangleSoup& lattice_soup, const ErrorOptions& options) {
  if (!(options.tolerance >= 0) || !(options.band >= 2))
    throw Error(ErrorCode::usage, "the error criterion needs a tolerance of 0 or more and a band of at least 2 cells", "those of ErrorOptions{} suit most surfaces");
  return std::make_unique<DistanceError>(lattice_soup, options);
}

AdaptiveGrowth grow_to_tolerance(const TriangleSoup& lattice_soup, int depth, const ErrorOptions& options, Progress& progress) {
  const auto error = distance_error(lattice_soup, options);
  const RefinementCriterion* criteria[] = {error.get()};
  return grow_adaptive(lattice_soup, depth, {kBlockSide, options.coarsest_level, options.band}, criteria, progress);
}

}  // namespace burnish
