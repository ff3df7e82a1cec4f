#include "smoothing_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "burnish/surface/noise.h"
#include "burnish/surface/outliers.h"
#include "local_gear.h"

namespace burnish {
namespace {

constexpr double kEdgesPerWave = 4, kSigmasPerWave = 8;  // the shortest wave that is no noise
constexpr double kExplained = 0.95;                      // of sigma: the rms displacement at which smoothing ends

// What lengths are to be compared with.
double diagonal_of(const RepairReport& report) { return report.before.box.diagonal(); }

struct Choice {
  SmoothMode mode;
  std::string_view reason;
};

// What a user who names no mode would want. [T-AUTO-2]
Choice chosen_mode(const CleanOptions& asked, const NoiseEstimate& noise) {
  if (asked.mode != SmoothMode::automatic) return {asked.mode, "asked for"};
  if (asked.curvature_radius) return {SmoothMode::mcf, "a radius of curvature was given"};
  if (asked.method == Method::local) return {SmoothMode::feature, "local repair was asked for"};
  if (asked.smooths_in_cells()) return {SmoothMode::volume, "lengths in cells were given"};
  if (asked.smooth_auto && !noise.noisy()) return {SmoothMode::feature, "there is no noise, but points far off the surface"};
  if (noise.creased() && !noise.rough_otherwise()) return {SmoothMode::feature, "creases stand out of the noise"};
  if (!reason_against_local(asked, false).empty()) return {SmoothMode::volume, "a level set was asked for"};
  if (noise.noisy()) return {SmoothMode::feature, "the noise is random from point to point"};
  return {SmoothMode::volume, "the surface is not rough at random from point to point"};
}

void warn_of_idle_options(const CleanOptions& asked, const SmoothingPlan& plan, std::vector<std::string>& warnings) {
  const auto warn = [&](bool given, std::string_view option) {
    if (given) warnings.push_back(fmt::format("{} has no effect in mode {}", option, name(plan.mode)));
  };
  warn(plan.denoises() && !asked.keep_volume, "--free-volume");
  warn(plan.denoises() && asked.curvature_radius, "--curvature-radius");
  warn(plan.denoises() && asked.redistance != RedistanceMethod::closest, "--redistance");
  warn(plan.flows() && asked.crease_angle, "--crease");
}

}  // namespace

SmoothingPlan plan_smoothing(const CleanOptions& asked, const NoiseEstimate& noise, std::shared_ptr<const Region> region, const PreparedInput& prepared, RepairReport& report) {
  SmoothingPlan plan;
  report.smoothing.noise = noise;
  // The denoiser gives outliers within noise little weight itself.
  plan.clamps_outliers = asked.smooth_auto && !noise.noisy() && !find_outliers(prepared.oriented, noise).empty();
  if (asked.smooth_auto && !noise.noisy() && !plan.clamps_outliers) {
    report.smoothing.mode_reason = "there is no noise to remove";
    return plan;
  }
  const Choice choice = chosen_mode(asked, noise);
  plan.mode = report.smoothing.mode = report.options.mode = choice.mode;
  report.smoothing.mode_reason = choice.reason;
  plan.region = std::move(region);
  warn_of_idle_options(asked, plan, report.warnings);
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
