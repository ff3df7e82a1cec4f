// Curvatures of a surface that is known by points: osculating paraboloids.
#pragma once

#include <span>

#include "burnish/core/vec.h"

namespace burnish {

struct OsculatingParaboloid {
  Vec3 foot, normal;               // where the fit meets the line through the centre along the given normal; its own unit normal there
  double k1 = 0, k2 = 0;           // k1 >= k2 with respect to the normal: positive where the surface bends away from it, as a ball does
  Vec3 direction1, direction2;     // unit, tangential; direction1 x direction2 = normal
  double residual = 0;             // rms of the points' heights above the fit
  bool valid = false;              // false: fewer points than coefficients, or points that do not determine them
};

// Fits z = a x^2 + b x y + c y^2 + d x + e y + f to the points by least squares (QR), z along the normal (any length), x and y across it from
// the centre, and takes curvatures from its fundamental forms at x = y = 0. [T-QUADRIC-1, 2] `degree` 3 or 4 adds terms of that degree, which
// absorb what a paraboloid cannot follow. Six points are the least, 10 and 15 with these terms. Of spacing s on a surface with radius of curvature R,
// a paraboloid's curvatures are off by O(s^2) where points lie symmetrically, O(s) otherwise.
OsculatingParaboloid osculating_paraboloid(const Vec3& center, const Vec3& normal, std::span<const Vec3> points, int degree = 2);

}  // namespace burnish
