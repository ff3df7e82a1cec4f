// Local repair: mends a soup where it is broken and leaves every other facet as it is, bit for bit.
//
// Steps, each only where it is needed: facets are paired across edges (at an edge with more than two facets by
// angle, so that bodies that touch come apart), points that several fans share are doubled and moved apart, needles are
// flipped away, holes are filled, and facets that intersect are cut along each other, so that the union of what they
// bound remains (surface/solid_union.h); what still intersects is cut out and filled anew. CGAL's polygon mesh processing does the mending; nothing here promises that the result is a valid
// solid: `inspect` the file that was written.
//
// What local repair is not made for it refuses, with a reason: sheets that intersect themselves in many places, and tangles
// that cutting does not resolve. One-sided surfaces are cut along a seam.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/surface/hole.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct LocalRepairOptions {
  // Openings wider than this stay open. Unset: all are filled.
  std::optional<double> max_hole;
  // New points are rounded to float32, as the file will have them: what that breaks is mended here.
  bool float32 = false;
  // Facets that intersect are cut, or cut out. Otherwise the result is a closed 2-manifold whose facets may intersect.
  bool resolve_intersections = true;
};

struct LocalRepairResult {
  TriangleSoup soup;                      // welded
  // The facet of the input with the same three points, or kNoFacet.
  std::vector<std::uint32_t> source;
  std::vector<char> fills_hole;           // 1 for facets that fill a hole
  std::vector<std::uint32_t> parent;      // used between steps; empty in a result
  std::vector<Hole> holes;                // largest first
  std::size_t needles_flipped = 0;        // degenerate facets taken out by flipping or collapsing
  std::size_t points_split = 0;           // copies made of points that several fans shared
  double largest_split = 0;               // how far such a copy was moved
  std::size_t intersecting_pairs_removed = 0;
  std::size_t tangled_removed = 0;        // facets at edges that no two-sided surface has
  std::size_t facets_cut = 0;             // that met others, where bodies were united
  std::string refusal;                    // empty: done; else why local repair cannot do it
};

// Repairs an oriented soup (surface/orient.h), welded, without facets that repeat a point and without duplicates;
// collinear facets are welcome, they close what they close. Deterministic. Throws Error{interrupted}.
LocalRepairResult repair_locally(const TriangleSoup& oriented, const LocalRepairOptions& options = {},
                                 Progress& progress = no_progress());

}  // namespace burnish
