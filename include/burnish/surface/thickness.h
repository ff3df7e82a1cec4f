// How thick a solid is behind its surface.
#pragma once

#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The thickness of walls, sampled: from points spread over the surface by area (stratified, deterministic) rays run inwards
// along the normal to the first facet. Counted is what they run through where that facet faces away and is
// within 60 degrees of parallel: a wall, not a wedge. Ascending, model units; each entry stands for 1 / `samples` of the
// area, so that fewer entries than samples are usual. `oriented`: facets face outwards. 1 to 2 us a sample, and the index. [T-THICK-1]
std::vector<double> wall_thicknesses(const TriangleSoup& oriented, std::size_t samples);

}  // namespace burnish
