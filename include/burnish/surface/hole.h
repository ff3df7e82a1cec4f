// An opening of a surface: one loop of open edges.
#pragma once

#include <cstddef>
#include <numbers>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish {

struct Hole {
  Vec3 position;          // centroid of the loop's edges
  std::size_t edges = 0;
  double perimeter = 0;   // model units
  double area = 0;        // of what fills it, or of the projection along its vector area where nothing does
  bool filled = false;

  // The diameter of the circle with that perimeter: what a limit on the size of holes is compared with.
  double width() const { return perimeter / std::numbers::pi; }
};

// Measures the closed polygon through these points, `filled` left false.
Hole measure_hole(const std::vector<Vec3>& loop);

}  // namespace burnish
