// Rigid motions that are known.
#pragma once

#include <cmath>

#include "burnish/surface/registration.h"
#include "support/shapes.h"

namespace burnish::test {

// A rotation about an axis through the origin (radians, right-hand rule; Rodrigues), then a shift.
inline RigidMotion turn(const Vec3& axis, double angle, const Vec3& shift) {
  const Vec3 u = axis / norm(axis);
  RigidMotion m;
  for (int i = 0; i < 3; ++i) {
    Vec3 e;
    e[i] = 1;
    const Vec3 column = e * std::cos(angle) + cross(u, e) * std::sin(angle) + u * (dot(u, e) * (1 - std::cos(angle)));
    for (int r = 0; r < 3; ++r) m.rows[static_cast<std::size_t>(r)][i] = column[r];
  }
  m.translation = shift;
  return m;
}

inline TriangleSoup by(const RigidMotion& m, const TriangleSoup& soup) {
  return mapped(soup, [&](const Vec3& p) { return m(p); });
}

}  // namespace burnish::test
