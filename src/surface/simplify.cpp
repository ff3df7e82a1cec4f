#include "burnish/surface/simplify.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "burnish/core/error.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "edge_collapser.h"

namespace burnish {
namespace {

constexpr std::size_t kFewestSamples = 10'000, kMostSamples = 60'000;  // one a facet between, without a deviation to verify
constexpr std::uint32_t kTighter = 4;       // each round divides the clusters that went wrong by this
constexpr float kCloser = 0.7F;             // and multiplies the share of the deviation by this where it was left

constexpr float kLeastShare = 0.4F;         // of the deviation; below that clusters get smaller as well

void require_sense(const SimplifyOptions& options) {
  if (options.deviation && !(*options.deviation >= 0)) throw Error(ErrorCode::usage, "the deviation to simplify within is negative or no number", "leave it out, or give 0 or more, in the model's units");
}

class Simplifier {
 public:
  Simplifier(const TriangleSoup& given, const SimplifyOptions& options, Progress& progress)
      : given_(given), options_(options), progress_(progress), start_(given, options, options.crease_angle), given_index_(given), restraints_(given.points.size()) {
    samples_.area_samples = std::max(options.deviation ? kMostSamples : kFewestSamples, given.facets.size());
    samples_.vertex_samples = given.points.size();
    if (options.deviation) {
      samples_.far_beyond = *options.deviation;
      return;
    }
    samples_.area_samples = std::min(samples_.area_samples, kMostSamples);
    samples_.vertex_samples = std::min(samples_.vertex_samples, kMostSamples);
  }

  // Creases give way only where they are what keeps the count from being reached, and only if that leaves fewer facets. [T-SIMP-6]
  SimplifiedSurface run() {
    std::optional<SimplifiedSurface> best;
    while (attempt_rounds()) {
      if (!best || result_.reached || result_.soup.facets.size() < best->soup.facets.size()) best = std::move(result_);
      if (best->reached || start_.crease_angle >= 180 || !creases_stopped_it_) break;
      start_over_with_fewer_creases();
    }
    return best ? std::move(*best) : unchanged();
  }

 private:
  void start_over_with_fewer_creases() {
    start_ = CollapseStart(given_, options_, CollapseStart::raised(start_.crease_angle));
    restraints_.assign(restraints_.size(), {});
  }

  bool attempt_rounds() {
    for (int round = 1; round <= kSimplifyRounds; ++round)
      if (attempt(round)) return true;
    return false;
  }

  // Whether the result is valid; it need not have as few facets as asked for.
  bool attempt(int round) {
    std::optional<DeviationEnvelope> envelope;
    if (options_.deviation) envelope.emplace(given_, given_index_, *options_.deviation);
    EdgeCollapser collapser(start_, options_, restraints_, envelope ? &*envelope : nullptr, progress_);
    collapser.run();
    result_ = {};
    result_.soup = collapser.mesh().soup(from_);
    const Points invalid = find_invalid(), far = invalid.empty() ? compare() : Points{};
    if (!invalid.empty() || !far.empty()) {
      restrain(collapser, invalid, far);
      if (round > kSimplifyRounds / 2) spread();
      return false;
    }
    result_.rounds = round;
    result_.crease_angle = start_.crease_angle;
    result_.collapsed = collapser.collapsed();
    result_.held_points = static_cast<std::size_t>(std::count_if(restraints_.begin(), restraints_.end(), [](const Restraint& r) { return r.held(); }));
    result_.reached = !options_.facets || result_.soup.facets.size() <= *options_.facets + 1;
    if (result_.reached) return true;
    result_.why_not = collapser.what_stopped_it();
    creases_stopped_it_ = collapser.creases_stopped_it();
    return true;
  }

  using Points = std::vector<std::uint32_t>;  // of the given surface, with repetitions

  // Those at facets of the result that intersect or have no area.
  Points find_invalid() {
    const Inspection found = inspect(result_.soup, {.elements = true}, progress_);
    Points invalid;
    for (const auto& pair : found.self_intersections)
      for (const std::uint32_t f : pair) add_corners(f, invalid);
    for (const std::uint32_t f : found.elements.degenerate_facets) add_corners(f, invalid);
    return invalid;
  }

  // Those at which the result is too far.
  Points compare() {
    std::vector<FarSample> far_from_result, far_from_given;
    const bool listed = options_.deviation.has_value();
    result_.deviation.input_to_output = one_sided_distance(given_, TriangleIndex(result_.soup), samples_, listed ? &far_from_result : nullptr);
    result_.deviation.output_to_input = one_sided_distance(result_.soup, given_index_, samples_, listed ? &far_from_given : nullptr);
    result_.verified_samples = listed ? std::min(result_.deviation.input_to_output.samples, result_.deviation.output_to_input.samples) : 0;
    Points far;
    for (const FarSample& s : far_from_given) add_corners(s.facet, far);
    for (const FarSample& s : far_from_result) far.insert(far.end(), given_.facets[s.facet].begin(), given_.facets[s.facet].end());
    return far;
  }

  void add_corners(std::uint32_t f, Points& points) const {
    for (const std::uint32_t p : result_.soup.facets[f]) points.push_back(from_[p]);
  }

  // All points that merged into those of wrong facets may merge less, down to not at all, or keep closer to the given surface. [T-SIMP-5]
  void restrain(const EdgeCollapser& collapser, const Points& invalid, const Points& far) {
    std::vector<Restraint> of_merged(restraints_.size(), Restraint{.deviation = 1});
    for (const std::uint32_t p : invalid) {
      const std::uint32_t v = collapser.merged(p);
      of_merged[v].most = std::max(1u, collapser.cluster_size(v) / kTighter);
    }
    for (const std::uint32_t p : far) of_merged[collapser.merged(p)].deviation = kCloser;
    for (std::uint32_t p = 0; p < restraints_.size(); ++p) {
      const Restraint& more = of_merged[collapser.merged(p)];
      restraints_[p].most = std::min(restraints_[p].most, more.most);
      restraints_[p].deviation *= more.deviation;
      if (restraints_[p].deviation < kLeastShare) restraints_[p].most = std::min(restraints_[p].most, collapser.cluster_size(collapser.merged(p)) / kTighter + 1);
    }
  }

  void spread() {
    std::vector<Restraint> wider = restraints_;
    for (const Facet& f : given_.facets)
      for (const std::uint32_t p : f)
        for (const std::uint32_t q : f) wider[p].join(restraints_[q]);
    restraints_ = std::move(wider);
  }

  SimplifiedSurface unchanged() const {
    SimplifiedSurface same;
    same.soup = {given_.points, given_.facets, {}};
    same.reached = !options_.facets || given_.facets.size() <= *options_.facets;
    same.why_not = "no valid surface with fewer facets was found";
    same.crease_angle = options_.crease_angle;
    same.held_points = given_.points.size();
    return same;
  }

  const TriangleSoup& given_;
  const SimplifyOptions& options_;
  Progress& progress_;
  CollapseStart start_;
  TriangleIndex given_index_;
  std::vector<Restraint> restraints_;  // of points of the given surface
  CompareOptions samples_;
  SimplifiedSurface result_;
  bool creases_stopped_it_ = false;    // short of the count that was asked for
  std::vector<std::uint32_t> from_;    // the given point behind each point of the result
};

}  // namespace

SimplifiedSurface simplify(const TriangleSoup& manifold, const SimplifyOptions& options, Progress& progress) {
  require_sense(options);
  progress.begin_stage("simplifying");
  return Simplifier(manifold, options, progress).run();
}

}  // namespace burnish
