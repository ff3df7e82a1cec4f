// Regions of space, as a text file lists them.
#pragma once

#include <string>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish {

struct Ball {
  Vec3 center;
  double radius = 0;
};

// The union of its boxes and balls.
struct RegionShapes {
  std::vector<Box3> boxes;
  std::vector<Ball> balls;
};

// Reads a text file with one shape a line, in model units:
//
//   box X0 Y0 Z0 X1 Y1 Z1      two opposite corners, in any order
//   sphere X Y Z R             centre and radius
//
// Empty lines and what follows a # are skipped. Throws Error{unreadable_input} that names the line, and for a file without a shape.
RegionShapes read_region_shapes(const std::string& path);

}  // namespace burnish
