#include "burnish/surface/compare.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/shells.h"
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

// The samples of a surface: area samples spread over the facets, and vertices.
class Samples {
 public:
  Samples(const TriangleSoup& soup, const CompareOptions& options)
      : soup_(soup),
        cumulative_(cumulative_areas(soup)),
        by_area_(area() > 0 ? options.area_samples : 0),
        by_vertex_(std::min(soup.points.size(), options.vertex_samples)) {}

  std::size_t by_area() const { return by_area_; }
  std::size_t by_vertex() const { return by_vertex_; }
  // Of the surface.
  double area() const { return cumulative_.back(); }
  // That an area sample stands for.
  double share() const { return area() / static_cast<double>(by_area_); }

  std::size_t facet(std::size_t i) const {
    const double target = (static_cast<double>(i) + 0.5) / static_cast<double>(by_area_) * area();
    return static_cast<std::size_t>(std::upper_bound(cumulative_.begin(), cumulative_.end() - 1, target) - cumulative_.begin()) - 1;
  }
  Vec3 on_facet(std::size_t i) const { return point_on_facet(soup_, facet(i), i); }
  std::size_t vertex(std::size_t i) const { return i * soup_.points.size() / std::max<std::size_t>(by_vertex_, 1); }
  const Vec3& at_vertex(std::size_t i) const { return soup_.points[vertex(i)]; }

 private:
  const TriangleSoup& soup_;
  std::vector<double> cumulative_;
  std::size_t by_area_, by_vertex_;
};

// The distances of points 0 ... samples - 1, squared.
template <class Point>
std::vector<double> squared_distances(std::size_t samples, const TriangleIndex& to, Point&& point, const Progress& progress) {
  std::vector<double> squared(samples);
  parallel_for(samples, [&](std::size_t i) {
    if (i % kGrain == 0) progress.check();
    squared[i] = to.closest(point(i)).squared_distance;
  }, kGrain);
  return squared;
}

Moments moments_of(const std::vector<double>& squared) {
  Moments m;
  for (const double d2 : squared) m.add(d2);
  return m;
}

const ClosestPoint& closest_of(const ClosestPoint& found) { return found; }
const ClosestPoint& closest_of(const SampleError& found) { return found.closest; }

template <class Found>
std::vector<double> distances_of(const std::vector<Found>& found) {
  std::vector<double> distances(found.size());
  for (std::size_t i = 0; i < found.size(); ++i) distances[i] = std::sqrt(closest_of(found[i]).squared_distance);
  return distances;
}

Distribution distribution_of(std::vector<double> values) {
  Distribution d;
  d.samples = values.size();
  if (values.empty()) return d;
  double sum = 0, sum_squares = 0;
  for (const double v : values) {
    sum += v;
    sum_squares += v * v;
  }
  const double count = static_cast<double>(values.size());
  d.mean = sum / count;
  d.rms = std::sqrt(sum_squares / count);
  parallel_sort(values);
  d.max = values.back();
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) {
    const auto rank = static_cast<std::size_t>(std::ceil(kPercentiles[i] * count / 100));
    d.percentiles[i] = values[std::clamp<std::size_t>(rank, 1, values.size()) - 1];
  }
  return d;
}

double angle_between(const TriangleSoup& from, std::size_t facet, const TriangleSoup& to, std::uint32_t closest) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  if (closest == kNoFacet) return kNone;  // a distance that is no number
  const Vec3 m = facet_normal_2a(from, facet), n = facet_normal_2a(to, closest);
  return m != Vec3{} && n != Vec3{} ? angle_in_degrees(m, n) : kNone;
}

SampleError error_of(const Vec3& at, const TriangleSoup& from, std::size_t facet, const TriangleSoup& to, const ClosestQuery& closest) {
  const ClosestPoint found = closest(at);
  return {at, static_cast<std::uint32_t>(facet), found, angle_between(from, facet, to, found.facet)};
}

