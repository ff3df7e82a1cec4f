// Normals of facets, filtered over their sides so that creases stand out of the noise.
#pragma once

#include "burnish/surface/edge_table.h"
#include "burnish/surface/facet_normals.h"

namespace burnish {

// A facet's height over its longest side.
double altitude(const TriangleSoup& soup, const FacetNormals& normals, std::uint32_t facet);

// Filters the normals by what noise of standard deviation sigma (in the soup's units) does to them; without noise, that many
// passes. Returns the tilt of the noise: sigma in edges of the equilateral triangle that is as high as the median facet. [T-NOISE-6]
double filter_normals(const TriangleSoup& soup, const EdgeTable& edges, double sigma, int clean_passes, FacetNormals& normals);

}  // namespace burnish
