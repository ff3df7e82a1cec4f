// Volume fractions: how much of each cell of a mesh lies inside a solid. The initial field of a volume-of-fluid simulation.
//
// Three methods, for three kinds of solid:
//
//   exact   a closed triangle surface: each facet is clipped to the cell and takes away what lies in its shadow, seen from a point in the cell. The
//           sum over a mesh that holds the solid is the solid's volume to rounding.                                                    [T-VOF-1]
//   linear  a signed distance: tetrahedra of cells are cut by the linear interpolant of phi and corrected by its quadratic part, and divided where
//           that is not enough (edges, thin walls). Third order for smooth phi.                                                        [T-VOF-4]
//   curved  the same, but a cell is cut by the tangent plane of the surface and corrected by its curvature: third order.               [T-VOF-5]
//
// All results are in [0, 1]; exactly 0 and 1 where the surface does not pass through. Cells are what polyhedral_mesh.h says. Same bits for any number of threads.
// Coordinates are the mesh's, whatever its unit.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/triangle_soup.h"
#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

struct VolumeFractions {
  std::vector<double> alpha;         // per cell
  double volume = 0;                 // sum of alpha x the cell's volume
  std::size_t mixed = 0;             // cells that the surface passes through
  std::size_t clamped = 0;           // whose result was outside [0, 1] by more than 1e-9 before it was clamped: of exact and linear ones none, of curved ones corners that a paraboloid overshoots
  double worst_clamp = 0;            // by how much
};

// `solid`: welded, closed (is_closed_chain), without self-intersections, oriented outwards. Throws Error{usage} if it is not closed.
// Any position is as good as any other: facets in the planes of faces, edges through points of the mesh, several bodies, cavities and bodies within one cell.
// Error of alpha: about 1e-15 x coordinates / size of the cell; of the total, relative, below 1e-12 (tested on every kind of mesh).
// A million hexahedra and a ball of 80,000 facets: 0.55 s of CPU time.
VolumeFractions exact_volume_fractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const TriangleSoup& solid,
                                       Progress& progress = no_progress());

// What the other two methods know of the solid. All are called from several threads.
struct SolidField {
  // phi at points: > 0 inside, a distance near the surface; beyond `band` of the surface only its sign and that it is farther are known.
  std::function<void(std::span<const Vec3> points, double* phi)> distance;
  double band = 0;  // at least the radius of cells at the surface, better twice that: shorter ones cost divisions, and may miss small bodies
  // The surface's closest point, outward normal, principal curvatures (positive where convex) and directions; false where there is none.
  struct Front {
    Vec3 foot, normal, direction1, direction2;
    double k1 = 0, k2 = 0;
    bool found = false;
  };
  std::function<void(std::span<const Vec3> points, Front* fronts)> front;  // for the curved method only
};

struct FractionOptions {
  double tolerance = 1e-3;   // linear: of a mixed cell's volume; by how much two ways of cutting may differ before it is divided
  int deepest = 4;           // linear: divisions of a cell's tetrahedra, by eight each
};

// Measured for a ball of R/h = 6, 12, 24 with exact phi, relative error of the volume: 1e-5, 2e-6, 6e-8 on hexahedra, 3e-5 and 1e-8 (6, 12) on tetrahedra. Calls `distance` with
// thousands of points at a time: once for the middle of every cell, then 60 (smooth) to 200 times for each mixed hexahedron. A million hexahedra: 0.8 s besides.
VolumeFractions linear_volume_fractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field,
                                        const FractionOptions& options = {}, Progress& progress = no_progress());

// Cells in which no front is found (kinks), or whose curvature times diameter exceeds 1, or whose points are not where it says, are cut by the linear method. [T-VOF-5]
// Relative errors as above: 2e-5, 1e-7, 5e-8 on hexahedra, 7e-6, 9e-7, 7e-8 on tetrahedra. Calls `front` once and `distance` 7 times for each mixed hexahedron.
VolumeFractions curved_volume_fractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field,
                                        const FractionOptions& options = {}, Progress& progress = no_progress());

// The part of a tetrahedron in which a linear function with these values at its corners is positive: 0 to 1. [T-VOF-3]
double positive_share(double a, double b, double c, double d);

}  // namespace burnish
