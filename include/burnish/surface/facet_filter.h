// Leaving out the facets that carry nothing: repeated points, copies, and double walls.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct FilteredFacets {
  TriangleSoup soup;                   // welded; groups follow
  std::vector<std::uint32_t> source;   // facet of the input behind each facet
  std::size_t degenerate = 0;          // left out: repeat a point or, unless kept, are collinear
  std::size_t duplicate = 0;           // left out: copies of a facet that stays
  std::size_t walls = 0;               // left out: copies of which none stays
};

// Leaves out degenerate facets and copies (the same three points, in any order) of a welded soup. `keep_collinear`
// keeps facets without an area whose points differ: they close the edges they join.
//
// Of the copies of a facet one stays, or none: copies that lie back to back between two bodies are a wall inside
// the solid, and copies that stick out are a sheet without thickness. So of each connected part of copied facets none
// stays when that leaves fewer of its edges with an odd number of facets, and copies face both ways; the first of each
// stays otherwise. Copies that all face one way stay, all of them, where that leaves fewer such edges: bodies that overlap have
// a facet in common. [T-WALL-1]
// With `drop_copies` false all copies stay.
FilteredFacets filter_facets(const TriangleSoup& welded, bool keep_collinear, bool drop_copies = true);

}  // namespace burnish
