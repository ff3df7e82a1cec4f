// Normals from polynomials fitted to the noisy points around each facet, at the scale that suits each place.
#pragma once

#include <vector>

#include "burnish/core/progress.h"
#include "facet_mesh.h"

namespace burnish::denoising {

struct PolynomialOptions {
  double sigma = 0;              // of the points along the normals, model units
  double correlation = 1;        // by how much the errors of means exceed those of independent noise
  double least_radius = 0;       // of a fit, model units
  double range = 0.3;            // points count whose normals differ by less: standard deviation of their weight, radians
  std::vector<float> trust;      // of each point, 0 to 1: the weight that its height has in fits
};

struct LocalPolynomials {
  std::vector<Vec3> normal;         // what fits say about the facet's centroid; the normal given where there are none
  std::vector<Vec3> foot;           // where they pass it; the centroid where there are none
};

// Around each facet, planes and paraboloids in discs of growing radius are fitted by weighted least squares to the heights of `noisy` points, seen from the
// normals and positions (`points`) of a first filter. Of these fits the one with the least variance is taken that agrees with all finer ones. [T-DENOISE-3] [T-DENOISE-4]
// Facets then take the mean of what the fits of their two rings say. [T-DENOISE-5]  Throws Error{interrupted}.
LocalPolynomials local_polynomials(const FacetMesh& mesh, const std::vector<Vec3>& normals, const std::vector<Vec3>& points,
                                   const std::vector<Vec3>& noisy, const PolynomialOptions& options, Progress& progress);

}  // namespace burnish::denoising
