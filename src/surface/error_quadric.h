// Sums of weighted squared distances to planes, as quadratic functions. Private to src/surface.
#pragma once

#include "burnish/core/vec.h"

namespace burnish {

// Q(d) = d.A d + 2 b.d + c, d from a point that its owner knows: nothing cancels far away from the origin. [T-SIMP-1]
struct ErrorQuadric {
  double xx = 0, xy = 0, xz = 0, yy = 0, yz = 0, zz = 0;
  Vec3 b;
  double c = 0;

  // The plane through d = 0 with unit normal n.
  void add_plane(const Vec3& n, double weight) {
    xx += weight * n.x * n.x, xy += weight * n.x * n.y, xz += weight * n.x * n.z;
    yy += weight * n.y * n.y, yz += weight * n.y * n.z, zz += weight * n.z * n.z;
  }
  Vec3 times(const Vec3& d) const { return {xx * d.x + xy * d.y + xz * d.z, xy * d.x + yy * d.y + yz * d.z, xz * d.x + yz * d.y + zz * d.z}; }
  double at(const Vec3& d) const { return dot(d, times(d)) + 2 * dot(b, d) + c; }
  // The same function, of distances from a point `by` farther.
  ErrorQuadric moved(const Vec3& by) const {
    ErrorQuadric q = *this;
    q.b += times(by);
    q.c = at(by);
    return q;
  }
  ErrorQuadric& operator+=(const ErrorQuadric& o) {
    xx += o.xx, xy += o.xy, xz += o.xz, yy += o.yy, yz += o.yz, zz += o.zz;
    b += o.b;
    c += o.c;
    return *this;
  }
  // The minimum of Q(d) + share tr(A) d.d: unique, and near d = 0 where planes leave a direction free. [T-SIMP-2]
  Vec3 minimum(double share) const {
    const double t = share * (xx + yy + zz);
    const double a = xx + t, d = yy + t, f = zz + t;
    const double c00 = d * f - yz * yz, c01 = xz * yz - xy * f, c02 = xy * yz - xz * d;
    const double determinant = a * c00 + xy * c01 + xz * c02;
    if (!(determinant > 0)) return {};
    const double c11 = a * f - xz * xz, c12 = xy * xz - a * yz, c22 = a * d - xy * xy;
    return Vec3{c00 * b.x + c01 * b.y + c02 * b.z, c01 * b.x + c11 * b.y + c12 * b.z, c02 * b.x + c12 * b.y + c22 * b.z} / -determinant;
  }
};

}  // namespace burnish
