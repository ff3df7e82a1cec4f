#include "outliers.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr double kDeviations = 5, kCandidate = 0.5;
constexpr std::size_t kPatchPoints = 17, kLeastPoints = 12, kSamples = 4000, kGrain = 4096, kMostAround = 256;
constexpr int kAbsolutePasses = 4, kBisquarePasses = 3, kRounds = 3;
constexpr double kBisquare = 4.685, kNormalMad = 1.4826;
constexpr double kQuarter = 0.25, kQuarterOfNormal = 0.31864;  // |x| < 0.31864 for a quarter of a standard normal distribution

// When a point is taken for a place where pieces of the surface meet. Noise tilts facets, so that one or two of them pass a point by chance.
struct Rule {
  double least_edges;   // an outlier's least distance, in edges around it
  double tolerance;     // of a plane passing it, of its distance
  std::size_t passing;  // planes that make it part of the surface
  int suspects;         // among its neighbours, up to which they do not speak for each other
};
constexpr Rule kWithoutNoise{0.5, 0.15, 1, 1}, kWithNoise{0.2, 0.05, 3, 3};

using Values = std::array<double, PatchCollector::kMost>;

// Calls visit(entry) with all entries of a short row, with at most kMostAround of a longer one, evenly; until it returns true. All points on the rim of a
// fan ask about its apex: each must not walk around the whole of it.
template <class Visit>
bool for_some(std::span<const std::uint32_t> row, Visit&& visit) {
  const std::size_t step = (row.size() + kMostAround - 1) / kMostAround;
  for (std::size_t i = 0; i < row.size(); i += step)
    if (visit(row[i])) return true;
  return false;
}

// Facets around each point.
struct Fans {
  std::vector<std::uint32_t> first, facets;

  std::span<const std::uint32_t> around(std::uint32_t p) const { return {facets.data() + first[p], first[p + 1] - first[p]}; }
};

Fans fans_of(const TriangleSoup& soup) {
  Fans fans;
  fans.first.assign(soup.points.size() + 1, 0);
  for (const Facet& f : soup.facets)
    for (const std::uint32_t p : f) ++fans.first[p];
  exclusive_scan_in_place(fans.first);
  fans.facets.resize(3 * soup.facets.size());
  std::vector<std::uint32_t> next(fans.first.begin(), fans.first.end() - 1);
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) fans.facets[next[p]++] = f;
  return fans;
}

// Of a quadric through the neighbours of a point, all in model units.
struct RobustFit {
  bool valid = false;
  double height = 0;  // of the point above it, signed
  double scale = 0;   // standard deviation of the neighbours
  QuadricRow coefficients{};
};

double median_of_neighbors(Values values, std::size_t count) {
  const auto at = [&](std::size_t i) { return values.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(1), at(1 + (count - 1) / 2), at(count));
  return *at(1 + (count - 1) / 2);
}

double bisquare(double residual, double scale) {
  const double t = residual / (kBisquare * scale), w = 1 - t * t;
  return t < 1 ? w * w : 0x1p-20;
}

// Least absolute residuals first, which a minority of outliers does not move, then Tukey's bisquare: iteratively reweighted. [T-OUTLIER-1]
RobustFit robust_fit(const PatchSystem& system, double least_scale) {
  RobustFit fit;
  Values weights, residuals{};
  weights.fill(1);
  weights[0] = 0;
  const double neighbors = static_cast<double>(system.count - 1);
  const double to_deviation = kNormalMad * std::sqrt(neighbors / (neighbors - static_cast<double>(kQuadricCoefficients)));
  const double floor = std::max(least_scale / system.size, 0x1p-40);  // exact planes have no scale
  double scale = 0;
  for (int pass = 0; pass <= kAbsolutePasses + kBisquarePasses; ++pass) {
    const auto solved = weighted_quadric(system, {weights.data(), system.count});
    if (!solved) return fit;
    fit.coefficients = *solved;
    for (std::size_t i = 0; i < system.count; ++i) residuals[i] = std::abs(system.residual(fit.coefficients, i));
    scale = std::max(floor, to_deviation * median_of_neighbors(residuals, system.count));
    for (std::size_t i = 1; i < system.count; ++i)
      weights[i] = pass < kAbsolutePasses ? scale / std::max(residuals[i], 0.1 * scale) : bisquare(residuals[i], scale);
  }
  const double upright = system.size * dot(system.normal(fit.coefficients), system.n);
  fit.height = system.residual(fit.coefficients, 0) * upright;
  fit.scale = scale * upright;
  fit.valid = true;
  return fit;
}

