// From derivatives of phi at a point of the surface to its curvatures.
#pragma once

#include <algorithm>
#include <cmath>

#include "burnish/core/vec.h"
#include "curvature_kernel.h"

namespace burnish::detail {

// An orthonormal frame u, v, normal, right-handed, that depends on the normal alone.
struct TangentFrame {
  Vec3 normal, u, v;

  explicit TangentFrame(const Vec3& n) : normal(n) {
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
    u = cross(axis, n);
    u *= 1 / norm(u);
    v = cross(n, u);
  }
};

// The shape operator of the level set through a point, in a frame of its tangent plane. [T-CURV-2]
struct ShapeOperator {
  TangentFrame frame;
  double uu, uv, vv;

  ShapeOperator(const Jet& jet, double length) : frame(jet.gradient * (-1 / length)) {
    const auto times = [&](const Vec3& a) {
      return Vec3{jet.xx * a.x + jet.xy * a.y + jet.xz * a.z, jet.xy * a.x + jet.yy * a.y + jet.yz * a.z,
                  jet.xz * a.x + jet.yz * a.y + jet.zz * a.z};
    };
    const Vec3 hu = times(frame.u), hv = times(frame.v);
    uu = -dot(frame.u, hu) / length;
    uv = -dot(frame.u, hv) / length;
    vv = -dot(frame.v, hv) / length;
  }

  double mean() const { return 0.5 * (uu + vv); }
  double half_difference() const { return std::sqrt(0.25 * (uu - vv) * (uu - vv) + uv * uv); }

  // The unit vector in which the curvature is the larger one; u where both are equal.
  Vec3 direction1() const {
    const double r = half_difference(), d = 0.5 * (uu - vv);
    if (!(r > 0)) return frame.u;
    // cos and sin of half the angle of (d, uv), without cancellation
    double c = std::sqrt(0.5 * (r + std::abs(d)) / r), s = 0.5 * std::abs(uv) / (r * c);
    if (d < 0) std::swap(c, s);
    const Vec3 along = frame.u * c + frame.v * std::copysign(s, uv);
    return along / norm(along);
  }
};

}  // namespace burnish::detail
