#include "curvature_summary.h"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "burnish/surface/edge_table.h"

namespace burnish {
namespace {

// A third of the facets' area at each of their corners.
std::vector<double> areas_at_points(const TriangleSoup& surface) {
  std::vector<double> areas(surface.points.size(), 0.0);
  for (std::size_t f = 0; f < surface.facets.size(); ++f)
    for (const std::uint32_t p : surface.facets[f]) areas[p] += norm(facet_normal_2a(surface, f)) / 6;
  return areas;
}

struct Weighted {
  double value = 0, weight = 0;
};

CurvatureSpread spread_of(std::vector<Weighted> values) {
  CurvatureSpread spread;
  if (values.empty()) return spread;
  std::stable_sort(values.begin(), values.end(), [](const Weighted& a, const Weighted& b) { return a.value < b.value; });
  double total = 0, sum = 0;
  for (const Weighted& v : values) total += v.weight, sum += v.weight * v.value;
  spread.min = values.front().value;
  spread.max = values.back().value;
  spread.mean = total > 0 ? sum / total : 0;
  double below = 0;
  std::size_t next = 0;
  for (const Weighted& v : values) {
    below += v.weight;
    while (next < kCurvaturePercentiles.size() && below >= kCurvaturePercentiles[next] / 100 * total) spread.percentiles[next++] = v.value;
  }
  while (next < kCurvaturePercentiles.size()) spread.percentiles[next++] = spread.max;
  return spread;
}

// V - E + F, if every edge has two facets that agree.
std::optional<std::int64_t> euler_characteristic(const TriangleSoup& surface, const std::vector<double>& areas) {
  const EdgeTable edges(surface);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges.uses(e).size() != 2 || edges.is_misoriented(e)) return std::nullopt;
  const auto points = std::count_if(areas.begin(), areas.end(), [](double a) { return a > 0; });
  return static_cast<std::int64_t>(points) - static_cast<std::int64_t>(edges.size()) + static_cast<std::int64_t>(surface.facets.size());
}

}  // namespace

CurvatureSummary summarize_curvature(const TriangleSoup& surface, std::span<const FrontCurvature> at, double cell, CurvatureOrder order, CurvaturePoints points,
                                     bool mean_only) {
  const std::vector<double> areas = areas_at_points(surface);
  CurvatureSummary summary;
  summary.points = at.size();
  summary.facets = surface.facets.size();
  summary.area = std::accumulate(areas.begin(), areas.end(), 0.0);
  const bool integrates = points == CurvaturePoints::surface;
  std::vector<Weighted> mean, gaussian, k1, k2;
  const FrontCurvature *sharpest = nullptr, *hollowest = nullptr;
  double determined_area = 0, mean_integral = 0, gaussian_integral = 0;
  for (std::size_t p = 0; p < at.size(); ++p) {
    const FrontCurvature& c = at[p];
    if (!c.converged) continue;
    const double weight = integrates ? areas[p] : 1;
    ++summary.determined;
    summary.lower_order += c.order < static_cast<int>(order);
    determined_area += weight;
    mean.push_back({c.mean() / cell, weight});
    mean_integral += weight * mean.back().value;
    if (mean_only) continue;
    gaussian.push_back({c.gaussian() / (cell * cell), weight});
    gaussian_integral += weight * gaussian.back().value;
    k1.push_back({c.k1 / cell, weight});
    k2.push_back({c.k2 / cell, weight});
    if (c.k1 > 0 && (sharpest == nullptr || c.k1 > sharpest->k1)) sharpest = &c;
    if (c.k2 < 0 && (hollowest == nullptr || c.k2 < hollowest->k2)) hollowest = &c;
  }
  summary.mean = spread_of(std::move(mean));
  if (integrates) {
    summary.determined_area = determined_area;
    summary.mean_integral = mean_integral;
    summary.euler_characteristic = euler_characteristic(surface, areas);
  }
  if (mean_only) {
    summary.lower_order = 0;
    return summary;
  }
  summary.gaussian = spread_of(std::move(gaussian));
  summary.k1 = spread_of(std::move(k1));
  summary.k2 = spread_of(std::move(k2));
  if (integrates) summary.gaussian_integral = gaussian_integral;
  const auto place = [&](const FrontCurvature* c) { return surface.points[static_cast<std::size_t>(c - at.data())]; };
  if (sharpest) summary.convex = {cell / sharpest->k1, place(sharpest)};
  if (hollowest) summary.concave = {-cell / hollowest->k2, place(hollowest)};
  return summary;
}

CurvatureCheck compare_curvatures(std::span<const Vec3> points, std::span<const FrontCurvature> a, std::span<const FrontCurvature> b, double cell) {
  CurvatureCheck check;
  std::vector<double> differences;
  for (std::size_t p = 0; p < points.size(); ++p) {
    if (!a[p].converged || !b[p].converged) continue;
    ++check.points;
    const double d1 = (a[p].k1 - b[p].k1) / cell, d2 = (a[p].k2 - b[p].k2) / cell, largest = std::max(std::abs(d1), std::abs(d2));
    check.rms += d1 * d1 + d2 * d2;
    check.rms_curvature += (a[p].k1 * a[p].k1 + a[p].k2 * a[p].k2) / (cell * cell);
    if (largest >= check.max) check.max = largest, check.worst = points[p];
    differences.push_back(largest);
  }
  if (check.points == 0) return check;
  const auto middle = differences.begin() + static_cast<std::ptrdiff_t>(differences.size() / 2);
  std::nth_element(differences.begin(), middle, differences.end());
  check.median = *middle;
  check.rms = std::sqrt(check.rms / static_cast<double>(2 * check.points));
  check.rms_curvature = std::sqrt(check.rms_curvature / static_cast<double>(2 * check.points));
  return check;
}

}  // namespace burnish
