// Closing the boundary of an oriented soup, so that winding numbers become integers.
//
// Summed over all facets, directed edges cancel where the surface is closed and consistently oriented. What
// is left is a chain of directed edges that enters every point as often as it leaves it: holes, cracks,
// rims of open sheets, the seams of flipped facets and of sheets that end on others. It splits into closed
// loops; a *cap* is a triangulated disc that fills one of them. Facets and caps together are a closed chain,
// whose winding number is an integer away from them, however broken the input.
#pragma once

#include <cstddef>
#include <vector>

#include "burnish/surface/hole.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// A loop of three edges or more, and the facets that fill it.
struct Cap {
  Hole hole;
  std::size_t first_facet = 0, facet_count = 0;
};

struct CappedSoup {
  TriangleSoup soup;       // the input's facets, then the caps' (which may bring points of their own)
  std::size_t first_cap_facet = 0;
  std::vector<Cap> caps;   // in the order of their facets
  double cap_area = 0;
};

// Caps a welded, oriented soup. Caps have no colour; where there are groups, they are one more, without a name.
//
// Loops of up to 256 edges get the triangulation of least area (dynamic programming, O(n^3); Klincsek
// 1980); longer ones a membrane: a disc of rings whose points solve Laplace's equation with the loop as
// boundary. Directed edges sum to zero afterwards: exactly, by construction.
CappedSoup cap_boundary(const TriangleSoup& oriented);

}  // namespace burnish
