// Curvature of the zero surface.
//
// Convention [T-CONV-3]: principal curvatures with respect to the outward normal, positive where the solid is convex: a ball of radius R
// has k1 = k2 = 1/R. Their sum is kappa of the thesis' tables, half of it the mean curvature, their product the Gaussian. Lengths are finest cells.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/core/vec.h"
#include "burnish/levelset/level_set.h"

namespace burnish {

// The order in h of curvatures where phi is a smooth distance.
enum class CurvatureOrder : std::uint8_t { second = 2, fourth = 4, sixth = 6 };

// Cells (of the leaf's level) around the surface in which phi has to be a distance: what stencils reach. Beside level jumps twice as many
// are needed; with fewer, points there get a lower order.
double curvature_band(CurvatureOrder order);

struct FrontCurvature {
  Vec3 foot;                        // on the surface, lattice units
  Vec3 normal;                      // outward, unit
  double k1 = 0, k2 = 0;            // k1 >= k2, per finest cell
  Vec3 direction1, direction2;      // unit, tangential; direction1 x direction2 = normal. Any where k1 = k2; signs have no meaning
  int order = 0;                    // 2, 4 or 6: less than was asked for where wider stencils meet values that are no distance, or kinks
  bool converged = false;           // false: there is no curvature here (below); the rest is of no value then

  double mean() const { return 0.5 * (k1 + k2); }
  double gaussian() const { return k1 * k2; }
};

// Direct front curvature (after Herrmann 2008): from derivatives of phi's interpolant at the closest points of the surface to `points` (lattice
// units, within a cell or so of it). One result per point, in their order; the same bits for any number of threads.
//
// Orders 4 and 6 differentiate the Lagrange polynomial through 6 and 8 nodes per axis; order 2 interpolates central differences [T-CURV-3, 4]. phi
// need not be a distance where it is smooth, but |grad phi| has to be near 1. Works in leaves of any level, in their own cells. Where second derivatives
// of orders 4 and 6 are off those of order 2 by more than 10 %, wide stencils reach over a kink, and order 2 is used [T-CURV-7]. Measured errors are in
// theory.md. About 0.65 microseconds a point for order 4; derivatives at a foot that is known are a seventh of that.
//
// `converged` is false where a point is outside the domain or in a leaf that stores nothing; where no closest point is found within two cells
// (of the point's leaf); where |grad phi| there is not in 3/4 ... 4/3 (kinks: at a right-angled edge it is 0.7); where a curvature exceeds 2 per cell;
// and where even the stencil of order 2 meets a clamped value: one of size `band` cells of the leaf that stores it, in a leaf that stores
// nothing, beyond a wall, or interpolated across a level jump from what may be one of these.
template <class T>
std::vector<FrontCurvature> front_curvature(const BasicLevelSet<T>& level_set, std::span<const Vec3> points, CurvatureOrder order,
                                            Progress& progress = no_progress());

// kappa = k1 + k2 of the level set through each node, by central differences there: of first order as an estimate of the surface's curvature, for
// comparison. Orders second and fourth; nodes beyond the band get 0, and beside its end, where stencils meet clamped values,
// results are of no value. 10 to 15 ns a node.
template <class T>
Field<T> nodal_curvature(const BasicLevelSet<T>& level_set, CurvatureOrder order, Progress& progress = no_progress());

// A cross-check that shares nothing with these stencils: a polynomial of degree 4 in the height above the tangent plane, fitted to the points of
// the surface (of the tricubic interpolant) above a grid of 5 x 5 points within 1.8 cells of the foot [T-QUADRIC-3]. Of second order. Costs
// 17 microseconds a point. Clamped values are not looked for.
template <class T>
std::vector<FrontCurvature> quadric_curvature(const BasicLevelSet<T>& level_set, std::span<const Vec3> points, Progress& progress = no_progress());

}  // namespace burnish
