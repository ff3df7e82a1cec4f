// Smoothing of the zero surface, with a physical length, a bound on the deviation, and the volume kept.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/levelset/redistance.h"

namespace burnish {

enum class FlowMode : std::uint8_t {
  mcf,       // mean-curvature flow, R^2 = R0^2 - 4 t: what is short goes first, and all shrinks
  volume,    // the kernel 2 G_t - G_2t: waves go, and nothing shrinks to first order
  filtered,  // speed (filtered kappa - kappa): a surface of constant curvature rests (Malladi and Sethian; the thesis' 4.2)
  reinit,    // the thesis' excessive reinitialisation: PDE redistancing of first order, which moves the surface
};

std::string_view name(FlowMode mode);  // "mcf", "volume", "filtered", "reinit"

struct SmoothingOptions {
  FlowMode mode = FlowMode::volume;
  double length = 0;                 // cells: waves of this length are attenuated tenfold, shorter ones more
  std::optional<double> target_rms;  // cells: ends as soon as the surface has moved so far, root of the mean square (the discrepancy principle)
  std::optional<double> deviation;   // cells: |phi - phi0| stays at most this at every node
  bool keep_volume = true;
  double curvature_radius = 0;               // cells; > 0: only what has a smaller radius of curvature moves
  const Field<float>* mobility = nullptr;    // 0 ... 1 at nodes, a factor of the displacement; in phi's layout
  RedistanceMethod redistance = RedistanceMethod::closest;
};

struct SmoothingResult {
  double time = 0;           // of the flow, in cells squared
  int steps = 0;             // each ends with a redistancing
  int unsteady = 0;          // redistancings by a PDE that ended before they were steady
  double volume_before = 0;  // of the zero surface, in cells cubed
  double volume_after = 0;
  double rms_moved = 0;      // of |phi - phi0| at nodes beside the surface, in cells
  bool reached_target = false;
};

// The time, in cells squared, in which a mode attenuates a wave of this length tenfold.
double flow_time_for(FlowMode mode, double length);
// Cells by which a surface may move in that time: the `room` that its level set needs.
double room_for_smoothing(FlowMode mode, double length);
// Cells around the surface that smoothing keeps a distance function: the `band` that its level set needs.
inline constexpr double kFlowBand = 5;

// Smooths the surface of a level set whose blocks are finest within its band and the room.
SmoothingResult smooth(LevelSet& level_set, const SmoothingOptions& options, Progress& progress = no_progress());

}  // namespace burnish
