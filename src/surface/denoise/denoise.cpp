#include "burnish/surface/denoise.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>

#include "burnish/core/parallel.h"
#include "facet_mesh.h"
#include "facet_normals.h"
#include "point_update.h"
#include "polynomial_normals.h"
#include "volume_lock.h"

namespace burnish {
namespace {

using namespace denoising;

constexpr double kGuideRange = 0.53;           // radians
constexpr double kFitRange = 0.3;          // radians; sides of a crease that differ by sqrt(6) times this, 43 degrees, are kept apart altogether
constexpr double kFiltersPerNoise = 20;        // passes of the first filter, times noise over edge
constexpr int kMostFilters = 50;
constexpr double kOutlier = 2.5;               // standard deviations at which a point has a quarter of its weight
constexpr double kZeroOfWaves = 1.2077;        // radii of a disc over the length of the waves that it does not see, j(4,1) / 2 pi  [T-DENOISE-4]
constexpr PointUpdate kFilterUpdate{10};
constexpr double kAnchor = 0.002, kPull = 0.025, kStrongPull = 0.3;
constexpr int kLastUpdates = 25;
constexpr double kLongestShift = 0.5;          // mean edges
constexpr double kGaussianOutliers = 0.01;     // of the points beyond 3 sigma: of noise that is normally distributed there are 0.0027
constexpr double kWhite = 0.1;                 // Moran's I of what the first filter moved: of white noise it is negative
constexpr double kFarthest = 3, kFarthestOfOthers = 4;  // sigma: what removing noise may move a point by

// How far points have moved along the normals that they have now.
struct Moved {
  std::vector<double> along;
  double rms = 0;
  double correlation = 0;  // Moran's I over the facets' edges
};

struct WeightedSum {
  double sum = 0, weight = 0;
};

WeightedSum operator+(const WeightedSum& a, const WeightedSum& b) { return {a.sum + b.sum, a.weight + b.weight}; }

// Points that are held back say less about the noise: `mobility` weighs them. Empty: all the same.
Moved moved(const FacetMesh& mesh, const FacetGeometry& g, const std::vector<Vec3>& points, const std::vector<Vec3>& home, const std::vector<float>& mobility) {
  const std::vector<Vec3> normals = point_normals(mesh, g.normal, g.area);
  const auto weight = [&](std::size_t p) { return mobility.empty() ? 1.0 : static_cast<double>(mobility[p]); };
  Moved m{std::vector<double>(points.size())};
  const WeightedSum squares = parallel_reduce(points.size(), kDefaultGrain, WeightedSum{}, [&](std::size_t begin, std::size_t end) {
    WeightedSum all;
    for (std::size_t p = begin; p < end; ++p) {
      m.along[p] = dot(points[p] - home[p], normals[p]);
      all = all + WeightedSum{weight(p) * m.along[p] * m.along[p], weight(p)};
    }
    return all;
  }, std::plus<>());
  const WeightedSum products = parallel_reduce(mesh.facets.size(), kDefaultGrain, WeightedSum{}, [&](std::size_t begin, std::size_t end) {
    WeightedSum all;
    for (std::size_t f = begin; f < end; ++f) {
      const auto [i, j, k] = mesh.facets[f];
      const double wi = weight(i), wj = weight(j), wk = weight(k), a = wi * m.along[i], b = wj * m.along[j], c = wk * m.along[k];
      all = all + WeightedSum{a * b + b * c + c * a, wi * wj + wj * wk + wk * wi};
    }
    return all;
  }, std::plus<>());
  if (squares.sum == 0) return m;
  const double mean = squares.sum / squares.weight;
  m.rms = std::sqrt(mean);
  if (products.weight > 0) m.correlation = products.sum / (products.weight * mean);
  return m;
}

// By how much the error of a mean over many points exceeds that of independent ones, if the k-th ring of 6 k points is correlated by I^k. [T-DENOISE-4]
double error_of_means(double correlation) {
  const double i = std::clamp(correlation, 0.0, 0.5);
  return std::sqrt(1 + 6 * i / ((1 - i) * (1 - i)));
}

class Run {
 public:
  Run(const TriangleSoup& oriented, const DenoiseOptions& options, Progress& progress, DenoiseResult& result)
      : options_(options), progress_(progress), result_(result), home_(oriented.points), points_(result.soup.points), mesh_(oriented),
        geometry_(mesh_, oriented.points), edge_(mean_edge(mesh_, oriented.points)) {
    if (options.crease_angle) range_ = 2 * std::sin(0.5 * *options.crease_angle * std::numbers::pi / 180) / (kCreaseAngleRanges * kFitRange);
  }

