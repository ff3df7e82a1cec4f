#include "burnish/levelset/smooth/smoothing.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/levelset/volume.h"
#include "flow_plan.h"
#include "keep_volume.h"
#include "surface_diffusion.h"

namespace burnish {
namespace {

using namespace detail;

constexpr float kLargestCorrection = 0.15f;  // of a step's displacement
constexpr float kStraight = 16;               // 1 / cell^2: more than the sum of squared curvatures that a lattice can show
constexpr float kFarthestMove = 3;            // cells a step
constexpr float kGateWidth = 0.5f;            // of 1 / radius, over which the gate opens
constexpr double kLeastFarthestShift = 2;     // cells
constexpr double kShiftPerMove = 2;           // a mean displacement is never more than its rms; curvature changes the area on the way

// A principal curvature at the closest point of a node, from that of the level set through the node. [T-SMOOTH-8]
float at_foot(float curvature, float phi) { return curvature / std::clamp(1 - phi * curvature, 0.5f, 2.0f); }

// 0 where all radii of curvature are larger than the radius, 1 where one is clearly smaller. [T-SMOOTH-8]
float gate_of(float trace, float square, float phi, float radius) {
  if (!(square < kStraight)) return 0;
  const float mean = 0.5f * trace, apart = std::sqrt(std::max(0.0f, 0.5f * square - mean * mean));
  const float largest = std::abs(at_foot(mean < 0 ? mean - apart : mean + apart, phi)) * radius;
  const float t = std::clamp((largest - 1) / kGateWidth, 0.0f, 1.0f);
  return t * t * (3 - 2 * t);
}

class Smoothing {
 public:
  Smoothing(LevelSet& set, const SmoothingOptions& options, Progress& progress)
      : set_(set), options_(options), progress_(progress), part_(progress), reach_(std::min(set.band, kFlowBand)), start_(set.phi) {
    if (options.mobility != nullptr) find_fixed_nodes();
  }

  SmoothingResult run() {
    result_.volume_before = enclosed_volume(set_);
    progress_.check();
    const FlowPlan plan = flow_plan(options_.mode, options_.length, options_.target_rms ? kStepsToTarget : 1);
    if (options_.mode == FlowMode::reinit)
      redistance_excessively(plan);
    else if (plan.steps > 0)
      flow(plan);
    progress_.check();
    result_.volume_after = enclosed_volume(set_);
    progress_.check();
    if (options_.keep_volume)
      result_.volume_after = shift_to_volume(set_, result_.volume_before, volume_shift(), progress_);
    result_.rms_moved = rms_moved(set_.phi);
    return result_;
  }

 private:
  static constexpr int kStepsToTarget = 4, kStepsAtOnce = 25;

  void flow(const FlowPlan& plan) {
    SurfaceDiffusion diffusion(set_);
    double before = 0;
    for (int step = 1; step <= plan.steps && !result_.reached_target; ++step) {
      progress_.check();
      const Field<float> last = options_.target_rms ? set_.phi : Field<float>();
      displace(diffusion, plan);  // [T-SMOOTH-1]
      redistance_surface();
      constrain();
      double done = 1;
      if (options_.target_rms) done = end_at_target(last, before);
      result_.time += done * plan.step;
      result_.steps = step;
      progress_.update(static_cast<double>(step) / plan.steps);
    }
  }

  // If the surface has moved too far by now, it moves a part of the last step only. Returns that part. [T-SMOOTH-10]
  double end_at_target(const Field<float>& last, double& before) {
    const double now = rms_moved(set_.phi), target = *options_.target_rms;
    if (now < target) {
      before = now;
      return 1;
    }
    result_.reached_target = true;
    const double part = now > before ? std::clamp((target - before) / (now - before), 0.0, 1.0) : 1;
    const auto t = static_cast<float>(part);
    parallel_for(last.values().size(), [&](std::size_t i) { set_.phi.values()[i] = last.values()[i] + t * (set_.phi.values()[i] - last.values()[i]); }, 16384);
    redistance_surface();
    constrain();
    return part;
  }

  // Moves phi by a step of the flow.
  void displace(SurfaceDiffusion& diffusion, const FlowPlan& plan) {
    Field<float> gate;
    if (options_.curvature_radius > 0) gate = curvature_gate(diffusion);
    diffusion.start(set_, reach_, plan.step, part_);
    switch (options_.mode) {
      case FlowMode::mcf: correct(diffusion, plan.step); break;
      case FlowMode::volume: undo_shrinkage(diffusion, plan.step); break;
      case FlowMode::filtered: subtract_average(diffusion, plan.filter); break;
      case FlowMode::reinit: break;
    }
    move(diffusion, gate);
  }

  // The curvature changes while the surface moves. [T-SMOOTH-5]
  void correct(SurfaceDiffusion& diffusion, double time) {
    const float half = static_cast<float>(0.5 * time);
    diffusion.change_by_bends(set_, [half](float w, float, float, float square) {
      if (!(square < kStraight)) return w;
      const float share = half * square, beyond = share * share / (kLargestCorrection * kLargestCorrection);
      return w * (1 + share / (1 + beyond * beyond));
    });
  }

