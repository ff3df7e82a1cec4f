#include "burnish/surface/compare.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 256;

// Running maximum and moments of distances.
struct Moments {
  double max = 0, sum = 0, sum_squares = 0;
  std::size_t count = 0;

  void add(double squared) {
    const double d = std::sqrt(squared);
    max = std::max(max, d);
    sum += d;
    sum_squares += squared;
    ++count;
  }
};

// cumulative[f]: area of all facets before f; the last entry is the total.
std::vector<double> cumulative_areas(const TriangleSoup& soup) {
  std::vector<double> cumulative(soup.facets.size() + 1, 0.0);
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    cumulative[f + 1] = cumulative[f] + 0.5 * norm(facet_normal_2a(soup, f));
  return cumulative;
}

double fraction(double x) { return x - std::floor(x); }

// Point number i of a low-discrepancy sequence on facet f: the R2 sequence (Roberts 2018), folded. [T-COMP-1]
Vec3 point_on_facet(const TriangleSoup& soup, std::size_t f, std::size_t i) {
  double u = fraction(0.5 + 0.7548776662466927 * static_cast<double>(i));
  double v = fraction(0.5 + 0.5698402909980532 * static_cast<double>(i));
  if (u + v > 1) {
    u = 1 - u;
    v = 1 - v;
  }
  const Vec3& a = soup.corner(f, 0);
  return a + (soup.corner(f, 1) - a) * u + (soup.corner(f, 2) - a) * v;
}

// The distances of points 0 ... samples - 1, squared.
template <class Point>
std::vector<double> squared_distances(std::size_t samples, const TriangleIndex& to, Point&& point) {
  std::vector<double> squared(samples);
  parallel_for(samples, [&](std::size_t i) { squared[i] = to.closest(point(i)).squared_distance; }, kGrain);
  return squared;
}

Moments moments_of(const std::vector<double>& squared) {
  Moments m;
  for (const double d2 : squared) m.add(d2);
  return m;
}

// Some facet around each of the points.
std::vector<std::uint32_t> facets_at_points(const TriangleSoup& soup) {
  std::vector<std::uint32_t> facet(soup.points.size(), 0);
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) facet[p] = f;
  return facet;
}

}  // namespace

OneSidedDistance one_sided_distance(const TriangleSoup& from, const TriangleIndex& to, const CompareOptions& options,
                                    std::vector<FarSample>* far) {
  if (from.facets.empty() || to.facet_count() == 0) return {};
  const std::vector<double> cumulative = cumulative_areas(from);
  const double total = cumulative.back();
  const std::size_t n = total > 0 ? options.area_samples : 0;
  const auto facet_of_sample = [&](std::size_t i) {
    const double target = (static_cast<double>(i) + 0.5) / static_cast<double>(n) * total;
    return static_cast<std::size_t>(std::upper_bound(cumulative.begin(), cumulative.end() - 1, target) - cumulative.begin()) - 1;
  };
  const auto on_surface = [&](std::size_t i) { return point_on_facet(from, facet_of_sample(i), i); };
  const std::vector<double> by_area = squared_distances(n, to, on_surface);
  const std::size_t points = from.points.size();
  const std::size_t picked = std::min(points, options.vertex_samples);
  const auto vertex_of_sample = [&](std::size_t i) { return i * points / std::max<std::size_t>(picked, 1); };
  const std::vector<double> by_vertex =
      squared_distances(picked, to, [&](std::size_t i) { return from.points[vertex_of_sample(i)]; });

  if (far) {
    const double limit = options.far_beyond * options.far_beyond;
    for (std::size_t i = 0; i < n; ++i)
      if (by_area[i] > limit)
        far->push_back({on_surface(i), std::sqrt(by_area[i]), static_cast<std::uint32_t>(facet_of_sample(i)), total / static_cast<double>(n)});
    std::vector<std::uint32_t> facet;
    for (std::size_t i = 0; i < picked; ++i) {
      if (!(by_vertex[i] > limit)) continue;
      if (facet.empty()) facet = facets_at_points(from);
      const std::size_t p = vertex_of_sample(i);
      far->push_back({from.points[p], std::sqrt(by_vertex[i]), facet[p], 0});
    }
  }
  const Moments area_moments = moments_of(by_area), vertex_moments = moments_of(by_vertex);
  const Moments& mean_of = area_moments.count ? area_moments : vertex_moments;
  OneSidedDistance result;
  result.max = std::max(area_moments.max, vertex_moments.max);
  if (mean_of.count) {
    result.mean = mean_of.sum / static_cast<double>(mean_of.count);
    result.rms = std::sqrt(mean_of.sum_squares / static_cast<double>(mean_of.count));
  }
  result.samples = area_moments.count + vertex_moments.count;
  return result;
}

MissingComponents missing_components(const TriangleSoup& welded, const TriangleIndex& other, double tolerance) {
  UnionFind forest(welded.points.size());
  for (const Facet& f : welded.facets) {
    forest.unite(f[0], f[1]);
    forest.unite(f[1], f[2]);
  }
  std::vector<double> area_of(welded.points.size(), 0.0);
  std::vector<std::uint32_t> size_of(welded.points.size(), 0);
  for (std::size_t f = 0; f < welded.facets.size(); ++f)
    area_of[forest.find(welded.facets[f][0])] += 0.5 * norm(facet_normal_2a(welded, f));
  for (std::uint32_t p = 0; p < welded.points.size(); ++p) ++size_of[forest.find(p)];

  constexpr std::uint32_t kLookedAt = 64;
  std::vector<char> found(welded.points.size(), 0);
  std::vector<std::uint32_t> seen(welded.points.size(), 0);
  for (std::uint32_t p = 0; p < welded.points.size(); ++p) {
    const std::uint32_t root = forest.find(p);
    const bool picked = seen[root]++ % std::max(1u, size_of[root] / kLookedAt) == 0;
    if (!picked || found[root]) continue;
    found[root] = other.closest(welded.points[p], tolerance * tolerance).facet != 0xffffffffu;
  }
  MissingComponents missing;
  double largest = -1;
  for (std::uint32_t p = 0; p < welded.points.size(); ++p) {
    if (!forest.is_representative(p) || found[p] || area_of[p] <= 0) continue;
    ++missing.count;
    missing.area += area_of[p];
    if (area_of[p] > largest) {
      largest = area_of[p];
      missing.largest_at = welded.points[p];
    }
  }
  return missing;
}

}  // namespace burnish
