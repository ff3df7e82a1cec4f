// Hinges: the two facets at an edge, and how far their four points are from a plane.
#pragma once

#include "burnish/surface/edge_table.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The level of noise that the flattest `share` of the hinges allows, in model units: points of a flat surface with noise sigma give sigma, if it is small
// against the edges; folds give less (0.6 sigma for 0.7 mean edges), curvature more, faceted parts with flat faces 0. About 50,000 hinges are looked at.
double hinge_level(const TriangleSoup& soup, const EdgeTable& edges);

}  // namespace burnish
