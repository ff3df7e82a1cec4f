// Normals from polynomials fitted to the noisy points around each facet, at the scale that suits each place.
#pragma once

#include <vector>

#include "facet_mesh.h"

namespace burnish::denoising {

struct PolynomialOptions {
  double sigma = 0;              // of the points along the normals, model units
  double correlation = 1;        // by how much the errors of means exceed those for independent noise
  double least_radius = 0;       // of a fit, model units
  std::vector<float> trust;      // of each point, 0 to 1: the weight that its height has in fits
};

struct LocalPolynomials {
  std::vector<Vec3> normal;         // of the fit, above the facet's centroid
  std::vector<Vec3> foot;           // of the fit, above the facet's centroid
  std::vector<float> slope_error;   // standard deviation of the normal, radians
  std::vector<float> radius;        // 0: nothing could be fitted, and normal and foot are those given
};

// Per facet, planes and paraboloids in discs of growing radius are fitted by weighted least squares to `noisy` points, seen from the normals and
// positions of a first filter; of these fits the one with the least variance is taken that agrees with all fits at finer scales (Lepski 1991). [T-DENOISE-3]
LocalPolynomials local_polynomials(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& points,
                                   const std::vector<Vec3>& noisy, const PolynomialOptions& options);

}  // namespace burnish::denoising
