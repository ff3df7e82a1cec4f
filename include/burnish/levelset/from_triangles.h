// A signed distance field from a capped triangle soup: the level set's beginning.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/octree/refine.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// What a facet is to the solid.
enum class FacetRole : std::uint8_t {
  boundary,    // part of its surface
  interior,    // inside, where bodies overlap
  unresolved,  // outside on both sides: a sheet, or a wall thinner than a cell
};

struct LevelSetFromTriangles {
  LevelSet level_set;
  std::size_t regions = 0;             // connected parts of the lattice that facets separate
  std::size_t ambiguous_regions = 0;   // whose side had to be decided node by node
  std::size_t winding_evaluations = 0;
  std::size_t interior_facets = 0;     // inside the solid (of overlapping bodies): no part of its surface
  std::size_t unresolved_facets = 0;   // outside on both sides: sheets, or walls thinner than a cell
  double unresolved_area = 0;          // of the latter, in cells squared
  std::vector<FacetRole> roles;        // of every facet
  GrowthStatistics growth;             // of an adaptive octree: what divided its octants; the error criterion comes last
  Field<std::uint32_t> nearest;        // a facet nearest to each node, if it was asked for; kNoFacet where none was looked for
  Field<std::uint8_t> certainty;       // of each node's side, 0 to 255 (levelset/sign.h); empty: all are certain
};

// How much coarser than the finest cells blocks near the surface may be.
struct Adaptivity {
  // What trilinear interpolation may be off, in finest cells (levelset/adapt.h). Without it blocks are divided by the limits only.
  std::optional<double> tolerance;
  RefinementLimits limits;  // the thesis' criteria, and the coarsest level; the band is that of the level set

  bool wanted() const { return tolerance || limits.max_face_limit || limits.max_face_cut || limits.refine_tol || !limits.boxes.empty(); }
};

struct LevelSetOptions {
  double band = 3;        // cells of exact distance on both sides of the surface
  double room = 0;        // cells beyond the band that are finest too, for a surface that will move
  Adaptivity adaptivity = {};  // if wanted, room must be 0
  bool far_field = true;  // spread distances to the whole domain; without it |phi| ends at `band`
  bool keep_nearest = false;  // return the nearest facets, 4 bytes a node
};

// The signed distance to the surface of the solid that the soup bounds: exact where it is at most `band` cells of the leaf's level,
// propagated from there to the rest of the domain (levelset/far_field.h) if asked for, positive inside.
//
// `soup` is closed as a chain (surface/boundary_caps.h) and in model coordinates. Facets that do not separate
// inside from outside are no part of the solid's surface and lose their influence on the distance.
// Throws Error{interrupted}. Same bits for any number of threads.
LevelSetFromTriangles level_set_from_triangles(const TriangleSoup& soup, const GridFrame& frame, const LevelSetOptions& options = {},
                                               Progress& progress = no_progress());

// The level set of a shell of thickness 2 `half_thickness` (cells) about the facets, whatever they bound or do not bound:
// half_thickness - distance, exact where |phi| <= `band`.
LevelSet level_set_of_shell(const TriangleSoup& soup, const GridFrame& frame, double half_thickness, const LevelSetOptions& options = {},
                            Progress& progress = no_progress());

// The soup in lattice coordinates of the frame.
TriangleSoup to_lattice(const TriangleSoup& soup, const GridFrame& frame);

}  // namespace burnish