  void operator()() {
    filter();
    const double sigma = options_.sigma.value_or(0) > 0 ? *options_.sigma : moved_.rms;
    result_.sigma = sigma;
    if (sigma > 0) fit(sigma);
    if (!options_.length) stay_within_noise(std::max(sigma, result_.noise.sigma));
    keep_bounds();
    summarise();
  }

 private:
  static constexpr double kCreaseAngleRanges = 2.449489742783178;  // sqrt(6)

  // Until the passes are as many as the noise found so far asks for; of noise that is known, no more than there is. [T-DENOISE-2]
  void filter() {
    const double known = options_.sigma.value_or(0);
    for (int i = 1; i <= kMostFilters; ++i) {
      progress_.check();
      normals_ = guided_normals(mesh_, geometry_, range_ * kGuideRange);
      update_points(mesh_, normals_, home_, options_.mobility, kFilterUpdate, points_);
      geometry_.update(mesh_, points_);
      moved_ = moved(mesh_, geometry_, points_, home_, options_.mobility);
      const double noise = known > 0 ? std::min(known, moved_.rms) : moved_.rms;
      if (i >= kFiltersPerNoise * noise / mean_edge(mesh_, points_) * error_of_means(moved_.correlation)) return;
    }
  }

  void fit(double sigma) {
    PolynomialOptions o{sigma, error_of_means(moved_.correlation), kZeroOfWaves * options_.length.value_or(0), range_ * kFitRange, trust(sigma)};
    const LocalPolynomials fits = local_polynomials(mesh_, normals_, points_, home_, o, progress_);
    const PointUpdate how{kLastUpdates, options_.length ? 0 : kAnchor, &fits.foot, options_.length ? kStrongPull : kPull};
    update_points(mesh_, fits.normal, home_, options_.mobility, how, points_);
    geometry_.update(mesh_, points_);
  }

  std::vector<float> trust(double sigma) {
    std::vector<float> trust(points_.size());
    for (std::size_t p = 0; p < points_.size(); ++p) {
      const double r = moved_.along[p] / (kOutlier * sigma), q = 1 + r * r;
      trust[p] = static_cast<float>(1 / (q * q));
      if (std::abs(moved_.along[p]) > 3 * sigma) ++result_.outliers;
    }
    return trust;
  }

  // What lies farther away than noise explains is detail. [T-DENOISE-8]
  void stay_within_noise(double sigma) {
    const bool white = moved_.correlation <= kWhite && static_cast<double>(result_.outliers) <= kGaussianOutliers * static_cast<double>(points_.size());
    limit_moves((white ? kFarthest : kFarthestOfOthers) * sigma);
  }

  void limit_moves(double limit) {
    parallel_for(points_.size(), [&](std::size_t p) {
      const Vec3 d = points_[p] - home_[p];
      if (norm(d) > limit) points_[p] = home_[p] + d * (limit / norm(d) * (1 - 1e-12));
    });
  }

  void keep_bounds() {
    std::vector<Vec3> directions = point_normals(mesh_, geometry_.normal, geometry_.area);
    for (std::size_t p = 0; p < options_.mobility.size(); ++p) directions[p] *= static_cast<double>(options_.mobility[p]);
    lock_volume(mesh_, home_, directions, kLongestShift * edge_, points_);
    if (options_.deviation) limit_moves(*options_.deviation);
  }

  void summarise() {
    geometry_.update(mesh_, points_);
    result_.rms_moved = moved(mesh_, geometry_, points_, home_, {}).rms;
    for (std::size_t p = 0; p < points_.size(); ++p) result_.max_moved = std::max(result_.max_moved, norm(points_[p] - home_[p]));
  }

  const DenoiseOptions& options_;
  Progress& progress_;
  DenoiseResult& result_;
  const std::vector<Vec3>& home_;
  std::vector<Vec3>& points_;
  FacetMesh mesh_;
  FacetGeometry geometry_;
  double edge_ = 0, range_ = 1;
  std::vector<Vec3> normals_;
  Moved moved_;
};

}  // namespace

DenoiseResult denoise(const TriangleSoup& oriented, const DenoiseOptions& options, Progress& progress) {
  progress.begin_stage("denoising");
  progress.check();
  DenoiseResult result;
  result.soup = oriented;
  result.noise = options.noise ? *options.noise : estimate_noise(oriented);
  const double sigma = options.sigma.value_or(result.noise.sigma);
  if (oriented.facets.empty() || (!(sigma > 0) && !options.length)) return result;
  Run(oriented, options, progress, result)();
  return result;
}

}  // namespace burnish
