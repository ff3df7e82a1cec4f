// Orientation of a soup: facets of one patch agree, and patches face outwards where they are seen.
#pragma once

#include <cstddef>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct OrientedSoup {
  TriangleSoup soup;            // facets, points, groups and colours in the order of the input
  std::size_t facets_flipped = 0;
  std::size_t patches = 0;      // pieces connected through edges that two facets share
  std::size_t patches_flipped = 0;  // of which turned over as a whole
};

// Orients a welded soup in two steps.
//
// 1. *Inside a patch* (facets connected through edges with exactly two uses) neighbours are made to run
//    their common edge in opposite directions; the direction of the larger part of the patch wins. Exact
//    for single flipped facets. One-sided (Moebius) patches keep one inconsistent seam.
// 2. *Between patches*: parallel rays along the three axes; the first and the last facet a ray meets are
//    seen from outside and vote for their patch. A patch is turned over at three or more votes of which more than
//    two thirds see its back. What is not seen from outside (a cavity) is left as it is.
OrientedSoup orient(const TriangleSoup& welded);

}  // namespace burnish
