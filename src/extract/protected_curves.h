// Polylines that a mesher can protect, from polylines as they come.
#pragma once

#include <vector>

#include "burnish/core/vec.h"

namespace burnish::detail {

// The curves of the polylines, resampled to chords of at most edge / 2, so that they meet nowhere but in common ends [T-DELAUNAY-4]:
//  - ends within edge / 4 of each other are one; an end as near to the middle of another polyline divides that;
//  - pieces that come within edge / 2 of another curve, or of their own other parts, are left out, but for the first 1.5 edges from an end in which both meet;
//  - open curves shorter than an edge between free ends, and closed ones shorter than four, are left out.
// Points that are no numbers end a polyline. Same result for the same input; near-linear in the number of chords.
std::vector<std::vector<Vec3>> separated_curves(const std::vector<std::vector<Vec3>>& polylines, double edge);

}  // namespace burnish::detail
