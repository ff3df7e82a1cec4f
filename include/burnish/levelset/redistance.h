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
  // Nodes with a value other than 0 keep phi as it is, bit for bit: the thesis' ACCEPTED values, Dirichlet data. In phi's layout; they
  // count as distances from a surface also where no sign changes. Without it the surface is that of phi's interpolant. The PDE wants all corners of cells that the surface cuts among them: with a field of zeros nothing
  // holds the surface in place (moves by half a cell are normal, [T-PDE-3]), as in the thesis' excessive reinitialisation.
  const Field<std::uint8_t>* accepted = nullptr;
  // Of the PDE only. Steps that are taken at most; 0: as many as the reach, or the domain, needs, and pde_weno5 starts with steps of first order,
  // so that any start will do. The change of a step relative to the step in pseudo-time at which phi counts as steady, but no less than rounding
  // makes: the root of the sum of squares within the reach over the number of nodes of all leaves that take part; 1e-6 is enough for 1e-4 cells, kinks within the reach may keep pde_weno5 from coming so far.
  int most_steps = 0;
  double steady = 1e-6;
};

struct RedistanceResult {
  int steps = 0;        // of the PDE, those of its start included
  double residual = 0;  // of its last step
  bool steady = true;
};

// Replaces phi by the signed distance to the surface phi = 0 in all leaves that store values, of any level. Signs stay.
// By closest points (closest, fmm) the error is O(h^6) where phi is smooth, across level jumps too: phi's scale may vary, and the
// surface moves by what triquintic interpolation of the given phi is off, 2e-5 cells for the case below at R = 12. Where phi is not smooth tricubic interpolation
// serves; at kinks and in noise results are finite and errors below a cell. The two differ in how nodes within five cells are refined: `closest`
// does so on the lattice of the node's own leaf. 0.3 us a node in a band, 0.5 us through a domain (float; 0.7 double). [T-REDIST-1 to 5]
//
// The PDE, from phi0 = (0.1 + |x - x0|^2) distance on a sphere of R cells: the surface moves by 3e-3 / R cells (first order: 0.1 / R), phi is off by 8e-5 R
// at R = 8 and by 1e-5 R at R = 16; from exact accepted values by 2e-5 R and 3e-7 R. 13 ns per node and stage, three stages a step (first order:
// 5 ns, one stage); float fields are computed in double.
//
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
