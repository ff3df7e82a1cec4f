#include "smoothing_plan.h"

#include <fmt/format.h>

#include <algorithm>

#include "burnish/surface/noise.h"

namespace burnish {
namespace {

constexpr double kEdgesPerWave = 4, kSigmasPerWave = 8;  // the shortest wave that is no noise
constexpr double kExplained = 0.95;                      // of sigma: the rms displacement at which smoothing ends

// What lengths are to be compared with.
double diagonal_of(const RepairReport& report) { return report.before.box.diagonal(); }

// What a user who names no mode would want. [T-AUTO-2]
SmoothMode chosen_mode(const CleanOptions& asked, const NoiseEstimate& noise, std::string& reason) {
  if (asked.mode != SmoothMode::automatic) {
    reason = "asked for";
    return asked.mode;
  }
  if (asked.curvature_radius) {
    reason = "a radius of curvature was given";
    return SmoothMode::mcf;
  }
  if (noise.creased()) {
    reason = "creases stand out of the noise";
    return SmoothMode::feature;
  }
  if (noise.noisy()) {
    reason = "the noise is random from point to point";
    return SmoothMode::feature;
  }
  reason = "there are few creases, and no noise that is random from point to point";
  return SmoothMode::volume;
}

}  // namespace

SmoothingPlan plan_smoothing(const CleanOptions& asked, const PreparedInput& prepared, RepairReport& report) {
  SmoothingPlan plan;
  if (!asked.smooths()) return plan;
  const NoiseEstimate noise = estimate_noise(prepared.oriented);
  report.smoothing.noise = noise;
  if (asked.smooth_auto && !noise.noisy()) {
    report.smoothing.mode_reason = "there is no noise to remove";
    return plan;
  }
  plan.mode = report.smoothing.mode = report.options.mode = chosen_mode(asked, noise, report.smoothing.mode_reason);
  if (!asked.region.empty()) plan.region = std::make_shared<Region>(asked.region, report.recentred_by);
  if (!asked.smooth_auto) {
    plan.length = asked.smooth.in_model_units(diagonal_of(report), 0);  // in cells: not known yet
  } else if (plan.flows()) {
    plan.length = std::max(kEdgesPerWave * noise.mean_edge, kSigmasPerWave * noise.sigma);  // [T-AUTO-1]
    plan.stop_at = kExplained * noise.sigma;
  }
  report.options.smooth = plan.length;
  return plan;
}

CleanOptions with_plan(const CleanOptions& asked, const SmoothingPlan& plan) {
  CleanOptions options = asked;
  if (!plan.flows())
    options.smooth = {};
  else if (asked.smooth_auto)
    options.smooth = {plan.length, LengthUnit::model};
  return options;
}

}  // namespace burnish
