#include "burnish/surface/hole.h"

namespace burnish {

Hole measure_hole(const std::vector<Vec3>& loop) {
  Hole hole;
  Vec3 moment, vector_area;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &a = loop[i], &b = loop[(i + 1) % loop.size()];
    const double length = norm(b - a);
    hole.perimeter += length;
    moment += (a + b) * (0.5 * length);
    vector_area += cross(a - loop[0], b - loop[0]) * 0.5;
  }
  hole.edges = loop.size();
  hole.position = hole.perimeter > 0 ? moment / hole.perimeter : loop.empty() ? Vec3{} : loop[0];
  hole.area = norm(vector_area);
  return hole;
}

}  // namespace burnish
