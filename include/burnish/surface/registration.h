// Registration: the rigid motion that lays one surface onto another.
#pragma once

#include <array>
#include <cstddef>

#include "burnish/core/progress.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// p -> R p + t with a proper rotation: nothing is mirrored or scaled.
struct RigidMotion {
  std::array<Vec3, 3> rows{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  // of R
  Vec3 translation;

  Vec3 operator()(const Vec3& p) const { return rotated(p) + translation; }
  Vec3 rotated(const Vec3& v) const { return {dot(rows[0], v), dot(rows[1], v), dot(rows[2], v)}; }
  RigidMotion inverse() const;
  double angle() const;  // of the rotation, in radians from 0 to pi
  Vec3 axis() const;     // of length 1, by the right-hand rule; z without rotation
};

// `inner` first.
RigidMotion operator*(const RigidMotion& outer, const RigidMotion& inner);

struct Registration {
  RigidMotion motion;
  double rms_before = 0, rms_after = 0;  // of distances from samples of the moved surface to the other, in model units
  double rms_kept = 0;                   // after, of the samples that counted
  double kept = 0;                       // their share, 0 to 1: the others have no counterpart
  std::size_t samples = 0;
  std::size_t starts = 0;      // positions from which it was tried
  std::size_t iterations = 0;  // of the best one's last stage
  bool converged = false;      // at a minimum of the squared distances of the samples kept, rms_kept less than 1 % of the size
  int free_motions = 0;        // of 6 that the surfaces do not determine: 3 of planes and spheres, 1 of cones, 2 of cylinders
};

// Moves `a` onto `b` by iterated closest points: distances along the normals of the closest facets (point to plane, Chen & Medioni 1992)
// of samples that are no more than 3 robust standard deviations away (trimmed). It begins where the surfaces are; if they do not fit from
// there, at all 24 ways to lay principal axes onto each other, then at positions between. What has less area is moved, and the motion turned round.
// Identical surfaces: to 1e-9 of the diagonal. Needs half of the smaller surface to be on the other one. Symmetric shapes: the first of the
// best positions. With noise: as good as least squares. Surfaces without area: no motion, six free.
// Cost: 10 000 samples, 1 to 2 us each an iteration; 24 to 96 starts of 300. Same bits for any number of threads. [T-ALIGN-1]
Registration register_rigidly(const TriangleSoup& a, const TriangleSoup& b, Progress& progress = no_progress());

}  // namespace burnish
