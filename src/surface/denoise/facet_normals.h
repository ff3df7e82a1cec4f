// Filters of facet normals: the first step of denoising, which tells creases from noise.
#pragma once

#include <vector>

#include "facet_mesh.h"

namespace burnish::denoising {

// One step of guided normal filtering (Zhang et al. 2015). A facet's guide is the mean normal of the most consistent one-ring patch that
// holds it; a normal becomes the mean of its neighbours', weighted by area, distance and the likeness of guides. [T-DENOISE-1]
std::vector<Vec3> guided_normals(const FacetMesh& mesh, const FacetGeometry& geometry, double range);

}  // namespace burnish::denoising
