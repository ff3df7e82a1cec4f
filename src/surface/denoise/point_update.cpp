#include "point_update.h"

#include "burnish/core/parallel.h"

namespace burnish::denoising {
namespace {

// The middle of a facet's target plane: its centroid, pulled towards the foot.
Vec3 middle_of(const Facet& facet, const std::vector<Vec3>& points, const Vec3& normal, const Vec3* foot, double pull) {
  const Vec3 centroid = (points[facet[0]] + points[facet[1]] + points[facet[2]]) / 3.0;
  return foot == nullptr ? centroid : centroid + normal * (pull * dot(normal, *foot - centroid));
}

}  // namespace

void update_points(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& home, const std::vector<float>& mobility,
                   const PointUpdate& how, std::vector<Vec3>& points) {
  std::vector<Vec3> next(points.size()), middle(mesh.facets.size());
  const auto step_of = [&](std::size_t p) {
    Vec3 sum;
    for (const std::uint32_t f : mesh.facets_of_point[p]) sum += normals[f] * dot(normals[f], middle[f] - points[p]);
    return sum / static_cast<double>(mesh.facets_of_point[p].size()) + (home[p] - points[p]) * how.anchor;
  };
  for (int i = 0; i < how.iterations; ++i) {
    parallel_for(mesh.facets.size(), [&](std::size_t f) {
      middle[f] = middle_of(mesh.facets[f], points, normals[f], how.feet == nullptr ? nullptr : &(*how.feet)[f], how.pull);
    });
    parallel_for(points.size(), [&](std::size_t p) {
      next[p] = points[p];
      if (mesh.facets_of_point[p].empty()) return;
      if (mobility.empty()) next[p] += step_of(p);
      else if (mobility[p] > 0) next[p] += step_of(p) * static_cast<double>(mobility[p]);
    });
    points.swap(next);
  }
}

}  // namespace burnish::denoising
