// Giving a denoised surface its volume back.
#pragma once

#include <vector>

#include "facet_mesh.h"

namespace burnish::denoising {

// Six times the volume that closed facets enclose, taken about `origin`. Same bits for any number of threads.
double six_volumes(const FacetMesh& mesh, const std::vector<Vec3>& points, const Vec3& origin);

// Moves all points along `directions` by the same multiple of them, so that the volume becomes that of `home`: Newton's method on a cubic polynomial,
// until 1e-9 of the volume is left. Returns the multiple; 0, and nothing moved, where the surface is not closed or the step would be longer than
// `longest`. [T-DENOISE-7]
double lock_volume(const FacetMesh& mesh, const std::vector<Vec3>& home, const std::vector<Vec3>& directions, double longest, std::vector<Vec3>& points);

}  // namespace burnish::denoising
