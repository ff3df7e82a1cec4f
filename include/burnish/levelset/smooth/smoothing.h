// Smoothing of the zero surface, with a physical length, a bound on the deviation, and the volume kept.
//
// **How.** The distance phi is diffused for a time, and what has become of the surface gets distances again: the surface has moved by its curvature,
// whatever the time (Merriman, Bence and Osher; with distances Esedoglu, Ruuth and Tsai 2010, 10.1016/j.jcp.2009.10.002). There is no limit of
// stability: steps are as long as a band of kFlowBand cells allows, 4 cells^2 for mcf where explicit steps end at 1/6. Not phi is diffused but its change, the
// displacement, which is constant along normals: so the band may be narrow. [T-SMOOTH-1 to 5]
//
// **Accuracy.** mcf: second order in space and time. A sphere of 51.2 cells obeys R^2 = R0^2 - 4 t at t = 0.05 R0^2 to 2e-5 (linear crossings
// of edges are off by that), of 12.8 cells to 5e-4. volume, filtered: with length 16 a sphere of 20 cells keeps its radius to 5e-5, one of 12.8 cells to
// 6e-4, one of 10 cells to 1.2e-3 (worst of ten offsets against the lattice), without their volume being kept. A wave of the length is left with 0.08 to 0.12 of its amplitude.
// Steps are long for sharp edges: mcf takes 5.3 % off the volume of a box of 28 cells with length 6 (one step), 18.7 % with 12 (three), where the flow takes
// 4.7 % and 17.6 %; of one of 56 cells with 12 and 24, 5.0 % and 18.0 %.
// White noise of half a cell on a sphere of 20 cells: volume with length 16 leaves 9 %, the volume kept to 1e-6.
//
// **Cost** is that of redistancing, once a step. A sixth to a quarter of what explicit steps need for a length of 20 cells.
#pragma once

#include <cstdint>
#include <optional>
#include <string_view>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/levelset/redistance.h"

namespace burnish {

// With X the length, a wave of length L = X / m is left with
enum class FlowMode : std::uint8_t {
  mcf,       // 0.1^(m^2): mean-curvature flow; everything shrinks, a sphere as R^2 = R0^2 - 4 t [T-FLOW-2]
  volume,    // 1 - (1 - e)^2 a step, e = exp(-(2 pi / L)^2 t): the kernel 2 G_t - G_2t, under which nothing shrinks to first order [T-SMOOTH-6]
  filtered,  // 1 - (1 - e)(1 - 0.1^(m^2)) a step: speed (filtered kappa - kappa), kappa's mean along the surface over X (the thesis'
             // 4.2, Malladi and Sethian); surfaces of constant mean curvature rest [T-SMOOTH-7]
  reinit,    // the thesis' excessive reinitialisation: redistancing by the PDE of first order with nothing held in place. For comparison: it moves the
             // surface by numerical diffusion that dies down, 25 % of a wave of 8 cells are left, 80 % of noise from node to node [T-SMOOTH-11]
};

std::string_view name(FlowMode mode);  // "mcf", "volume", "filtered", "reinit"

struct SmoothingOptions {
  FlowMode mode = FlowMode::volume;
  double length = 0;  // cells: waves of this length are attenuated tenfold, shorter ones more; 0: nothing moves
  // cells: ends as soon as the surface has moved by this, in the root of the mean square: the discrepancy principle, with the noise's
  // standard deviation. Met to a few per cent, as the last step is taken in part (reinit: by 25 steps). [T-SMOOTH-10]
  std::optional<double> target_rms;
  std::optional<double> deviation;  // cells: |phi - phi0| stays at most this at every node; wins over the volume [T-FLOW-5]
  // To 1e-6 of it, by a shift of at most max(2 cells, min(length / 2, twice the rms that the flow has moved the surface by)); that rms counts while it is
  // below half a band. If it takes more, a part of the surface has vanished: nothing is shifted, the rest stays as the flow has left it. [T-SMOOTH-9]
  bool keep_volume = true;
  // cells; > 0: what has no principal radius of curvature below this rests, what has one below 2/3 of it moves freely; in between smoothly. Curvatures are those after
  // a diffusion of 0.84 cells^2. For mcf, volume, filtered. [T-SMOOTH-8]
  double curvature_radius = 0;
  // 0 ... 1 at nodes, in phi's layout, a factor of the displacement and of the shift that keeps the volume. Nodes beside the surface with 0
  // keep phi, bit for bit. For mcf, volume, filtered; not null for as long as `smooth` runs.
  const Field<float>* mobility = nullptr;
  RedistanceMethod redistance = RedistanceMethod::closest;
};

struct SmoothingResult {
  double time = 0;           // of the flow, in cells squared; of volume the sum of its steps' t
  int steps = 0;             // each ends with a redistancing (of reinit: is one step of the PDE)
  int unsteady = 0;          // redistancings by a PDE that ended before they were steady
  double volume_before = 0;  // of the zero surface, in cells cubed, as enclosed_volume
  double volume_after = 0;   // keep_volume: as before, unless the deviation, mobility, or a part of the surface that has vanished forbids
  double rms_moved = 0;      // of phi - phi0 at nodes within half a cell of the surface, in cells; phi0 as far as it was known
  bool reached_target = false;
};

// The time, in cells squared, in which a mode attenuates a wave of this length tenfold: 0.0583 X^2 for mcf [T-FLOW-4], 0.0752 X^2 for one step of volume,
// 0.0648 X^2 for filtered in many steps.
double flow_time_for(FlowMode mode, double length);
// Cells by which a surface may move in that time, 0.483 X: the `room` that its level set needs.
double room_for_smoothing(FlowMode mode, double length);
// Cells around the surface that smoothing keeps a distance function: the `band` that its level set needs.
inline constexpr double kFlowBand = 5;

// Smooths the surface of a level set whose blocks are finest within its band and the room, and whose phi is a distance within the band. Afterwards phi
// is one up to min(band, kFlowBand) cells, but for the last shift of less than 0.1 cells that keeps the volume, and for what a deviation clamps.
//
// Same bits for any number of threads. Reports its fraction after each step. Throws Error{interrupted, time_limit}.
SmoothingResult smooth(LevelSet& level_set, const SmoothingOptions& options, Progress& progress = no_progress());

}  // namespace burnish
