// Trimming a surface along the zero line of values at its points.
#pragma once

#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The part of a welded surface where the values, linear in each facet, are not negative. Facets that change sign are cut;
// both facets at an edge cut it in the same point, at least 2 % of the edge away from its ends. So an oriented
// 2-manifold stays one, now with open edges, and a surface free of self-intersections stays free of them, up to the
// rounding of the cuts. `values`: one per point.
TriangleSoup trim_negative(const TriangleSoup& welded, const std::vector<double>& values);

}  // namespace burnish
