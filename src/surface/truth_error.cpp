#include "burnish/surface/truth_error.h"

#include <cmath>
#include <limits>

#include "burnish/core/parallel.h"
#include "burnish/surface/creases.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 256;

// Sums of samples, in the order of the samples.
struct Sum {
  std::size_t samples = 0, angles = 0;
  double angle = 0, squares = 0;

  void add(const SampleError& e) {
    ++samples;
    squares += e.closest.squared_distance;
    if (std::isnan(e.angle)) return;
    ++angles;
    angle += e.angle;
  }
  // [T-COMP-3]
  ErrorFigures figures() const {
    const auto mean = [](double sum, std::size_t n) { return n ? sum / static_cast<double>(n) : std::numeric_limits<double>::quiet_NaN(); };
    return {samples, mean(angle, angles), std::sqrt(mean(squares, samples))};
  }
};

// One way. `on_truth`: the truth's point of those that a sample compares.
template <class OnTruth>
void sum_up(const std::vector<SampleError>& errors, const CreaseEdges& creases, double near_crease, OnTruth&& on_truth,
            ErrorFigures TwoWayError::*way, TruthError& result) {
  std::vector<char> near(errors.size());
  // [T-COMP-4]
  parallel_for(errors.size(), [&](std::size_t i) { near[i] = creases.within(on_truth(errors[i]), near_crease); }, kGrain);
  Sum all, near_creases, elsewhere;
  for (std::size_t i = 0; i < errors.size(); ++i) {
    all.add(errors[i]);
    (near[i] ? near_creases : elsewhere).add(errors[i]);
  }
  result.all.*way = all.figures();
  result.near_creases.*way = near_creases.figures();
  result.elsewhere.*way = elsewhere.figures();
}

double mean_of_ways(double there, double back, const TwoWayError& e) {
  if (e.there.samples == 0) return back;
  return e.back.samples == 0 ? there : 0.5 * (there + back);
}

}  // namespace

CreaseEdges::CreaseEdges(const TriangleSoup& welded, double degrees) : index_([&] {
  TriangleSoup edges = folded(welded, find_creases(welded, {.angle = degrees}));
  count_ = edges.facets.size();
  for (std::size_t f = 0; f < count_; ++f) length_ += norm(edges.corner(f, 1) - edges.corner(f, 0));
  return edges;
}()) {}

bool CreaseEdges::within(const Vec3& p, double distance) const {
  return count_ > 0 && index_.closest(p, distance * distance).facet != kNoFacet;
}

double TwoWayError::angle() const { return mean_of_ways(there.angle, back.angle, *this); }

double TwoWayError::rms() const { return std::sqrt(mean_of_ways(there.rms * there.rms, back.rms * back.rms, *this)); }

TruthError truth_error(const TriangleSoup& result, const ClosestQuery& ask_result, const TriangleSoup& truth,
                       const ClosestQuery& ask_truth, const CreaseEdges& creases, const TruthErrorOptions& options) {
  TruthError error;
  const auto there = sample_errors(result, truth, ask_truth, options.samples);
  sum_up(there, creases, options.near_crease, [](const SampleError& e) { return e.closest.point; }, &TwoWayError::there, error);
  const auto back = sample_errors(truth, result, ask_result, options.samples);
  sum_up(back, creases, options.near_crease, [](const SampleError& e) { return e.at; }, &TwoWayError::back, error);
  return error;
}

FacetErrors facet_errors(const TriangleSoup& result, const TriangleSoup& truth, const ClosestQuery& ask_truth) {
  FacetErrors errors{std::vector<double>(result.facets.size()), std::vector<double>(result.facets.size())};
  parallel_for(result.facets.size(), [&](std::size_t f) {
    const SampleError e = error_at_centroid(result, f, truth, ask_truth);
    errors.angle[f] = e.angle;
    errors.distance[f] = std::sqrt(e.closest.squared_distance);
  }, kGrain);
  return errors;
}

}  // namespace burnish
