// LevelSet: a signed distance field on the octree.
//
// Convention [T-CONV-1] (the thesis', eq. 2.1): phi > 0 inside, phi < 0 outside, phi = 0 on the surface. Values are in
// cells of the finest level, coordinates in lattice units; `frame` maps both to the model.
#pragma once

#include "burnish/octree/field.h"
#include "burnish/octree/grid_frame.h"
#include "burnish/octree/grow.h"

namespace burnish {

template <class T>
struct BasicLevelSet {
  GridFrame frame;
  SurfaceOctree grid;
  Field<T> phi;       // signed distance, in cells
  double band = 0;    // |phi| <= band is exact where it was computed from triangles

  const Octree& octree() const { return grid.octree; }
};

using LevelSet = BasicLevelSet<float>;

}  // namespace burnish