  // 2 G_t - G_2t. [T-SMOOTH-6]
  void undo_shrinkage(SurfaceDiffusion& diffusion, double time) {
    const Field<float> once = diffusion.displacement();
    diffusion.go_on(time, part_);
    diffusion.change([&](std::uint32_t leaf, std::size_t n, float w) { return 2 * once.block(leaf)[n] - w; });
  }

  // [T-SMOOTH-7]
  void subtract_average(SurfaceDiffusion& diffusion, double filter) {
    const Field<float> own = diffusion.displacement();
    diffusion.average(filter, part_);
    diffusion.change([&](std::uint32_t leaf, std::size_t n, float w) { return own.block(leaf)[n] - w; });
  }

  // From phi that has been smoothed by the shortest of passes: facets of a mesh have edges.
  Field<float> curvature_gate(SurfaceDiffusion& diffusion) {
    diffusion.start(set_, reach_, HeatTaps::kLongest, part_);
    const auto radius = static_cast<float>(options_.curvature_radius);
    diffusion.change_by_bends(set_, [radius](float, float phi, float trace, float square) { return gate_of(trace, square, phi, radius); });
    return diffusion.displacement();
  }

  void move(SurfaceDiffusion& diffusion, const Field<float>& gate) {
    diffusion.change([&](std::uint32_t leaf, std::size_t n, float w) {
      w = std::clamp(w, -kFarthestMove, kFarthestMove);
      if (!gate.empty()) w *= gate.block(leaf)[n];
      if (options_.mobility != nullptr) w *= options_.mobility->block(leaf)[n];
      set_.phi.block(leaf)[n] += w;
      return w;
    });
  }

  void redistance_surface() {
    RedistanceOptions options;
    options.method = options_.redistance;
    options.reach = reach_;
    if (!fixed_.empty()) options.accepted = &fixed_;
    result_.unsteady += !redistance(set_, options, part_).steady;
  }

  // [T-SMOOTH-11]
  void redistance_excessively(const FlowPlan& plan) {
    const Field<std::uint8_t> none = Field<std::uint8_t>::like(set_.phi, 0, 0);
    RedistanceOptions options;
    options.method = RedistanceMethod::pde_first;
    options.reach = reach_;
    options.accepted = &none;
    options.steady = 0;
    for (int step = 0; step < plan.steps && !result_.reached_target; step += options.most_steps) {
      progress_.check();
      options.most_steps = std::min(kStepsAtOnce, plan.steps - step);
      redistance(set_, options, part_);
      constrain();
      result_.steps = step + options.most_steps;
      result_.time = result_.steps * plan.step;
      result_.reached_target = options_.target_rms && rms_moved(set_.phi) >= *options_.target_rms;
      progress_.update(static_cast<double>(result_.steps) / plan.steps);
    }
  }

  VolumeShift volume_shift() { return {farthest_shift(), options_.mobility, [&] { redistance_surface(); }, [&] { constrain(); }}; }

  // What makes up for the flow is no farther than what the flow has done, unless a part of the surface has vanished. [T-SMOOTH-9]
  double farthest_shift() const {
    const double half = 0.5 * options_.length, moved = rms_moved(set_.phi);
    const bool is_known = moved < 0.5 * set_.band;  // phi0 ends at the band
    return std::max(kLeastFarthestShift, is_known ? std::min(half, kShiftPerMove * moved) : half);
  }

  void constrain() {
    if (!options_.deviation) return;
    const auto t = static_cast<float>(*options_.deviation);
    parallel_for(start_.values().size(), [&](std::size_t i) {
      set_.phi.values()[i] = std::clamp(set_.phi.values()[i], start_.values()[i] - t, start_.values()[i] + t);  // [T-FLOW-5]
    }, 16384);
  }

  // Nodes beside the surface that may not move keep phi, bit for bit.
  void find_fixed_nodes() {
    fixed_ = Field<std::uint8_t>::like(set_.phi, 0, 0);
    parallel_for(start_.values().size(), [&](std::size_t i) {
      fixed_.values()[i] = options_.mobility->values()[i] == 0 && std::abs(start_.values()[i]) < static_cast<float>(std::numbers::sqrt3);
    }, 16384);
  }

  // Nodes within a cell's half of the surface are beside it, whatever their neighbours are.
  double rms_moved(const Field<float>& phi) const {
    struct Sum {
      double squares = 0, count = 0;
    };
    const Sum sum = parallel_reduce(
        phi.values().size(), 16384, Sum{},
        [&](std::size_t begin, std::size_t end) {
          Sum part;
          for (std::size_t i = begin; i < end; ++i) {
            if (std::abs(phi.values()[i]) > 0.5f) continue;
            const double moved = static_cast<double>(phi.values()[i]) - start_.values()[i];
            part.squares += moved * moved;
            part.count += 1;
          }
          return part;
        },
        [](const Sum& a, const Sum& b) { return Sum{a.squares + b.squares, a.count + b.count}; });
    return sum.count > 0 ? std::sqrt(sum.squares / sum.count) : 0;
  }

  LevelSet& set_;
  const SmoothingOptions& options_;
  Progress& progress_;
  QuietProgress part_;  // of a step, as redistancing is
  const double reach_;
  const Field<float> start_;
  Field<std::uint8_t> fixed_;
  SmoothingResult result_;
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

SmoothingResult smooth(LevelSet& level_set, const SmoothingOptions& options, Progress& progress) {
  return Smoothing(level_set, options, progress).run();
}

}  // namespace burnish
