// Spreading distances from the band to the whole domain.
#pragma once

#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/distance.h"

namespace burnish {

// Gives every node beyond the band its distance to the surface too: closest facets propagate outwards.
//
// Leaf by leaf, in waves from the surface, a leaf's nodes are compared with the facets that are closest to a sample of
// its finished neighbours' nodes. A node's value is the exact distance to one of these facets: never too small, and
// too large only where the closest facet is none of its neighbourhood's, near the medial axis. Nodes within the band
// keep their values. Facets that are not `active` (empty: all are) must not occur in `field.nearest`.
//
// Afterwards every leaf stores its values. Without any facet in the band the field stays as it is. Same bits for any number of threads.
void spread_far_field(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, DistanceField& field,
                      Progress& progress = no_progress());

}  // namespace burnish
