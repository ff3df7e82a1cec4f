// Fewer facets of any surface, for pictures: points in one cell of a grid become one.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// No more than `facets` facets, as many as a grid gives that is fine enough; the soup itself if it has no more. Works on whatever is broken.
//
// Points of a cell whose surfaces look into the same octant become their mean, so that both sides of a thin wall stay apart; those of
// `kept` stay where they are, unless they alone are too many. Facets whose points fall together go. Nothing moves by more
// than the diagonal of a cell, which is about sqrt(2 area / facets) wide. Rossignac & Borrel 1993.
// The same bits on any number of threads. Linear, times the number of grids tried: up to ten.
TriangleSoup reduced_for_drawing(const TriangleSoup& welded, std::size_t facets, const std::vector<bool>& kept);

}  // namespace burnish
