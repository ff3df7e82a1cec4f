// Octrees that are as fine as the distance to the surface needs, by an error in numbers: growing them, and coarsening.
//
// Lengths are in finest cells unless said otherwise. On an octree grown here leaves of several levels meet the surface;
// `sample` (octree/field.h) interpolates across their jumps.
#pragma once

#include <memory>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/octree/refine.h"
#include "burnish/octree/transfer.h"

namespace burnish {

struct ErrorOptions {
  double tolerance = 0.1;   // what trilinear interpolation may be off, in finest cells
  int coarsest_level = 3;   // of blocks within the band
  double band = 3;          // cells of a block's own level, at least 2
  // Cells of a block's own level within which distances off the surface are compared as well; 0: only the surface itself.
  // Beside thin walls and sharp edges distances have kinks, which divide blocks for as long as these lie within it. At most `band`.
  double checked = 2;
};

// The error criterion: divides a block of level l unless the trilinear interpolant of the exact signed distances at its nodes
//  (a) is within the tolerance of the exact distance at every node of level l - 1 in cells whose corners are all within `checked`
//      and `band` cells of the surface, and
//  (b) is within the tolerance of 0 on the surface inside the block: at vertices and centroids of facets, and along their
//      edges at points no more than half a cell apart. This finds details between the nodes.        [T-ADAPT-1]
// Of a surface that is smooth on the scale of a cell the nodes of (a) have the largest error. Beside a coarser leaf, corners
// that hang are interpolated there: up to twice the tolerance.
//
// What it is asked about is an octant as it comes: blocks that the 2:1 balance divides are not asked about again, and at nodes on a block's upper
// edges and corners the closest facet may be out of its list's reach (band 3), so that the distance there is one to another facet.
//
// Signs are those of the closest facet, by angle-weighted pseudonormals at edges and vertices: right for closed surfaces with
// consistent orientation and shared points. Elsewhere a wrong sign makes the error larger, and the block is divided.
//
// Cost: about a microsecond per facet and level for (b), which is tried first, and once to twice that for (a) where (b) is content. Growing
// all levels takes about as long as the uniform level set of the finest, more where facets are smaller than its cells
// (docs/benchmarks.md). `lattice_soup` must outlive the criterion.                                   [T-ADAPT-2]
std::unique_ptr<RefinementCriterion> distance_error(const TriangleSoup& lattice_soup, const ErrorOptions& options);

// grow_adaptive by the error criterion alone, for blocks (8 cells a side). Throws as that does.
AdaptiveGrowth grow_to_tolerance(const TriangleSoup& lattice_soup, int depth, const ErrorOptions& options,
                                 Progress& progress = no_progress());

// Merges eight sibling leaves, level by level up to `coarsest_level`, where the nodes that remain suffice: at every node of `set` with
// |phi| < set.band, `sample` of the result is within `tolerance` of phi; where |phi| >= set.band only the sign is kept. This
// is checked on the result itself, across its level jumps, and what fails is divided again. The result is balanced.
//
// A field clamped at the band has a kink there and cannot get much coarser than the band: spread it first (levelset/far_field.h).
// phi is carried over by injection, lists of facets by `transfer_facets`; other fields: transfer_nodal, transfer_conserved from
// set.octree() to the result's. Cost: about one trilinear interpolation a node and level. T is float or double.     [T-ADAPT-3]
template <class T>
BasicLevelSet<T> coarsen(const BasicLevelSet<T>& set, double tolerance, int coarsest_level, Progress& progress = no_progress());

}  // namespace burnish
