// Angles of single facets, where burnish::facet_shapes has those of all together.
#pragma once

#include <algorithm>
#include <cstddef>

#include "burnish/surface/compare.h"

namespace burnish::test {

// The least angle of a facet, in degrees.
inline double least_angle(const TriangleSoup& soup, std::size_t f) {
  double least = 180;
  for (int i = 0; i < 3; ++i) {
    const Vec3& at = soup.corner(f, i);
    least = std::min(least, angle_in_degrees(soup.corner(f, (i + 1) % 3) - at, soup.corner(f, (i + 2) % 3) - at));
  }
  return least;
}

}  // namespace burnish::test
