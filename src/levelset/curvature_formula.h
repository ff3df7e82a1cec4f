// The curvature of a level set from derivatives of phi: one formula for the flow and for curvature fields.
#pragma once

namespace burnish::detail {

// div(grad phi / |grad phi|) |grad phi|^3. [T-CURV-1] V is double, or a row of them.
template <class V>
inline V curvature_times_cube(const V& x, const V& y, const V& z, const V& xx, const V& yy, const V& zz, const V& xy, const V& xz, const V& yz) {
  return (y * y + z * z) * xx + (x * x + z * z) * yy + (x * x + y * y) * zz - 2 * (x * y * xy + x * z * xz + y * z * yz);
}

}  // namespace burnish::detail
