// Winding numbers of many points at once, about facets whose directed edges cancel.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Whether the boundary of the chain of facets is zero: every edge is run through as often one way as the other, between the same
// points (not only equal coordinates). False without facets. Decided by a sum of hashes, so that a chain that is not closed passes
// with a probability of 2^-64. Linear time, about 5 ns a facet.                                       [T-WIND-4]
bool is_closed_chain(const TriangleSoup& soup);

// How often the facets wind around each of the points: whole numbers, by rays upwards [T-SHELL-1]. Exact but for rounding of a facet's
// height at a point: a point off all facets by more than that gets what any other point of its region gets. `soup` must be a
// closed chain. One pass over the facets for all points; same result for any number of threads.
std::vector<std::int32_t> winding_numbers(const TriangleSoup& soup, const std::vector<Vec3>& points);

}  // namespace burnish
