// Moving points until the facets have the normals that a filter gave them.
#pragma once

#include <vector>

#include "facet_mesh.h"

namespace burnish::denoising {

struct PointUpdate {
  int iterations = 10;
  double anchor = 0;  // the share of the way back to `home` in each iteration
  const std::vector<Vec3>* feet = nullptr;
  double pull = 0;
};

// Sun et al. 2007: each point moves by the mean over its facets of the way to the plane through the facet's centroid with the facet's target
// normal. Monotone in the sum of squared distances to these planes. [T-DENOISE-4]
void update_points(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& home, const PointUpdate& how,
                   std::vector<Vec3>& points);

}  // namespace burnish::denoising
