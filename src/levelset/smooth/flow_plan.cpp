#include "flow_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burnish {
namespace detail {
namespace {

constexpr double kLeft = 0.1;               // of a wave of the length
constexpr double kLongestStep = 4;          // cells squared: in one step corners recede by up to 3 cells, and distances are known to 5
constexpr double kLongestVolumeStep = 8;    // of t in 2 G_t - G_2t, which moves less
constexpr double kDiffusionOfAStep = 0.011;  // cells squared, of first-order redistancing. [T-SMOOTH-11]
constexpr int kMostSteps = 100'000;

// The time, by (length / 2 pi)^2, of each of `steps` steps that leave a tenth of the wave together.
double decay_of_step(FlowMode mode, int steps) {
  const double taken = 1 - std::pow(kLeft, 1.0 / steps);  // of the wave, by a step
  switch (mode) {
    case FlowMode::volume: return -std::log(1 - std::sqrt(taken));              // [T-SMOOTH-6]
    case FlowMode::filtered: return -std::log(1 - taken / (1 - kLeft));         // [T-SMOOTH-7]
    case FlowMode::mcf:
    case FlowMode::reinit: break;
  }
  return -std::log(kLeft) / steps;
}

double longest_step(FlowMode mode) {
  return mode == FlowMode::reinit ? kDiffusionOfAStep : mode == FlowMode::volume ? kLongestVolumeStep : kLongestStep;
}

}  // namespace

FlowPlan flow_plan(FlowMode mode, double length, int least_steps) {
  FlowPlan plan;
  if (!(length > 0)) return plan;
  const double per_decay = length * length / (4 * std::numbers::pi * std::numbers::pi);
  plan.steps = least_steps;
  while (plan.steps < kMostSteps && !(decay_of_step(mode, plan.steps) * per_decay <= longest_step(mode))) ++plan.steps;
  plan.step = decay_of_step(mode, plan.steps) * per_decay;
  plan.filter = -std::log(kLeft) * per_decay;
  return plan;
}

}  // namespace detail

double flow_time_for(FlowMode mode, double length) {
  const double per_decay = length * length / (4 * std::numbers::pi * std::numbers::pi);
  if (mode == FlowMode::volume) return detail::decay_of_step(mode, 1) * per_decay;
  const double time = -std::log(detail::kLeft) * per_decay;                    // [T-FLOW-4]
  return mode == FlowMode::filtered ? time / (1 - detail::kLeft) : time;
}

// No mode moves a surface faster than mean-curvature flow does.
double room_for_smoothing(FlowMode, double length) { return 2 * std::sqrt(flow_time_for(FlowMode::mcf, length)); }  // [T-FLOW-7]

}  // namespace burnish
