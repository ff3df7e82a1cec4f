// Moving points until the facets have the normals that a filter gave them.
#pragma once

#include <vector>

#include "facet_mesh.h"

namespace burnish::denoising {

struct PointUpdate {
  int iterations = 10;
  double anchor = 0;                        // the share of the way back to `home` in each iteration
  const std::vector<Vec3>* feet = nullptr;  // points of the facets' planes, if known
  double pull = 0;                          // the share of the way to them in each iteration
};

// Sun et al. 2007: each point moves by the mean over its facets of the way to the plane through the facet's centroid with the facet's target
// normal; with `feet`, the plane is that much closer to the foot. Steps are sums of facets' normals, so that rims stay. `mobility` scales steps, and 0 leaves a point's bits alone; empty: 1 everywhere. [T-DENOISE-2] [T-DENOISE-6]
void update_points(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& home, const std::vector<float>& mobility,
                   const PointUpdate& how, std::vector<Vec3>& points);

}  // namespace burnish::denoising
