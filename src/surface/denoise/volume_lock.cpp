#include "volume_lock.h"

#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish::denoising {
namespace {

double add(double a, double b) { return a + b; }

// The volume's derivative, times six, for moving every point along its direction.
double slope_of_six_volumes(const FacetMesh& mesh, const std::vector<Vec3>& points, const std::vector<Vec3>& directions) {
  return parallel_reduce(mesh.facets.size(), kDefaultGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double part = 0;
    for (std::size_t f = begin; f < end; ++f) {
      const Facet& t = mesh.facets[f];
      const Vec3 twice = cross(points[t[1]] - points[t[0]], points[t[2]] - points[t[0]]);
      part += dot(twice, directions[t[0]] + directions[t[1]] + directions[t[2]]);
    }
    return part;
  }, add);
}

}  // namespace

double six_volumes(const FacetMesh& mesh, const std::vector<Vec3>& points, const Vec3& origin) {
  return parallel_reduce(mesh.facets.size(), kDefaultGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double part = 0;
    for (std::size_t f = begin; f < end; ++f) {
      const Facet& t = mesh.facets[f];
      part += dot(points[t[0]] - origin, cross(points[t[1]] - origin, points[t[2]] - origin));
    }
    return part;
  }, add);
}

double lock_volume(const FacetMesh& mesh, const std::vector<Vec3>& home, const std::vector<Vec3>& directions, double longest, std::vector<Vec3>& points) {
  if (!mesh.closed) return 0;
  Box3 box;
  for (const Vec3& p : home) box.extend(p);
  const Vec3 origin = box.center();
  const double wanted = six_volumes(mesh, home, origin);
  std::vector<Vec3> moved = points;
  double step = 0;
  for (int i = 0; i < 5; ++i) {
    const double missing = wanted - six_volumes(mesh, moved, origin), slope = slope_of_six_volumes(mesh, moved, directions);
    if (std::abs(missing) <= 1e-9 * std::abs(wanted)) break;
    if (!(std::abs(missing) <= longest * std::abs(slope))) return 0;
    step += missing / slope;
    if (std::abs(step) > longest) return 0;
    parallel_for(points.size(), [&](std::size_t p) { moved[p] = points[p] + directions[p] * step; });
  }
  points.swap(moved);
  return step;
}

}  // namespace burnish::denoising
