#include "burnish/surface/denoise.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"
#include "facet_mesh.h"
#include "facet_normals.h"
#include "point_update.h"
#include "polynomial_normals.h"
#include "tune.h"

namespace burnish {
namespace {
using namespace denoising;

std::vector<float> trust_in_points(const FacetMesh& mesh, const FacetGeometry& g, const std::vector<Vec3>& points, const std::vector<Vec3>& home, double sigma) {
  const std::vector<Vec3> normals = point_normals(mesh, g.normal, g.area);
  std::vector<float> trust(points.size(), 1);
  const double limit = tune("PB", 2.5) * sigma;
  parallel_for(points.size(), [&](std::size_t p) {
    const double r = dot(points[p] - home[p], normals[p]) / limit;
    trust[p] = static_cast<float>(1 / ((1 + r * r) * (1 + r * r)));
  });
  return trust;
}

// How far points moved along the normals they have now.
double rms_along_normals(const FacetMesh& mesh, const FacetGeometry& g, const std::vector<Vec3>& points, const std::vector<Vec3>& home) {
  const std::vector<Vec3> normals = point_normals(mesh, g.normal, g.area);
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t p = 0; p < points.size(); ++p) {
    const double d = dot(points[p] - home[p], normals[p]);
    sum += d * d;
    ++count;
  }
  return count == 0 ? 0 : std::sqrt(sum / static_cast<double>(count));
}

}  // namespace

DenoiseResult denoise(const TriangleSoup& oriented, const DenoiseOptions& options, Progress& progress) {
  static_cast<void>(options);
  progress.check();
  DenoiseResult result;
  result.soup = oriented;
  result.noise = estimate_noise(oriented);
  const FacetMesh mesh(oriented);
  FacetGeometry geometry(mesh, oriented.points);
  std::vector<Vec3>& points = result.soup.points;
  std::vector<Vec3> normals;
  if (tune("FIRST", 0) == 0) {
    const int n = static_cast<int>(tune("GN", 10));
    for (int i = 0; i < n; ++i) {
      normals = guided_normals(mesh, geometry, tune("GR", .35));
      update_points(mesh, normals, oriented.points, {static_cast<int>(tune("GU", 10)), tune("GA", 0)}, points);
      geometry.update(mesh, points);
    }
  } else {
    normals = bilateral_normals(mesh, geometry, tune("BR", .45), static_cast<int>(tune("BN", 5)));
    update_points(mesh, normals, oriented.points, {static_cast<int>(tune("BU", 30)), tune("GA", 0)}, points);
    geometry.update(mesh, points);
  }
  const double sigma = tune("SIGMA", 1) * rms_along_normals(mesh, geometry, points, oriented.points);
  result.noise.sigma = sigma;
  result.noise.mean_edge = mean_edge(mesh, points);
  const int passes = static_cast<int>(tune("LP", 1));
  for (int i = 0; i < passes; ++i) {
    const LocalPolynomials fits = local_polynomials(mesh, tune("LN", 0) == 0 ? normals : geometry.normal, points, oriented.points, {sigma, 0, trust_in_points(mesh, geometry, points, oriented.points, sigma)});
    normals = fits.normal;
    points = tune("RESTART", 0) == 1 ? oriented.points : points;
    update_points(mesh, normals, oriented.points, {static_cast<int>(tune("LU", 40)), tune("LA", .002)}, points);
    geometry.update(mesh, points);
  }
  return result;
}

}  // namespace burnish
