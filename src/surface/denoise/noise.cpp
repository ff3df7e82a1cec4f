#include "burnish/surface/noise.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "burnish/core/parallel.h"
#include "noise_creases.h"
#include "noise_hinges.h"
#include "noise_patch.h"
#include "outliers.h"

namespace burnish {
namespace {

constexpr std::size_t kSamples = 10000, kPatchPoints = 17, kPairs = 3;
constexpr int kLeastFreedom = 5;
constexpr double kMostLeverage = 0.9;
// What neighbours' residuals are correlated by where they are all shape; how large such residuals get, in mean edges.
constexpr double kShapeCorrelation = 0.3, kMostShape = 0.1;
constexpr double kLeastEvenness = 0.62, kWeightOfShape = 0.45, kLeastHinge = 0.4;
constexpr double kFewOutliers = 0.001;  // of the points: not worth another look
constexpr double kReach = 3.5;  // of a patch, in sigma
constexpr std::array<double, 3> kQuantiles{0.1, 0.25, 0.5}, kNormalQuantiles{-1.28155, -0.67449, 0};

// A point with one of its neighbours.
struct Pair {
  double variance = 0;  // sigma^2, as the neighbour's neighbourhood has it
  double excess = 0;    // product of the two residuals in units of sigma^2, less what white noise has on average
  double weight = 0;    // what `excess` were if the two residuals were equal; 0: no pair
};

struct Sample {
  bool valid = false;
  int freedom = 0;
  double variance = 0;  // sigma^2, as the point's neighbourhood has it
  std::array<Pair, kPairs> pairs;
};

// Wilson and Hilferty's approximation, for a variable of mean 1: within 1 % from 3 degrees of freedom on. [T-NOISE-2]
double chi_squared_quantile(double freedom, double normal_quantile) {
  const double v = 2 / (9 * freedom), root = 1 - v + normal_quantile * std::sqrt(v);
  return root * root * root;
}

double quantile(std::vector<double>& values, double share) {
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(share * static_cast<double>(values.size()));
  std::nth_element(values.begin(), at, values.end());
  return *at;
}

// Covariance of two centres' residuals under white noise of variance 1: the product of their rows of I - H. [T-NOISE-3]
double white_covariance(std::span<const std::uint32_t> a, const PatchFit& fit_a, std::span<const std::uint32_t> b, const PatchFit& fit_b) {
  double sum = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto at = std::find(b.begin(), b.end(), a[i]);
    if (at == b.end()) continue;
    const std::size_t j = static_cast<std::size_t>(at - b.begin());
    sum += ((i == 0 ? 1.0 : 0.0) - fit_a.influence[i]) * ((j == 0 ? 1.0 : 0.0) - fit_b.influence[j]);
  }
  return sum;
}

bool usable(const PatchFit& fit) { return fit.valid && fit.freedom >= kLeastFreedom && fit.leverage < kMostLeverage; }

class Sampler {
 public:
  Sampler(const TriangleSoup& soup, const PointGraph& graph) : points_(soup.points), graph_(graph) {}

  // `paired`: with neighbours.
  std::vector<Sample> samples(double radius, bool paired) const {
    const std::size_t step = (points_.size() + kSamples - 1) / kSamples;
    if (step == 0) return {};
    std::vector<Sample> all((points_.size() + step - 1) / step);
    parallel_ranges(all.size(), 2500, [&](std::size_t begin, std::size_t end) {
      PatchCollector collector(graph_), other(graph_);
      for (std::size_t i = begin; i < end; ++i) all[i] = sample(static_cast<std::uint32_t>(i * step), radius, paired, collector, other);
    });
    std::erase_if(all, [](const Sample& s) { return !s.valid; });
    return all;
  }

 private:
  Sample sample(std::uint32_t p, double radius, bool paired, PatchCollector& collector, PatchCollector& other) const {
    Sample s;
    const auto neighbors = graph_.neighbors(p);
    if (graph_.irregular[p] || neighbors.empty()) return s;
    const auto patch = collector.collect(p, kPatchPoints, radius, points_);
    const PatchFit fit = fit_patch(patch, graph_, points_);
    if (!usable(fit)) return s;
    s.valid = true;
    s.freedom = fit.freedom;
    s.variance = fit.rss / fit.freedom;  // [T-NOISE-1]
    if (!paired || !(fit.rss > 0)) return s;
    for (std::size_t i = 0; i < kPairs; ++i) {
      const auto beside = other.collect(neighbors[i * neighbors.size() / kPairs], kPatchPoints, radius, points_);
      s.pairs[i] = pair(patch, fit, beside, fit_patch(beside, graph_, points_));
    }
    return s;
  }