std::vector<SampleError> errors_of(const Samples& samples, const TriangleSoup& from, const TriangleSoup& to, const ClosestQuery& closest) {
  std::vector<SampleError> errors(samples.by_area());
  parallel_for(errors.size(), [&](std::size_t i) { errors[i] = error_of(samples.on_facet(i), from, samples.facet(i), to, closest); }, kGrain);
  return errors;
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
                                    std::vector<FarSample>* far, const Progress& progress) {
  if (from.facets.empty() || to.facet_count() == 0) return {};
  const Samples samples(from, options);
  const std::vector<double> by_area = squared_distances(samples.by_area(), to, [&](std::size_t i) { return samples.on_facet(i); }, progress);
  const std::vector<double> by_vertex = squared_distances(samples.by_vertex(), to, [&](std::size_t i) { return samples.at_vertex(i); }, progress);

  if (far) {
    const double limit = options.far_beyond * options.far_beyond;
    for (std::size_t i = 0; i < by_area.size(); ++i)
      if (by_area[i] > limit)
        far->push_back({samples.on_facet(i), std::sqrt(by_area[i]), static_cast<std::uint32_t>(samples.facet(i)), samples.share()});
    std::vector<std::uint32_t> facet;
    for (std::size_t i = 0; i < by_vertex.size(); ++i) {
      if (!(by_vertex[i] > limit)) continue;
      if (facet.empty()) facet = facets_at_points(from);
      far->push_back({samples.at_vertex(i), std::sqrt(by_vertex[i]), facet[samples.vertex(i)], 0});
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

OneSidedComparison one_sided_comparison(const TriangleSoup& from, const TriangleSoup& to, const ClosestQuery& closest,
                                        const CompareOptions& options) {
  OneSidedComparison result;
  if (from.facets.empty() || to.facets.empty()) return result;
  const Samples samples(from, options);
  const std::vector<SampleError> by_area = errors_of(samples, from, to, closest);
  std::vector<ClosestPoint> by_vertex(samples.by_vertex());
  parallel_for(by_vertex.size(), [&](std::size_t i) { by_vertex[i] = closest(samples.at_vertex(i)); }, kGrain);

  result.distance = distribution_of(by_area.empty() ? distances_of(by_vertex) : distances_of(by_area));
  result.distance.samples = by_area.size() + by_vertex.size();
  double farthest = -1;
  const auto look_at = [&](const Vec3& point, const ClosestPoint& found) {
    if (!(found.squared_distance > farthest)) return;
    farthest = found.squared_distance;
    result.farthest = point;
    result.opposite = found.point;
  };
  for (const SampleError& e : by_area) look_at(e.at, e.closest);
  for (std::size_t i = 0; i < by_vertex.size(); ++i) look_at(samples.at_vertex(i), by_vertex[i]);
  result.distance.max = std::sqrt(std::max(farthest, 0.0));

  std::vector<double> angles;
  angles.reserve(by_area.size());
  for (const SampleError& e : by_area)
    if (!std::isnan(e.angle)) angles.push_back(e.angle);
  result.angle = distribution_of(std::move(angles));
  return result;
}

std::vector<SampleError> sample_errors(const TriangleSoup& from, const TriangleSoup& to, const ClosestQuery& closest,
                                       std::size_t samples) {
  if (from.facets.empty() || to.facets.empty()) return {};
  return errors_of(Samples(from, {.area_samples = samples, .vertex_samples = 0}), from, to, closest);
}

SampleError error_at_centroid(const TriangleSoup& from, std::size_t facet, const TriangleSoup& to, const ClosestQuery& closest) {
  const Vec3 centroid = (from.corner(facet, 0) + from.corner(facet, 1) + from.corner(facet, 2)) / 3;
  return error_of(centroid, from, facet, to, closest);
}

// An arc cosine loses half the digits at both ends. [T-COMP-3]
double angle_in_degrees(const Vec3& a, const Vec3& b) {
  return std::atan2(norm(cross(a, b)), dot(a, b)) * 180 / std::numbers::pi;
}

MissingComponents missing_components(const TriangleSoup& welded, const TriangleIndex& other, double tolerance) {
  UnionFind forest = connected_points(welded);
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
