#include "sizing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "burnish/levelset/curvature.h"
#include "burnish/surface/edge_table.h"
#include "point_grid.h"

namespace burnish::detail {
namespace {

std::uint64_t cell_key(const Vec3& p, int dx, int dy, int dz) {
  const auto along = [](double x, int d) { return static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(x)) + d) & 0x1fffff; };
  return along(p.x, dx) | along(p.y, dy) << 21 | along(p.z, dz) << 42;
}

// Dijkstra's algorithm from all points at once: no length exceeds that of a neighbour by more than the growth over the edge between them.
void limit_growth(const TriangleSoup& soup, std::vector<double>& lengths) {
  const EdgeTable table(soup);
  std::vector<std::uint32_t> first(soup.points.size() + 1, 0), neighbor(2 * table.size());
  for (std::size_t e = 0; e < table.size(); ++e)
    for (const std::uint32_t v : table.edge(e)) ++first[v + 1];
  for (std::size_t v = 1; v < first.size(); ++v) first[v] += first[v - 1];
  std::vector<std::uint32_t> next = first;
  for (std::size_t e = 0; e < table.size(); ++e)
    for (int side = 0; side < 2; ++side) neighbor[next[table.edge(e)[static_cast<std::size_t>(side)]]++] = table.edge(e)[static_cast<std::size_t>(1 - side)];
  using Entry = std::pair<double, std::uint32_t>;
  std::priority_queue<Entry, std::vector<Entry>, std::greater<>> queue;
  for (std::uint32_t v = 0; v < lengths.size(); ++v) queue.emplace(lengths[v], v);
  while (!queue.empty()) {
    const auto [length, v] = queue.top();
    queue.pop();
    if (length > lengths[v]) continue;
    for (std::uint32_t i = first[v]; i < first[v + 1]; ++i) {
      const std::uint32_t w = neighbor[i];
      const double most = length + kGrowth * norm(soup.points[w] - soup.points[v]);
      if (!(most < lengths[w])) continue;
      lengths[w] = most;
      queue.emplace(most, w);
    }
  }
}

struct LengthRange {
  double least, most, tolerance;
  double length(double curvature) const { return std::clamp(std::sqrt(8 * tolerance / std::max(curvature, 1e-9)), least, most); }  // [T-DELAUNAY-3]
};

// Lengths of edges at the points of curves, from what they bend over kWindow chords.
class NearCurves {
 public:
  NearCurves(const std::vector<std::vector<Vec3>>& curves, const LengthRange& range) : grid_(kReach) {
    for (const std::vector<Vec3>& curve : curves)
      for (std::size_t i = 0; i < curve.size(); ++i) {
        grid_.insert(curve[i], static_cast<std::uint32_t>(points_.size()));
        points_.push_back(curve[i]);
        lengths_.push_back(range.length(bend_at(curve, i)));
      }
  }

  // That of the nearest point; 0 beyond kReach.
  double length_at(const Vec3& p) const {
    double nearest = kReach * kReach, length = 0;
    grid_.for_each_near(p, [&](std::uint32_t n) {
      const double d = squared_norm(points_[n] - p);
      if (d >= nearest) return;
      nearest = d;
      length = lengths_[n];
    });
    return length;
  }

 private:
  static constexpr double kReach = 3;         // cells: stencils of curvature see the crease from there
  static constexpr std::size_t kWindow = 4;

  // Eight sagittas over the square of the chord; ends are like what is beside them.
  static double bend_at(const std::vector<Vec3>& curve, std::size_t i) {
    if (curve.size() < 2 * kWindow + 1) return 0;
    const std::size_t middle = std::clamp(i, kWindow, curve.size() - 1 - kWindow);
    const Vec3 &a = curve[middle - kWindow], &b = curve[middle + kWindow];
    const double chord = squared_norm(b - a);
    return chord > 0 ? 8 * norm(curve[middle] - (a + b) * 0.5) / chord : 1e9;
  }

  PointGrid grid_;
  std::vector<Vec3> points_;
  std::vector<double> lengths_;
};

}  // namespace

std::vector<double> edge_lengths(const LevelSet& level_set, const ZeroSurface& surface, const std::vector<std::vector<Vec3>>& curves,
                                 const DelaunayOptions& options, Progress& progress) {
  const std::vector<FrontCurvature> curvature = front_curvature(level_set, surface.soup.points, CurvatureOrder::second, progress);
  const LengthRange range{options.edge, std::max(options.edge, options.largest_edge), options.edge_tolerance};
  const NearCurves near(curves, range);
  std::vector<double> lengths(curvature.size(), range.least);
  for (std::size_t v = 0; v < lengths.size(); ++v) {
    if (!is_finite(surface.soup.points[v])) continue;
    if (const double along = near.length_at(surface.soup.points[v]); along > 0)
      lengths[v] = along;
    else if (curvature[v].converged)
      lengths[v] = range.length(std::max(std::abs(curvature[v].k1), std::abs(curvature[v].k2)));
  }
  limit_growth(surface.soup, lengths);
  return lengths;
}

LengthByCell::LengthByCell(const std::vector<Vec3>& points, const std::vector<double>& lengths, double otherwise) : otherwise_(otherwise) {
  for (std::size_t v = 0; v < points.size(); ++v) {
    if (!is_finite(points[v])) continue;
    const auto [at, added] = least_.emplace(cell_key(points[v], 0, 0, 0), lengths[v]);
    at->second = std::min(at->second, lengths[v]);
  }
}

double LengthByCell::operator()(const Vec3& p) const {
  if (const auto own = least_.find(cell_key(p, 0, 0, 0)); own != least_.end()) return own->second;
  double least = std::numeric_limits<double>::infinity();
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if (const auto found = least_.find(cell_key(p, dx, dy, dz)); found != least_.end()) least = std::min(least, found->second);
  return std::isfinite(least) ? least : otherwise_;
}

}  // namespace burnish::detail
