#include "flow_plan.h"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace burnish {
namespace detail {
namespace {

constexpr double kLongestStep = 2;       // cells squared, of a diffusion
constexpr double kLongestKernel = 8;     // of 2 t in 2 G_t - G_2t, which moves less
constexpr double kFiltered = 0.9;        // of a wave that the average does not follow
constexpr int kMostSteps = 100'000;

// (X / 2 pi)^2, by which the logarithm of an attenuation becomes a time.
double per_decay(double length) { return length * length / (4 * std::numbers::pi * std::numbers::pi); }

// The time of each of `steps` applications of 2 G_t - G_2t that leave a tenth of the wave together. [T-SMOOTH-6]
double volume_step(double length, int steps) {
  return -std::log(1 - std::sqrt(1 - std::pow(0.1, 1.0 / steps))) * per_decay(length);
}

}  // namespace

FlowPlan flow_plan(FlowMode mode, double length, int least_steps) {
  FlowPlan plan;
  if (!(length > 0)) return plan;
  if (mode == FlowMode::volume) {
    plan.steps = least_steps;
    while (plan.steps < kMostSteps && 2 * volume_step(length, plan.steps) > kLongestKernel) ++plan.steps;
    plan.step = volume_step(length, plan.steps);
    return plan;
  }
  const double time = flow_time_for(mode, length);
  plan.steps = std::max(least_steps, static_cast<int>(std::ceil(time / kLongestStep - 1e-9)));
  plan.step = time / plan.steps;
  plan.filter = std::numbers::ln10 * per_decay(length);
  return plan;
}

}  // namespace detail

double flow_time_for(FlowMode mode, double length) {
  if (mode == FlowMode::volume) return detail::volume_step(length, 1);  // [T-SMOOTH-6]
  const double time = std::numbers::ln10 * detail::per_decay(length);   // [T-FLOW-4]
  return mode == FlowMode::filtered ? time / detail::kFiltered : time;  // [T-SMOOTH-7]
}

double room_for_smoothing(FlowMode, double length) { return 2 * std::sqrt(flow_time_for(FlowMode::mcf, length)); }  // [T-FLOW-7]

}  // namespace burnish
