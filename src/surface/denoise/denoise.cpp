#include "burnish/surface/denoise.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "burnish/core/parallel.h"
#include "facet_mesh.h"
#include "facet_normals.h"
#include "point_update.h"
#include "polynomial_normals.h"
#include "tune.h"
#include "volume_lock.h"

namespace burnish {
namespace {
using namespace denoising;

double inflation(double corr) {
  const double c = std::clamp(corr, 0.0, 0.5);
  return std::sqrt(1 + 6 * c / ((1 - c) * (1 - c)));
}

std::vector<float> trust_in_points(const FacetMesh& mesh, const FacetGeometry& g, const std::vector<Vec3>& points, const std::vector<Vec3>& home, double sigma) {
  const std::vector<Vec3> normals = point_normals(mesh, g.normal, g.area);
  std::vector<float> trust(points.size(), 1);
  const double limit = tune("PB", 2.5) * sigma;
  parallel_for(points.size(), [&](std::size_t p) {
    const double r = dot(points[p] - home[p], normals[p]) / limit, r2 = r * r, q = 1 + (tune("PW", 0) == 0 ? r2 : r2 * r2);
    trust[p] = static_cast<float>(1 / (q * q));
  });
  return trust;
}

// Moran's I of how far points moved along their normals.
double morans_i(const FacetMesh& mesh, const FacetGeometry& g, const std::vector<Vec3>& points, const std::vector<Vec3>& home, double* med) {
  const std::vector<Vec3> normals = point_normals(mesh, g.normal, g.area);
  double sum = 0, cross = 0;
  std::size_t n = 0, m = 0;
  std::vector<double> r(points.size());
  for (std::size_t p = 0; p < points.size(); ++p) r[p] = dot(points[p] - home[p], normals[p]), sum += r[p] * r[p], ++n;
  std::vector<double> pr;
  for (std::size_t f = 0; f < mesh.facets.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) {
      const double c = r[mesh.facets[f][i]] * r[mesh.facets[f][(i + 1) % 3]];
      cross += c, ++m;
      pr.push_back(std::clamp(c, -.5 * sum / double(n), .5 * sum / double(n)));
    }
  *med = 0;
  for (double v : pr) *med += v / double(m) / (sum / double(n));
  return cross / double(m) / (sum / double(n));
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
    const int n = static_cast<int>(tune("GN", 50));
    for (int i = 0; i < n; ++i) {
      normals = guided_normals(mesh, geometry, tune("GR", .45));
      update_points(mesh, normals, oriented.points, {static_cast<int>(tune("GU", 10)), tune("GA", 0)}, points);
      geometry.update(mesh, points);
      double med = 0;
      const double ratio = rms_along_normals(mesh, geometry, points, oriented.points) / mean_edge(mesh, points);
      const double corr = std::max(0.0, morans_i(mesh, geometry, points, oriented.points, &med));
      if (i + 1 >= tune("GC", 25) * ratio * inflation(corr)) break;
    }
  } else {
    normals = bilateral_normals(mesh, geometry, tune("BR", .45), static_cast<int>(tune("BN", 5)));
    update_points(mesh, normals, oriented.points, {static_cast<int>(tune("BU", 30)), tune("GA", 0)}, points);
    geometry.update(mesh, points);
  }
  const double sigma = tune("SIGMA", 1) * rms_along_normals(mesh, geometry, points, oriented.points);
  result.noise.sigma = sigma;
  result.noise.mean_edge = mean_edge(mesh, points);
  result.noise.correlation = morans_i(mesh, geometry, points, oriented.points, &result.noise.outlier_share);
  const int passes = static_cast<int>(tune("LP", 1));
  for (int i = 0; i < passes; ++i) {
    const LocalPolynomials fits = local_polynomials(mesh, tune("LN", 0) == 0 ? normals : geometry.normal, points, oriented.points, {sigma, inflation(result.noise.correlation), 0, trust_in_points(mesh, geometry, points, oriented.points, sigma)});
    normals = fits.normal;
    if (const char* out = std::getenv("DUMP")) {
      std::FILE* file = std::fopen(out, "wb");
      for (std::size_t f = 0; f < normals.size(); ++f) {
        const double row[8] = {normals[f].x, normals[f].y, normals[f].z, fits.foot[f].x, fits.foot[f].y, fits.foot[f].z, fits.radius[f] / result.noise.mean_edge, fits.slope_error[f]};
        std::fwrite(row, 8, 8, file);
      }
      std::fclose(file);
    }
    points = tune("RESTART", 0) == 1 ? oriented.points : points;
    update_points(mesh, normals, oriented.points, {static_cast<int>(tune("LU", 40)), tune("LA", .002), tune("LF", 0) > 0 ? &fits.foot : nullptr, tune("LF", 0)}, points);
    geometry.update(mesh, points);
  }
  lock_volume(mesh, oriented.points, point_normals(mesh, geometry.normal, geometry.area), 0.5 * result.noise.mean_edge, points);
  result.noise.crease_share = morans_i(mesh, geometry, points, oriented.points, &result.rms_moved);
  return result;
}

}  // namespace burnish
