// The inner loop of the distance scatter, in a unit of its own that is compiled for several processors.
#pragma once

#include "burnish/core/vec.h"

namespace burnish::detail {

inline constexpr int kRow = 8;

// A triangle prepared for many points: edges with inverse squared lengths, normal with inverse squared length.
struct PreparedTriangle {
  Vec3 a, b, c;
  Vec3 ab, bc, ca;
  double inverse_ab, inverse_bc, inverse_ca;  // 1 / |edge|^2, or 0
  Vec3 n;
  double inverse_n;                           // 1 / |n|^2, or 0 for a triangle without area
  Vec3 n_ab, n_bc, n_ca;                      // inward normals of the edges in the triangle's plane: n x edge
};

PreparedTriangle prepare(const Vec3& a, const Vec3& b, const Vec3& c);

// For the eight points (i, y, z), i = 0..7: where the squared distance to the triangle is below squared[i],
// replaces it and sets id[i] to `facet`. Ids are doubles so that both live in the same vector lanes.
void update_row(const PreparedTriangle& triangle, double facet, double y, double z, double* squared, double* id);

}  // namespace burnish::detail
