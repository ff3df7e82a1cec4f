#include "burnish/levelset/smooth/smoothing.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"
#include "burnish/levelset/smooth/mean_curvature_flow.h"
#include "burnish/levelset/volume.h"

namespace burnish {
namespace {

constexpr double kVolumeTolerance = 1e-6;

void clamp_to(const Field<float>& reference, double deviation, Field<float>& phi) {
  const auto t = static_cast<float>(deviation);
  parallel_for(phi.values().size(), [&](std::size_t i) {
    phi.values()[i] = std::clamp(phi.values()[i], reference.values()[i] - t, reference.values()[i] + t);  // [T-FLOW-5]
  }, 16384);
}

void shift(Field<float>& phi, double by) {
  const auto s = static_cast<float>(by);
  parallel_for(phi.values().size(), [&](std::size_t i) { phi.values()[i] += s; }, 16384);
}

// A piece of the whole flow's time: may be interrupted.
class Piece : public Progress {
 public:
  explicit Piece(const Progress& whole) : whole_(whole) {}
  bool cancelled() const override { return whole_.cancelled(); }

 private:
  const Progress& whole_;
};

}  // namespace

std::string_view name(FlowMode mode) {
  switch (mode) {
    case FlowMode::mcf: return "mcf";
    case FlowMode::volume: return "volume";
    case FlowMode::filtered: return "filtered";
    case FlowMode::reinit: return "reinit";
  }
  return "";
}

double flow_time_for(FlowMode, double length) {
  return std::numbers::ln10 * length * length / (4 * std::numbers::pi * std::numbers::pi);  // [T-FLOW-4]
}

double room_for_smoothing(FlowMode mode, double length) { return 2 * std::sqrt(flow_time_for(mode, length)); }  // [T-FLOW-7]

SmoothingResult smooth(LevelSet& level_set, const SmoothingOptions& options, Progress& progress) {
  SmoothingResult result;
  result.volume_before = enclosed_volume(level_set);
  Field<float> reference;
  if (options.deviation) reference = level_set.phi;
  const auto constrain = [&] {
    if (options.deviation) clamp_to(reference, *options.deviation, level_set.phi);
  };
  const double time = flow_time_for(options.mode, options.length);
  const int pieces = static_cast<int>(std::ceil(time));
  Piece piece(progress);
  for (int i = 1; i <= pieces; ++i) {
    const FlowResult flow = mean_curvature_flow(level_set, time / pieces, piece, options.redistance);
    constrain();
    result.steps += flow.steps;
    result.unsteady += flow.unsteady;
    progress.update(static_cast<double>(i) / pieces);
  }
  result.time = time;
  result.volume_after = enclosed_volume(level_set);
  if (!options.keep_volume) return result;

  // Secant method for the shift, from a first step of a twentieth of a cell. [T-FLOW-6]
  const Field<float> flowed = level_set.phi;
  double s0 = 0, v0 = result.volume_after;
  double s1 = v0 < result.volume_before ? 0.05 : -0.05;
  for (int iteration = 0; iteration < 8; ++iteration) {
    if (std::abs(result.volume_after - result.volume_before) <= kVolumeTolerance * std::abs(result.volume_before)) break;
    progress.check();
    level_set.phi = flowed;
    shift(level_set.phi, s1);
    constrain();
    result.volume_after = enclosed_volume(level_set);
    const double slope = (result.volume_after - v0) / (s1 - s0);
    if (!(slope > 0)) break;
    s0 = s1;
    v0 = result.volume_after;
    s1 = std::clamp(s1 + (result.volume_before - v0) / slope, -1.0, 1.0);
    if (s1 == s0) break;
  }
  return result;
}

}  // namespace burnish
