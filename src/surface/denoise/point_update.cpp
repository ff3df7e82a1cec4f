#include "point_update.h"

#include "burnish/core/parallel.h"

namespace burnish::denoising {

void update_points(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& home, const PointUpdate& how,
                   std::vector<Vec3>& points) {
  std::vector<Vec3> next(points.size()), centroid(mesh.facets.size());
  for (int i = 0; i < how.iterations; ++i) {
    parallel_for(mesh.facets.size(), [&](std::size_t f) {
      centroid[f] = (points[mesh.facets[f][0]] + points[mesh.facets[f][1]] + points[mesh.facets[f][2]]) / 3.0;
      if (how.feet) centroid[f] += normals[f] * (how.pull * dot(normals[f], (*how.feet)[f] - centroid[f]));
    });
    parallel_for(points.size(), [&](std::size_t p) {
      const auto around = mesh.facets_of_point[p];
      next[p] = points[p];
      if (around.empty()) return;
      Vec3 step;
      for (const std::uint32_t f : around) step += normals[f] * dot(normals[f], centroid[f] - points[p]);
      next[p] += step / static_cast<double>(around.size()) + (home[p] - points[p]) * how.anchor;
    });
    points.swap(next);
  }
}

}  // namespace burnish::denoising
