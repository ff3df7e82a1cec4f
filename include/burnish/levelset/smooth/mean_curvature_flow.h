// Mean-curvature flow of the zero surface, with a physical length, a bound on the deviation, and the volume kept.
#pragma once

#include <optional>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/levelset/redistance.h"

namespace burnish {

// A surface under phi_t = kappa |grad phi|, kappa = div(grad phi / |grad phi|) (the thesis' eq. 4.6 with phi > 0 inside), moves
// along its normal with its mean curvature k1 + k2: a sphere obeys R^2 = R0^2 - 4 t. [T-FLOW-1], [T-FLOW-2]
struct FlowResult {
  double time = 0;  // in cells squared
  int steps = 0;
  int unsteady = 0;  // redistancings by a PDE that ended before they were steady
};

// Runs the flow for `time` (in cells squared): central differences of second order on 19 points, explicit Euler steps of
// at most 1/6 (stable), redistanced every few steps by `method`. The surface can move by 2 sqrt(time) cells at most, the
// radius of a sphere that vanishes in that time; blocks have to be finest that far and kFlowBand beyond.
template <class T>
FlowResult mean_curvature_flow(BasicLevelSet<T>& level_set, double time, Progress& progress = no_progress(),
                               RedistanceMethod method = RedistanceMethod::closest);

struct SmoothingOptions {
  double length = 0;                // wavelengths below this many cells are attenuated tenfold or more
  std::optional<double> deviation;  // |phi - phi0| stays at most this many cells
  bool keep_volume = true;
  RedistanceMethod redistance = RedistanceMethod::closest;
};

struct SmoothingResult {
  FlowResult flow;
  double volume_before = 0;  // of the zero surface, in cells cubed
  double volume_after = 0;
};

// Flow time that attenuates a wave of this length tenfold: a wave's amplitude decays with exp(-(2 pi / X)^2 t), so
// t = ln(10) X^2 / (4 pi^2) = 0.0583 X^2.
double flow_time_for(double length);
// Cells by which a surface may move under that flow: the `room` that its level set needs.
double room_for_smoothing(double length);
// Cells around the surface that the flow keeps a distance function: the `band` that its level set needs.
inline constexpr double kFlowBand = 5;

// Smooths by mean-curvature flow, bounds the deviation after every redistancing, then shifts phi by a constant until the
// enclosed volume is what it was, to 1e-6 of it (secant method on the extracted surface), unless the bound on the deviation
// forbids.
SmoothingResult smooth_by_flow(LevelSet& level_set, const SmoothingOptions& options, Progress& progress = no_progress());

}  // namespace burnish
