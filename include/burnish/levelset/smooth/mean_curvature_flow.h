// Mean-curvature flow by explicit steps: the reference that smoothing (smoothing.h) is measured against.
#pragma once

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/levelset/redistance.h"
#include "burnish/levelset/smooth/smoothing.h"

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

}  // namespace burnish
