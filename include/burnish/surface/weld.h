// Welding: facets that meet at bitwise equal coordinates come to share points.
#pragma once

#include <cstddef>
#include <utility>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The soup with one point per distinct coordinate triple (-0 and +0 are equal), points in the order of
// their first use by a facet, unused points dropped, facets, groups and colours as before (nothing
// is removed, not even a facet that has become degenerate). Linear in the number of facets.
TriangleSoup weld(const TriangleSoup& soup);
TriangleSoup weld(TriangleSoup&& soup);

struct WeldedNear {
  TriangleSoup soup;
  std::size_t points_moved = 0;
};

// Joins points of *boundary* edges closer than `tolerance` (model units), each group to its first point,
// never two points of one facet. For soups whose edges stay unmatched after `weld`.
// `soup` must be welded.
WeldedNear weld_boundaries(const TriangleSoup& soup, double tolerance);

struct CleanedFacets {
  TriangleSoup soup;
  std::size_t degenerate = 0;  // facets dropped: two equal points, or collinear (exactly zero area)
  std::size_t duplicate = 0;   // facets dropped: same three points as an earlier one, in any order
};

// Drops degenerate facets and all but the first of duplicates. `soup` must be welded. Groups and colours
// follow; a group that has lost all its facets stays, with none.
CleanedFacets drop_degenerate_and_duplicate_facets(const TriangleSoup& soup);

}  // namespace burnish