  static Pair pair(std::span<const std::uint32_t> patch, const PatchFit& fit, std::span<const std::uint32_t> beside, const PatchFit& next) {
    if (!usable(next) || !(next.rss > 0) || dot(fit.normal, next.normal) < 0.5) return {};
    const double variance = fit.rss / fit.freedom, other_variance = next.rss / next.freedom;
    return {other_variance, fit.residual * next.residual / std::sqrt(variance * other_variance) - white_covariance(patch, fit, beside, next),
            std::sqrt((1 - fit.leverage) * (1 - next.leverage))};
  }

  const std::vector<Vec3>& points_;
  const PointGraph& graph_;
};

// sigma^2 as each of the three quantiles gives it. [T-NOISE-2]
std::array<double, 3> levels(const std::vector<Sample>& samples) {
  std::array<double, 3> result{};
  std::vector<double> values(samples.size());
  for (std::size_t q = 0; q < result.size(); ++q) {
    for (std::size_t i = 0; i < samples.size(); ++i)
      values[i] = samples[i].variance / chi_squared_quantile(samples[i].freedom, kNormalQuantiles[q]);
    result[q] = quantile(values, kQuantiles[q]);
  }
  return result;
}

// Moran's I where the residuals are about the level, so that creases have no part. [T-NOISE-3]
double correlation(const std::vector<Sample>& samples, double level) {
  double sum = 0, weight = 0;
  for (const Sample& s : samples)
    for (const Pair& pair : s.pairs)
      if (s.variance < 2 * level && pair.variance < 2 * level) {
        sum += pair.excess;
        weight += pair.weight;
      }
  return weight > 0 ? sum / weight : 0;
}

// Float32 coordinates are rounded by this much, at most.
double rounding(const TriangleSoup& soup) {
  const Box3 box = bounding_box(soup);
  double largest = 0;
  for (int axis = 0; axis < 3 && !box.empty(); ++axis) largest = std::max({largest, std::abs(box.lower[axis]), std::abs(box.upper[axis])});
  return largest * 0x1p-24;
}

// Parts the level into noise and shape, and says which of them it is.
void judge(const std::vector<Sample>& samples, const std::array<double, 3>& level, double hinges, double floor, NoiseEstimate& estimate) {
  const double variance = *std::min_element(level.begin(), level.end());
  estimate.residual = std::sqrt(variance);
  if (!(estimate.residual > floor)) return;
  estimate.correlation = correlation(samples, variance);
  const double most = kMostShape * estimate.mean_edge * kMostShape * estimate.mean_edge;
  const double shape = std::min({std::max(0.0, estimate.correlation / kShapeCorrelation) * variance, most, variance});
  const double low = level[0] / level[1], high = level[0] / level[2];
  estimate.evenness = std::max(low, 0.5 * (std::sqrt(low) + std::sqrt(high))) - kWeightOfShape * shape / variance;  // [T-NOISE-5]
  if (estimate.evenness >= kLeastEvenness && hinges >= kLeastHinge * estimate.residual) estimate.sigma = std::sqrt(variance - shape);
}

// Sets what is known of the level, from scratch.
void set_level(const TriangleSoup& soup, const EdgeTable& edges, const PointGraph& graph, NoiseEstimate& estimate) {
  estimate.sigma = estimate.residual = estimate.correlation = estimate.evenness = 0;
  const Sampler sampler(soup, graph);
  double reach = 0;  // patches must be wider than the noise is high, or they are fitted to its folds
  for (int pass = 0; pass < 2; ++pass) {
    const std::vector<Sample> samples = sampler.samples(reach, false);
    estimate.fits = samples.size();
    if (!estimate.has_neighborhoods()) return;
    const auto level = levels(samples);
    reach = kReach * std::sqrt(*std::min_element(level.begin(), level.end()));
    if (reach < 0.5 * estimate.mean_edge) break;
  }
  const std::vector<Sample> samples = sampler.samples(reach, true);
  if (!samples.empty()) judge(samples, levels(samples), hinge_level(soup, edges), rounding(soup), estimate);
}

// Outliers are in the level, and the level decides what is one: twice is enough.
void set_level_without_outliers(const TriangleSoup& soup, const EdgeTable& edges, NoiseEstimate& estimate) {
  const PointGraph graph = point_graph(soup, edges);
  set_level(soup, edges, graph, estimate);
  for (int round = 0; round < 2 && estimate.has_neighborhoods(); ++round) {
    const std::vector<Outlier> outliers = search_outliers(soup, graph, estimate);
    estimate.outlier_share = static_cast<double>(outliers.size()) / static_cast<double>(soup.points.size());
    if (estimate.outlier_share < kFewOutliers) return;
    TriangleSoup clamped = soup;
    clamp_outliers(outliers, clamped);
    set_level(clamped, edges, graph, estimate);
  }
}

}  // namespace

NoiseEstimate estimate_noise(const TriangleSoup& oriented) {
  NoiseEstimate estimate;
  estimate.mean_edge = mean_edge_length(oriented);
  const EdgeTable edges(oriented);
  set_level_without_outliers(oriented, edges, estimate);
  set_creases(oriented, edges, estimate);
  return estimate;
}

}  // namespace burnish
