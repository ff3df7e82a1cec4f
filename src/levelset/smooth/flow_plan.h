// How a flow's time is split into steps.
#pragma once

#include "burnish/levelset/smooth/smoothing.h"

namespace burnish::detail {

struct FlowPlan {
  int steps = 0;
  double step = 0;    // time of each, in cells squared
  double filter = 0;  // time of the diffusion that averages along the surface, of `filtered`
};

// Steps as long as a band of kFlowBand cells allows, at least so many.
FlowPlan flow_plan(FlowMode mode, double length, int least_steps);

}  // namespace burnish::detail
