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
constexpr std::size_t kBatch = 256;  // facets prepared at a time

Vec3 swapped(Vec3 v, int axis) {
  std::swap(v.x, v[axis]);
  return v;
}

double distance_to_range(double x, double low, double high) { return std::max({low - x, x - high, 0.0}); }

// Signed distances at the (n + 1)^3 nodes of a block cut into n^3 cells, upper faces included, in lattice units. Scattered from
// facets as in distance.cpp, on rows of eight along the axis to which the surface is most parallel. The last row of a line has one node
// of use; its other lanes begin at 0, so that nothing is nearer.
class NodeDistances {
 public:
  NodeDistances(const OctantFacets& octant, int cells, double reach)
      : octant_(octant), side_(cells + 1), rows_((cells + detail::kRow) / detail::kRow),
        spacing_(kBlockSide * octant.cell() / cells), reach_(reach / spacing_) {
    const auto lines = static_cast<std::size_t>(side_) * static_cast<std::size_t>(side_);
    squared_.assign(lines * line_size(), 0.0);
    for (std::size_t line = 0; line < lines; ++line) std::fill_n(squared_.begin() + static_cast<std::ptrdiff_t>(line * line_size()), side_, reach_ * reach_);
    id_.assign(lines * line_size(), static_cast<double>(kNoFacet));
    row_max_.assign(lines * static_cast<std::size_t>(rows_), reach_ * reach_);
    choose_axis();
    for (std::size_t first = 0; first < octant_.facets.size(); first += kBatch) {
      items_.clear();
      for (const std::uint32_t f : octant_.facets.subspan(first, std::min(kBatch, octant_.facets.size() - first))) add(f);
      scatter(std::min(1.0, reach_));
      scatter(reach_);
    }
  }

  // value(i, j, k) is node i + (n + 1) (j + (n + 1) k)'s, positive inside; kUnknown beyond the reach.
  std::vector<double> signed_values(const detail::PseudoNormals& normals) const {
    std::vector<double> values;
    values.reserve(static_cast<std::size_t>(side_ * side_ * side_));
    for (int k = 0; k < side_; ++k)
      for (int j = 0; j < side_; ++j)
        for (int i = 0; i < side_; ++i) {
          const Vec3 local = {static_cast<double>(i), static_cast<double>(j), static_cast<double>(k)};
          const Vec3 at = swapped(local, axis_);
          const std::size_t n = (static_cast<std::size_t>(at.y) + static_cast<std::size_t>(side_) * static_cast<std::size_t>(at.z)) * line_size() + static_cast<std::size_t>(at.x);
          const auto facet = static_cast<std::uint32_t>(id_[n]);
          const double distance = std::sqrt(squared_[n]) * spacing_;
          values.push_back(facet == kNoFacet ? kUnknown : normals.is_behind(octant_.corner + local * spacing_, facet) ? distance : -distance);
        }
    return values;
  }

 private:
  struct Item {
    detail::PreparedTriangle triangle;
    Vec3 low, high;
    double facet;
  };

  std::size_t line_size() const { return static_cast<std::size_t>(rows_ * detail::kRow); }

