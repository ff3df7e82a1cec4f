#include "denoised.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/surface/denoise.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/local_repair.h"
#include "burnish/surface/outliers.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {
namespace {

constexpr double kRampInEdges = 2;       // mean edges inside a region's border, from where on points move freely
constexpr double kVolumeOfFolds = 0.02;  // of the volume: what mending folds may change

DenoiseOptions denoise_options(const SmoothingPlan& plan, const TriangleSoup& soup, const RepairReport& report) {
  DenoiseOptions options;
  options.noise = report.smoothing.noise;
  if (plan.length > 0) options.length = plan.length;
  options.crease_angle = report.options.crease_angle;
  options.deviation = report.options.deviation;
  if (plan.region) options.mobility = mobility_at(soup.points, *plan.region, kRampInEdges * report.smoothing.noise.mean_edge);
  return options;
}

// Within the region and the bound on the deviation, if there are any.
TriangleSoup without_outliers(const TriangleSoup& soup, const SmoothingPlan& plan, RepairReport& report) {
  TriangleSoup result = soup;
  std::vector<Outlier> outliers = find_outliers(soup, report.smoothing.noise);
  std::erase_if(outliers, [&](const Outlier& o) {
    return o.distance > report.options.deviation.value_or(HUGE_VAL) || (plan.region && plan.region->mobility(o.position, 0) <= 0);
  });
  clamp_outliers(outliers, result);
  report.smoothing.outliers = outliers.size();
  for (const Outlier& o : outliers) report.smoothing.max_moved = std::max(report.smoothing.max_moved, o.distance);
  return result;
}

// Denoised, with points as the file will have them.
TriangleSoup denoised(const TriangleSoup& soup, const SmoothingPlan& plan, bool float32, RepairReport& report, Progress& progress) {
  report.smoothing.outliers = 0;
  report.smoothing.max_moved = 0;
  DenoiseResult done;
  done.soup = plan.clamps_outliers ? without_outliers(soup, plan, report) : soup;
  if (plan.denoises() && (plan.length > 0 || report.smoothing.noise.noisy())) {
    done = denoise(done.soup, denoise_options(plan, soup, report), progress);
    report.smoothing.outliers += done.outliers;
    report.smoothing.length = plan.length;
    report.smoothing.rms_moved = done.rms_moved;
    report.smoothing.max_moved = std::max(report.smoothing.max_moved, done.max_moved);
  }
  if (float32)
    parallel_for(done.soup.points.size(), [&](std::size_t i) {
      Vec3& p = done.soup.points[i];
      if (p != soup.points[i]) p = {static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    });
  return std::move(done.soup);
}

// Facets of the result that are the input's: with the same points, or moved.
void count_moved(const LocalSolution& solution, const TriangleSoup& welded, RepairActions& actions) {
  actions.facets_kept = actions.facets_moved = 0;
  for (std::size_t f = 0; f < solution.source.size(); ++f) {
    if (solution.source[f] == kNoFacet) continue;
    ++(has_same_points(solution.soup, f, welded, solution.source[f]) ? actions.facets_kept : actions.facets_moved);
  }
}

bool has_open_edges(const TriangleSoup& soup) {
  const EdgeTable edges(soup);
  for (std::size_t e = 0; e < edges.size(); ++e)
    if (edges.is_open(e)) return true;
  return false;
}

bool needs_mending(const TriangleSoup& soup, Progress& progress) {
  const Inspection found = inspect(soup, {}, progress);
  return !found.defects.valid_solid() && !found.defects.valid_sheet();
}

// Mends what intersects; `solution.source` follows.
bool mend_folds(LocalSolution& solution, bool float32, RepairReport& report, Progress& progress, std::string& refusal) {
  LocalRepairResult mended = repair_locally(solution.soup, {.max_hole = report.options.max_hole, .float32 = float32}, progress);
  refusal = mended.refusal;
  if (!refusal.empty()) return false;
  std::vector<std::uint32_t> source(mended.source.size(), kNoFacet);
  std::vector<char> fills(mended.source.size());
  for (std::size_t f = 0; f < source.size(); ++f) {
    const std::uint32_t was = mended.source[f];
    if (was != kNoFacet) source[f] = solution.source[was];
    fills[f] = was != kNoFacet ? solution.fills_hole[was] : mended.fills_hole[f];
  }
  report.actions.facets_cut += mended.facets_cut;
  report.actions.needles_flipped += mended.needles_flipped;
  report.actions.intersecting_pairs_removed += mended.intersecting_pairs_removed;
  solution = {std::move(mended.soup), std::move(source), std::move(fills), mended.facets_cut > 0};
  return true;
}

}  // namespace

std::optional<DenoisedSolution> solve_denoised(const TriangleSoup& welded, const PreparedInput& prepared, const SmoothingPlan& plan, bool valid, bool float32,
                                               double tolerance, RepairReport& report, Progress& progress, std::string& refusal) {
  std::optional<LocalSolution> closed = valid ? unchanged(welded) : solve_locally(welded, prepared, {.max_hole = {}, .float32 = float32, .resolve_intersections = false}, report, progress, refusal);
  if (!closed) return std::nullopt;
  report.after.volume = signed_volume(closed->soup);
  report.is_sheet = report.options.max_hole && has_open_edges(closed->soup);
  refusal = objection_to(*closed, closed->soup, welded, prepared, tolerance, report);
  if (!refusal.empty()) return std::nullopt;
  DenoisedSolution result;
  result.surface.before = closed->soup;
  result.surface.after = closed->soup = denoised(closed->soup, plan, float32, report, progress);
  if (needs_mending(closed->soup, progress) && !mend_folds(*closed, float32, report, progress, refusal)) return std::nullopt;
  count_moved(*closed, welded, report.actions);
  result.solution = std::move(*closed);
  return result;
}

std::string objection_to_mending(const DenoisedSolution& denoised, const TriangleSoup& result, double tolerance, const RepairReport& report) {
  const TriangleSoup& wanted = denoised.surface.after;
  if (denoised.solution.united) return is_same_solid(wanted, result, 0) ? "" : "it would not be the solid that the denoised facets enclose";
  const double volume = signed_volume(wanted);
  if (!report.is_sheet && !(std::abs(report.after.volume - volume) <= kVolumeOfFolds * std::abs(volume)))
    return fmt::format("its volume of {:.6g} would not be the {:.6g} that the denoised facets enclose", report.after.volume, volume);
  const double off = one_sided_distance(wanted, TriangleIndex(result)).max;
  if (off > tolerance) return fmt::format("{:.3g} away from the result something of the denoised surface would be lost", off);
  return {};
}

void denoise_prepared(PreparedInput& prepared, const SmoothingPlan& plan, RepairReport& report, Progress& progress) {
  const TriangleSoup moved = denoised(prepared.oriented, plan, false, report, progress);
  // Caps share the points of the loops that they fill.
  std::copy(moved.points.begin(), moved.points.end(), prepared.capped.soup.points.begin());
  prepared.oriented.points = moved.points;
}

}  // namespace burnish
