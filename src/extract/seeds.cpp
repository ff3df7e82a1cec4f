#include "seeds.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/surface/shells.h"
#include "point_grid.h"

namespace burnish::detail {
namespace {

constexpr int kClasses = 8;  // of spacing, in powers of two

// Zero crossings of a plane are a regular lattice, in which any number of points are on one circle, and tetrahedra are flat. So points are moved by up
// to kJitter cells each way, by a hash of their number.
constexpr double kJitter = 0.1;

Vec3 jitter(std::uint64_t n) {
  Vec3 move;
  for (int axis = 0; axis < 3; ++axis) {
    n = (n + 0x9e3779b97f4a7c15u) * 0xbf58476d1ce4e5b9u;
    n ^= n >> 31;
    move[axis] = kJitter * (static_cast<double>(n >> 11) * 0x1p-52 - 1);
  }
  return move;
}

// Points that were taken, in one grid per class of spacing: a query looks into the grid whose cubes are as large as the spacing.
class TakenPoints {
 public:
  explicit TakenPoints(double least) : least_(least) {
    for (int c = 0; c < kClasses; ++c) grids_.emplace_back(least * (2 << c));
  }

  void take(const Vec3& p) {
    const auto number = static_cast<std::uint32_t>(points_.size());
    points_.push_back(p);
    for (int c = 0; c <= largest_class_; ++c) grids_[static_cast<std::size_t>(c)].insert(p, number);
  }
  void expect(double spacing) { largest_class_ = std::max(largest_class_, class_of(spacing)); }
  bool any_within(const Vec3& p, double spacing) const {
    return grids_[static_cast<std::size_t>(class_of(spacing))].any_near(
        p, [&](std::uint32_t n) { return squared_norm(points_[n] - p) < spacing * spacing; });
  }
  const std::vector<Vec3>& points() const { return points_; }

 private:
  int class_of(double spacing) const { return std::clamp(static_cast<int>(std::floor(std::log2(spacing / least_))), 0, kClasses - 1); }

  double least_;
  int largest_class_ = 0;
  std::vector<PointGrid> grids_;
  std::vector<Vec3> points_;
};

class Spreader {
 public:
  Spreader(const ZeroSurface& surface, const std::vector<double>& spacing, const std::vector<SeedFreeBall>& free_of, FieldSampler& field)
      : surface_(surface),
        spacing_(spacing),
        field_(field),
        taken_(*std::min_element(spacing.begin(), spacing.end())),
        count_(surface.components, 0) {
    taken_.expect(*std::max_element(spacing.begin(), spacing.end()));
    for (const SeedFreeBall& ball : free_of) largest_ball_ = std::max(largest_ball_, ball.radius);
    balls_ = PointGrid(largest_ball_);
    for (std::uint32_t b = 0; b < free_of.size(); ++b) balls_.insert(free_of[b].center, b);
    free_of_ = &free_of;
  }

  std::vector<Vec3> run() {
    const std::vector<Vec3>& points = surface_.soup.points;
    for (std::size_t v = 0; v < points.size(); ++v) {
      if (!is_finite(points[v]) || is_in_ball(points[v]) || taken_.any_within(points[v], spacing_[v])) continue;
      taken_.take(field_.projected(points[v] + jitter(v), 0.5));
      ++count_[surface_.component[v]];
    }
    add_to_small_components();
    return taken_.points();
  }

 private:
  bool is_in_ball(const Vec3& p) const {
    return balls_.any_near(p, [&](std::uint32_t b) { return squared_norm((*free_of_)[b].center - p) < (*free_of_)[b].radius * (*free_of_)[b].radius; });
  }

  // Components with too few seeds get some that are spread, instead.
  void add_to_small_components() {
    std::vector<std::vector<std::uint32_t>> members(count_.size());
    for (std::uint32_t v = 0; v < surface_.component.size(); ++v)
      if (count_[surface_.component[v]] < kLeastSeeds) members[surface_.component[v]].push_back(v);
    for (const std::vector<std::uint32_t>& of : members)
      if (!of.empty()) add_farthest(of);
  }

  // Each the farthest from those before it.
  void add_farthest(const std::vector<std::uint32_t>& of) {
    std::vector<double> distance(of.size(), std::numeric_limits<double>::infinity());
    std::size_t next = 0;
    for (std::size_t n = 0; n < kLeastSeeds; ++n) {
      const Vec3& p = surface_.soup.points[of[next]];
      if (distance[next] == 0) break;
      if (is_finite(p) && !taken_.any_within(p, 1e-6)) taken_.take(field_.projected(p, 0.5));
      std::size_t farthest = next;
      double most = -1;
      for (std::size_t i = 0; i < of.size(); ++i) {
        distance[i] = std::min(distance[i], squared_norm(surface_.soup.points[of[i]] - p));
        if (distance[i] > most) most = distance[farthest = i];
      }
      next = farthest;
    }
  }

  const ZeroSurface& surface_;
  const std::vector<double>& spacing_;
  FieldSampler& field_;
  TakenPoints taken_;
  std::vector<std::size_t> count_;
  double largest_ball_ = 1e-3;
  PointGrid balls_{1};
  const std::vector<SeedFreeBall>* free_of_ = nullptr;
};

}  // namespace

ZeroSurface zero_surface(const LevelSet& level_set, Progress& progress) {
  ZeroSurface surface;
  surface.soup = extract_surface(level_set, {.snap = false}, progress).soup;
  UnionFind sets = connected_points(surface.soup);
  surface.component.resize(surface.soup.points.size());
  for (std::uint32_t v = 0; v < surface.component.size(); ++v)
    surface.component[v] = sets.is_representative(v) ? static_cast<std::uint32_t>(surface.components++) : surface.component[sets.find(v)];
  for (std::size_t f = 0; f < surface.soup.facets.size(); ++f) {
    const double size = 0.5 * norm(facet_normal_2a(surface.soup, f));
    if (std::isfinite(size)) surface.area += size;
  }
  return surface;
}

std::vector<Vec3> spread_seeds(const ZeroSurface& surface, const std::vector<double>& spacing, const std::vector<SeedFreeBall>& free_of,
                               FieldSampler& field) {
  if (surface.soup.points.empty()) return {};
  return Spreader(surface, spacing, free_of, field).run();
}

}  // namespace burnish::detail
