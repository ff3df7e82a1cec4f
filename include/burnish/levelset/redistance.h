// Redistancing: turning any level set function back into the signed distance to its zero surface.
#pragma once

#include <cstdint>
#include <limits>
#include <string_view>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"

namespace burnish {

enum class RedistanceMethod : std::uint8_t {
  closest,    // Newton's method for the closest point of a tricubic interpolant; the default
  fmm,        // closest points beside the surface, marched outwards from there and refined at the end
  pde_weno5,  // phi_t = S (1 - |grad phi|), HJ-WENO5 with TVD-RK3
  pde_first,  // the same of first order (the thesis' 2.7 and 2.8)
};

std::string_view name(RedistanceMethod method);  // "closest", "fmm", "pde-weno5", "pde-first"

struct RedistanceOptions {
  RedistanceMethod method = RedistanceMethod::closest;
  // Afterwards |phi| ends at this many cells of each leaf's own level. Infinite: nowhere.
  double reach = std::numeric_limits<double>::infinity();  // nodes that no surface reaches keep |phi| then
  // Nodes with a value other than 0 keep phi as it is: the thesis' ACCEPTED values, Dirichlet data. In phi's layout. Without
  // it the surface is that of phi's interpolant.
  const Field<std::uint8_t>* accepted = nullptr;
  // Of the PDE only: steps that are taken at most (0: as many as the reach, or the domain, needs), and the rms change of a step,
  // relative to the step in pseudo-time, at which phi counts as steady.
  int most_steps = 0;
  double steady = 1e-6;
};

struct RedistanceResult {
  int steps = 0;        // of the PDE
  double residual = 0;  // of its last step
  bool steady = true;
};

// Replaces phi by the signed distance to the surface phi = 0 in all leaves that store values, of any level. Signs stay.
// By closest points (closest, fmm) the error is O(h^4) where the distance is smooth, across level jumps too, phi's scale may vary, and the
// surface moves by what tricubic interpolation of the given phi is off. At kinks and in noise results are finite and errors below
// a cell. The two differ in how nodes within six cells are refined: `closest` does so on the lattice of the node's own leaf. [T-REDIST-1 to 4]
// Same bits for any number of threads. Throws Error{interrupted}.
template <class T>
RedistanceResult redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress = no_progress());

// By closest points, up to min(band, reach) cells.
template <class T>
void redistance(BasicLevelSet<T>& level_set, double reach, Progress& progress = no_progress());
template <class T>
void redistance(BasicLevelSet<T>& level_set, Progress& progress = no_progress()) {
  redistance(level_set, level_set.band, progress);
}

}  // namespace burnish