class Search {
 public:
  Search(const TriangleSoup& soup, const PointGraph& graph, const NoiseEstimate& noise)
      : soup_(soup), points_(soup.points), graph_(graph), fans_(fans_of(soup)), rule_(noise.noisy() ? kWithNoise : kWithoutNoise),
        sigma_(noise.noisy() ? core_of_noise(noise.sigma) : noise.sigma) {}

  // Facets of outliers pass other outliers. So points that a plane has spoken for are suspects, and are looked at again without facets of those found.
  std::vector<Outlier> run() {
    std::vector<Outlier> found(points_.size());
    verdict_.assign(points_.size(), Verdict::open);
    for (round_ = 0; round_ < kRounds; ++round_) {
      std::vector<Verdict> verdict = verdict_;
      parallel_ranges(points_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
        PatchCollector collector(graph_);
        for (std::size_t p = begin; p < end; ++p)
          if (verdict_[p] == Verdict::open) verdict[p] = examine(static_cast<std::uint32_t>(p), collector, found[p]);
      });
      verdict_.swap(verdict);
    }
    std::erase_if(found, [](const Outlier& o) { return !(o.distance > 0); });
    return found;
  }

 private:
  enum class Verdict : std::uint8_t { open, inlier, outlier };

  PatchSystem system_at(std::span<const std::uint32_t> patch) const {
    PatchSystem system = patch_system(patch, graph_, points_);
    system.valid = system.valid && patch.size() >= kLeastPoints;
    return system;
  }

  // Impulses that many points have are in sigma, and would hide in it: of a mixture, the standard deviation of the lower part. [T-OUTLIER-3]
  double core_of_noise(double sigma) const {
    if (points_.empty()) return sigma;
    const std::size_t step = (points_.size() + kSamples - 1) / kSamples;
    std::vector<double> heights((points_.size() + step - 1) / step, -1);
    parallel_ranges(heights.size(), 500, [&](std::size_t begin, std::size_t end) {
      PatchCollector collector(graph_);
      for (std::size_t i = begin; i < end; ++i) {
        const auto p = static_cast<std::uint32_t>(i * step);
        if (graph_.irregular[p]) continue;
        const PatchSystem system = system_at(collector.collect(p, kPatchPoints, 0, points_));
        const RobustFit fit = system.valid ? robust_fit(system, 0) : RobustFit{};
        if (fit.valid) heights[i] = std::abs(fit.height);
      }
    });
    std::erase_if(heights, [](double h) { return h < 0; });
    if (heights.empty()) return sigma;
    const auto at = heights.begin() + static_cast<std::ptrdiff_t>(kQuarter * static_cast<double>(heights.size()));
    std::nth_element(heights.begin(), at, heights.end());
    return std::min(sigma, *at / kQuarterOfNormal);
  }

  // Mean distance of the neighbours of p from the nearest other one: what edges would be without p.
  double edge_around(std::uint32_t p) const {
    const auto neighbors = graph_.neighbors(p);
    double sum = 0;
    for (const std::uint32_t q : neighbors) {
      double nearest = norm(points_[q] - points_[p]);
      for_some(graph_.neighbors(q), [&](std::uint32_t r) {
        if (r != p) nearest = std::min(nearest, norm(points_[r] - points_[q]));
        return false;
      });
      sum += nearest;
    }
    return neighbors.empty() ? 0 : sum / static_cast<double>(neighbors.size());
  }

  Verdict examine(std::uint32_t p, PatchCollector& collector, Outlier& outlier) const {
    if (graph_.irregular[p]) return Verdict::inlier;
    const auto patch = collector.collect(p, kPatchPoints, 0, points_);
    if (patch.size() < kLeastPoints) return Verdict::inlier;
    const PatchFit plain = fit_patch(patch, graph_, points_);
    // A residual over 1 - leverage is the distance from the fit of the others.
    const auto is_candidate = [&](double least) { return plain.valid && std::abs(plain.residual) > kCandidate * least * (1 - plain.leverage); };
    if (!is_candidate(kDeviations * sigma_)) return Verdict::inlier;
    const double least = std::max(kDeviations * sigma_, rule_.least_edges * edge_around(p));
    if (!is_candidate(least)) return Verdict::inlier;
    const PatchSystem system = system_at(patch);
    const RobustFit fit = system.valid ? robust_fit(system, sigma_) : RobustFit{};
    const double distance = std::abs(fit.height);
    if (!fit.valid || !(distance > std::max(least, kDeviations * fit.scale))) return Verdict::inlier;
    if (surface_passes(p, patch, rule_.tolerance * distance)) return Verdict::open;
    outlier = {p, points_[p], fitted(system, fit, p), distance};
    return Verdict::outlier;
  }

  // Facets near p that do not use it have planes that pass p within `tolerance`. [T-OUTLIER-2]
  bool surface_passes(std::uint32_t p, std::span<const std::uint32_t> patch, double tolerance) const {
    // A suspect does not speak for another, unless there are so many that the surface itself is strange here.
    const auto suspects = std::count_if(patch.begin() + 1, patch.end(), [&](std::uint32_t q) { return verdict_[q] == Verdict::open; });
    const bool few = round_ > 0 && suspects <= rule_.suspects;
    std::array<std::uint32_t, 3> passing{};
    std::size_t count = 0;
    const auto is_enough = [&](std::uint32_t f) {
      const Facet& facet = soup_.facets[f];
      const auto speaks = [&](std::uint32_t corner) {
        return corner != p && verdict_[corner] != Verdict::outlier && !(few && verdict_[corner] == Verdict::open);
      };
      if (!speaks(facet[0]) || !speaks(facet[1]) || !speaks(facet[2])) return false;
      const Vec3 normal = facet_normal_2a(soup_, f);
      if (std::abs(dot(points_[p] - soup_.corner(f, 0), normal)) > tolerance * norm(normal)) return false;
      if (std::find(passing.begin(), passing.begin() + static_cast<std::ptrdiff_t>(count), f) != passing.begin() + static_cast<std::ptrdiff_t>(count)) return false;
      passing[count++] = f;
      return count == rule_.passing;
    };
    return std::any_of(patch.begin() + 1, patch.end(), [&](std::uint32_t q) { return for_some(fans_.around(q), is_enough); });
  }

  // On the fit, below the point; below its neighbours' mean where the point is so far off that a slight tilt would carry it beyond them.
  Vec3 fitted(const PatchSystem& system, const RobustFit& fit, std::uint32_t p) const {
    const auto neighbors = graph_.neighbors(p);
    if (!(std::abs(fit.height) > edge_around(p))) return points_[p] - system.normal(fit.coefficients) * fit.height;
    Vec3 mean;
    for (const std::uint32_t q : neighbors) mean += points_[q] - points_[p];
    mean = mean / (static_cast<double>(neighbors.size()) * system.size);
    const double x = dot(mean, system.u), y = dot(mean, system.v);
    const QuadricRow& c = fit.coefficients;
    const double z = c[0] + c[1] * x + c[2] * y + c[3] * x * x + c[4] * x * y + c[5] * y * y;
    return points_[p] + (system.u * x + system.v * y + system.n * z) * system.size;
  }

  const TriangleSoup& soup_;
  const std::vector<Vec3>& points_;
  const PointGraph& graph_;
  Fans fans_;
  Rule rule_;
  double sigma_;
  std::vector<Verdict> verdict_;
  int round_ = 0;
};

}  // namespace

std::vector<Outlier> search_outliers(const TriangleSoup& soup, const PointGraph& graph, const NoiseEstimate& noise) {
  return Search(soup, graph, noise).run();
}

std::vector<Outlier> find_outliers(const TriangleSoup& oriented, const NoiseEstimate& noise) {
  return search_outliers(oriented, point_graph(oriented, EdgeTable(oriented)), noise);
}

void clamp_outliers(const std::vector<Outlier>& outliers, TriangleSoup& soup) {
  for (const Outlier& o : outliers) soup.points[o.point] = o.fitted;
}

}  // namespace burnish
