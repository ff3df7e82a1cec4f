// Signed deviation: how far points are from a surface, and on which side of it.
#pragma once

#include <vector>

#include "burnish/surface/compare.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

class TriangleIndex;

// How a side is told.
enum class SideRule {
  // Of closed chains: a point is inside where the winding number is not zero, either way round. That holds with
  // overlapping bodies and with surfaces turned inside out. A closed chain (surface/winding.h) has an inside and an outside even where more than
  // two facets share an edge. Undecided by rounding at distances of 1e-15 of the size.
  winding_number,
  // Of all others: a point is inside if it is behind the closest facet. Of facets equally close, at an edge or a point,
  // the one counts whose plane the point is farthest from.
  closest_facet,
};
SideRule side_rule(const TriangleSoup& welded);

// The distance of each point from `to`, positive outside and negative inside. `closest` and `index` both ask `to`, which
// is welded. Same bits for any number of threads. Cost: that of `closest`, and for the side that of one pass over the facets by winding numbers, or 2 us
// a point by the closest facet.
std::vector<double> signed_deviation(const std::vector<Vec3>& points, const TriangleSoup& to, const TriangleIndex& index,
                                     const ClosestQuery& closest, SideRule rule);

}  // namespace burnish
