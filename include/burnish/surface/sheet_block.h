// Closing an open sheet as a block: terrain becomes the top of a slab of ground.
#pragma once

#include <optional>

#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Caps of openings are no help where the sheet is all there is: a membrane over the rim of a terrain runs through its
// hills. A sheet whose facets nearly all (98 % of its area) face one way, to within a right angle of their mean normal,
// is closed underneath instead: at every open edge the sheet goes on outwards, in its own plane, for `outwards` (for a fifth
// of the loop's width, if that is less: holes must not be overgrown); from there
// walls drop to a floor `depth` below the lowest point, which is the sheet's projection. So what is near the sheet's rim
// sees a sheet that goes on, and nothing else comes near. [T-BLOCK-1]
//
// `oriented`: welded and oriented. Everything that is added is one cap. Empty for other sheets, and for closed surfaces.
std::optional<CappedSoup> close_as_block(const TriangleSoup& oriented, double outwards, double depth);

}  // namespace burnish
