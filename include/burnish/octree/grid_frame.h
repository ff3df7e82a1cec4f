// GridFrame: where the lattice lies in the model.
#pragma once

#include "burnish/core/vec.h"
#include "burnish/octree/field.h"

namespace burnish {

// The map between model coordinates and lattice coordinates (units of the finest cell).
//
// Everything behind the pipeline's door works in lattice coordinates, so multiplying the model by a power
// of two changes no bit there and scales the result bit for bit.
struct GridFrame {
  Vec3 origin;      // model coordinates of lattice node (0, 0, 0)
  double cell = 1;  // side of the finest cell in model units
  int depth = 0;    // 2^depth finest blocks along each side of the domain

  Vec3 to_lattice(const Vec3& p) const { return (p - origin) / cell; }  // [T-CONV-2]
  Vec3 to_model(const Vec3& q) const { return origin + q * cell; }
  // Lattice nodes along a side.
  double lattice_side() const { return static_cast<double>(kBlockSide) * static_cast<double>(1u << depth); }
};

// The smallest frame whose domain holds `box` with at least `margin` cells around it. The origin is
// offset by an irrational part of a cell per axis (numerics: an axis-aligned facet must not lie on nodes).
// Throws Error{memory_limit} if the domain would need more than 2^20 blocks a side.
GridFrame make_frame(const Box3& box, double cell, double margin);

}  // namespace burnish
