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

constexpr std::size_t kSamples = 60'000;
constexpr std::uint32_t kTighter = 4;       // each round divides the clusters that went wrong by this
constexpr std::uint32_t kNoLimit = std::numeric_limits<std::uint32_t>::max();

void require_sense(const SimplifyOptions& options) {
  if (options.deviation && !(*options.deviation >= 0)) throw Error(ErrorCode::usage, "the deviation to simplify within is negative or no number");
}

class Simplifier {
 public:
  Simplifier(const TriangleSoup& given, const SimplifyOptions& options, Progress& progress)
      : given_(given), options_(options), progress_(progress), start_(given, options), given_index_(given), limit_(given.points.size(), kNoLimit) {
    samples_.area_samples = options.deviation ? std::max(kSamples, given.facets.size()) : kSamples;
    samples_.vertex_samples = options.deviation ? given.points.size() : kSamples;
    if (options.deviation) samples_.far_beyond = *options.deviation;
  }

  SimplifiedSurface run() {
    for (int round = 1; round <= kSimplifyRounds; ++round)
      if (attempt(round)) return std::move(result_);
    return unchanged();
  }

 private:
  // Whether the result is valid.
  bool attempt(int round) {
    std::optional<DeviationEnvelope> envelope;
    if (options_.deviation) envelope.emplace(given_, given_index_, *options_.deviation);
    EdgeCollapser collapser(start_, options_, limit_, envelope ? &*envelope : nullptr, progress_);
    collapser.run();
    result_ = {};
    result_.soup = collapser.mesh().soup(from_);
    wrong_.clear();
    find_invalid();
    if (wrong_.empty()) compare();
    if (!wrong_.empty()) {
      hold_back(collapser, round);
      return false;
    }
    result_.rounds = round;
    result_.collapsed = collapser.collapsed();
    result_.held_points = static_cast<std::size_t>(std::count_if(limit_.begin(), limit_.end(), [](std::uint32_t l) { return l != kNoLimit; }));
    result_.reached = !options_.facets || result_.soup.facets.size() <= *options_.facets + 1;
    if (!result_.reached) result_.why_not = collapser.what_stopped_it();
    return true;
  }

  // Facets of the result that intersect or have no area: the points of the mesh at them.
  void find_invalid() {
    const Inspection found = inspect(result_.soup, {.elements = true}, progress_);
    for (const auto& pair : found.self_intersections)
      for (const std::uint32_t f : pair) blame_facet(f);
    for (const std::uint32_t f : found.elements.degenerate_facets) blame_facet(f);
  }

  void compare() {
    std::vector<FarSample> far_from_result, far_from_given;
    const bool listed = options_.deviation.has_value();
    result_.deviation.input_to_output = one_sided_distance(given_, TriangleIndex(result_.soup), samples_, listed ? &far_from_result : nullptr);
    result_.deviation.output_to_input = one_sided_distance(result_.soup, given_index_, samples_, listed ? &far_from_given : nullptr);
    result_.verified_samples = listed ? std::min(result_.deviation.input_to_output.samples, result_.deviation.output_to_input.samples) : 0;
    for (const FarSample& s : far_from_given) blame_facet(s.facet);
    for (const FarSample& s : far_from_result)
      for (const std::uint32_t p : given_.facets[s.facet]) wrong_given_.push_back(p);
    wrong_.insert(wrong_.end(), wrong_given_.begin(), wrong_given_.end());
    wrong_given_.clear();
  }

  void blame_facet(std::uint32_t f) {
    for (const std::uint32_t p : result_.soup.facets[f]) wrong_.push_back(from_[p]);
  }

  // All points that merged into those of wrong facets may merge less: down to not at all, then around them as well.
  void hold_back(const EdgeCollapser& collapser, int round) {
    std::vector<std::uint32_t> allowed(given_.points.size(), kNoLimit);
    for (const std::uint32_t p : wrong_) {
      const std::uint32_t v = collapser.merged(p);
      allowed[v] = std::max(1u, collapser.cluster_size(v) / kTighter);
    }
    for (std::uint32_t p = 0; p < limit_.size(); ++p) limit_[p] = std::min(limit_[p], allowed[collapser.merged(p)]);
    if (round > kSimplifyRounds / 2) spread();
  }

  void spread() {
    std::vector<std::uint32_t> wider = limit_;
    for (const Facet& f : given_.facets) {
      const std::uint32_t least = std::min({limit_[f[0]], limit_[f[1]], limit_[f[2]]});
      for (const std::uint32_t p : f) wider[p] = std::min(wider[p], least);
    }
    limit_ = std::move(wider);
  }

  SimplifiedSurface unchanged() const {
    SimplifiedSurface same;
    same.soup = {given_.points, given_.facets, {}};
    same.reached = !options_.facets || given_.facets.size() <= *options_.facets;
    same.why_not = "no valid surface with fewer facets was found";
    same.held_points = given_.points.size();
    return same;
  }

  const TriangleSoup& given_;
  const SimplifyOptions& options_;
  Progress& progress_;
  CollapseStart start_;
  TriangleIndex given_index_;
  std::vector<std::uint32_t> limit_;  // of points of the given surface: how many may merge where they do
  CompareOptions samples_;
  SimplifiedSurface result_;
  std::vector<std::uint32_t> from_;
  std::vector<std::uint32_t> wrong_, wrong_given_;  // points of the given surface, with repetitions
};

}  // namespace

SimplifiedSurface simplify(const TriangleSoup& manifold, const SimplifyOptions& options, Progress& progress) {
  require_sense(options);
  progress.begin_stage("simplifying");
  return Simplifier(manifold, options, progress).run();
}

}  // namespace burnish
