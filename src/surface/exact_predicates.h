// Exact predicates for units that do not see CGAL.
#pragma once

#include "burnish/core/vec.h"

namespace burnish {

// True if the three points lie on one line (or coincide), decided without rounding for any finite doubles.
// A few nanoseconds when they clearly do not.
bool exactly_collinear(const Vec3& a, const Vec3& b, const Vec3& c);

}  // namespace burnish