  void choose_axis() {
    Vec3 across;
    for (const std::uint32_t f : octant_.facets) {
      const Vec3 n = facet_normal_2a(octant_.soup, f);
      across += Vec3{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    }
    axis_ = across.x <= across.y && across.x <= across.z ? 0 : across.y <= across.z ? 1 : 2;
  }

  void add(std::uint32_t f) {
    const auto local = [&](int i) { return swapped((octant_.soup.corner(f, i) - octant_.corner) / spacing_, axis_); };
    const Vec3 a = local(0), b = local(1), c = local(2);
    items_.push_back({detail::prepare(a, b, c), min(min(a, b), c), max(max(a, b), c), static_cast<double>(f)});
  }

  void scatter(double reach) {
    for (Item& item : items_) {
      const auto begin = [&](double low) { return static_cast<int>(std::ceil(std::max(low - reach, 0.0))); };
      const auto end = [&](double high) { return static_cast<int>(std::floor(std::min(high + reach, side_ - 1.0))) + 1; };
      for (int row = 0; row < rows_; ++row) {
        const double dx = std::max({item.low.x - std::min(row * detail::kRow + detail::kRow - 1, side_ - 1), row * detail::kRow - item.high.x, 0.0});
        if (dx > reach) continue;
        detail::PreparedTriangle triangle = item.triangle;
        for (Vec3* p : {&triangle.a, &triangle.b, &triangle.c}) p->x -= row * detail::kRow;
        for (int k = begin(item.low.z); k < end(item.high.z); ++k) {
          const double dz = distance_to_range(k, item.low.z, item.high.z);
          for (int j = begin(item.low.y); j < end(item.high.y); ++j) {
            const double dy = distance_to_range(j, item.low.y, item.high.y);
            const auto line = static_cast<std::size_t>(j + side_ * k);
            double& row_max = row_max_[line * static_cast<std::size_t>(rows_) + static_cast<std::size_t>(row)];
            if (dx * dx + dy * dy + dz * dz >= row_max) continue;  // [T-DIST-3]
            const std::size_t at = line * line_size() + static_cast<std::size_t>(row * detail::kRow);
            detail::update_row(triangle, item.facet, j, k, &squared_[at], &id_[at]);
            row_max = *std::max_element(&squared_[at], &squared_[at] + detail::kRow);
          }
        }
      }
    }
  }

  const OctantFacets& octant_;
  const int side_;         // nodes
  const int rows_;         // of eight nodes a line
  const double spacing_;   // lattice units
  const double reach_;     // in units of the spacing
  int axis_ = 0;
  std::vector<Item> items_;
  std::vector<double> squared_, id_, row_max_;
};

double lerp(double a, double b, double t) { return a + t * (b - a); }

// The trilinear interpolant of the (8 + 1)^3 values at a point in cells of the block; kUnknown if a corner is.
double interpolated(const std::vector<double>& values, const Vec3& p, double most) {
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
    v[c] = values[static_cast<std::size_t>(i + (kBlockSide + 1) * (j + (kBlockSide + 1) * k))];
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
    const double reach = options_.band * octant.cell();
    const std::vector<double> values = NodeDistances(octant, kBlockSide, reach).signed_values(normals_);
    return misses_surface(octant, values) || misses_finer_nodes(octant, values);
  }

 private:
  bool misses_surface(const OctantFacets& octant, const std::vector<double>& values) const {
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

  bool misses_finer_nodes(const OctantFacets& octant, const std::vector<double>& values) const {
    const double most = std::min(options_.checked, options_.band) * octant.cell();
    if (std::none_of(values.begin(), values.end(), [&](double v) { return std::abs(v) <= most; })) return false;
    const std::vector<double> finer = NodeDistances(octant, 2 * kBlockSide, options_.band * octant.cell()).signed_values(normals_);
    std::size_t n = 0;
    for (int k = 0; k <= 2 * kBlockSide; ++k)
      for (int j = 0; j <= 2 * kBlockSide; ++j)
        for (int i = 0; i <= 2 * kBlockSide; ++i, ++n) {
          if ((i | j | k) % 2 == 0 || finer[n] == kUnknown) continue;
          const double value = interpolated(values, Vec3{0.5 * i, 0.5 * j, 0.5 * k}, most);
          if (value != kUnknown && !(std::abs(value - finer[n]) <= options_.tolerance)) return true;
        }
    return false;
  }

  const detail::PseudoNormals normals_;
  const ErrorOptions options_;
};

}  // namespace

std::unique_ptr<RefinementCriterion> distance_error(const TriangleSoup& lattice_soup, const ErrorOptions& options) {
  if (!(options.tolerance >= 0) || !(options.band >= 2))
    throw Error(ErrorCode::usage, "the error criterion needs a tolerance of 0 or more and a band of at least 2 cells");
  return std::make_unique<DistanceError>(lattice_soup, options);
}

AdaptiveGrowth grow_to_tolerance(const TriangleSoup& lattice_soup, int depth, const ErrorOptions& options, Progress& progress) {
  const auto error = distance_error(lattice_soup, options);
  const RefinementCriterion* criteria[] = {error.get()};
  return grow_adaptive(lattice_soup, depth, {kBlockSide, options.coarsest_level, options.band}, criteria, progress);
}

}  // namespace burnish
