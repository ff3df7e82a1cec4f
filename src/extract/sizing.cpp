#include "sizing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <limits>
#include <queue>
#include <utility>

#include "burnish/levelset/curvature.h"
#include "burnish/surface/edge_table.h"

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

}  // namespace

std::vector<double> edge_lengths(const LevelSet& level_set, const ZeroSurface& surface, const DelaunayOptions& options, Progress& progress) {
  const std::vector<FrontCurvature> curvature = front_curvature(level_set, surface.soup.points, CurvatureOrder::second, progress);
  std::vector<double> lengths(curvature.size(), options.edge);
  const double most = std::max(options.edge, options.largest_edge);
  for (std::size_t v = 0; v < lengths.size(); ++v) {
    if (!curvature[v].converged) continue;
    const double k = std::max(std::abs(curvature[v].k1), std::abs(curvature[v].k2));
    lengths[v] = std::clamp(std::sqrt(8 * options.edge_tolerance / std::max(k, 1e-9)), options.edge, most);  // [T-DELAUNAY-3]
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
