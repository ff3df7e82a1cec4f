#include "facet_normals.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish::denoising {
namespace {

// The mean distance between centroids of facets that share an edge.
double mean_centroid_distance(const FacetMesh& mesh, const FacetGeometry& geometry) {
  struct Sum {
    double length = 0;
    std::size_t count = 0;
  };
  const Sum sum = parallel_reduce(mesh.facets.size(), kDefaultGrain, Sum{}, [&](std::size_t begin, std::size_t end) {
    Sum part;
    for (std::size_t f = begin; f < end; ++f)
      for (const std::uint32_t g : mesh.across[f])
        if (g != kNoFacet) part = {part.length + norm(geometry.centroid[g] - geometry.centroid[f]), part.count + 1};
    return part;
  }, [](const Sum& a, const Sum& b) { return Sum{a.length + b.length, a.count + b.count}; });
  return sum.count == 0 ? 0 : sum.length / static_cast<double>(sum.count);
}

// How inconsistent the normals of a facet's patch are: their largest difference, times the share of the largest jump in all jumps
// across edges at the facet's points. A patch across a crease has both, a noisy flat one spreads its jumps.
double inconsistency(const FacetMesh& mesh, const std::vector<Vec3>& normal, std::size_t f) {
  const auto ring = mesh.ring[f];
  double spread = 0;
  for (std::size_t i = 0; i < ring.size(); ++i) {
    spread = std::max(spread, squared_norm(normal[ring[i]] - normal[f]));
    for (std::size_t j = i + 1; j < ring.size(); ++j) spread = std::max(spread, squared_norm(normal[ring[i]] - normal[ring[j]]));
  }
  const Facet& own = mesh.facets[f];
  const auto of_own = [&](std::uint32_t p) { return p == own[0] || p == own[1] || p == own[2]; };
  double largest = 0, sum = 0;
  for (const std::uint32_t g : ring)
    for (std::size_t side = 0; side < 3; ++side) {
      const std::uint32_t other = mesh.across[g][side];
      if (other == kNoFacet || (other < g && other != f)) continue;
      if (!of_own(mesh.facets[g][side]) && !of_own(mesh.facets[g][(side + 1) % 3])) continue;
      const double jump = norm(normal[g] - normal[other]);
      largest = std::max(largest, jump);
      sum += jump;
    }
  return std::sqrt(spread) * largest / (sum + 1e-9);
}

std::vector<Vec3> guides(const FacetMesh& mesh, const FacetGeometry& geometry) {
  const std::size_t count = mesh.facets.size();
  std::vector<double> badness(count);
  std::vector<Vec3> mean(count), guide(count);
  parallel_for(count, [&](std::size_t f) {
    badness[f] = inconsistency(mesh, geometry.normal, f);
    Vec3 sum = geometry.normal[f] * geometry.area[f];
    for (const std::uint32_t g : mesh.ring[f]) sum += geometry.normal[g] * geometry.area[g];
    mean[f] = unit_or(sum, geometry.normal[f]);
  });
  parallel_for(count, [&](std::size_t f) {
    std::size_t best = f;
    for (const std::uint32_t g : mesh.ring[f])
      if (badness[g] < badness[best]) best = g;
    guide[f] = mean[best];
  });
  return guide;
}

// Means of normals over neighbours, weighted by area, distance and the likeness of `guide`.
std::vector<Vec3> joint_bilateral(const FacetMesh& mesh, const FacetGeometry& geometry, const std::vector<Vec3>& guide, double range) {
  const std::vector<Vec3>& normal = geometry.normal;
  const double distance = mean_centroid_distance(mesh, geometry);
  std::vector<Vec3> filtered(mesh.facets.size());
  const double per_range = -0.5 / (range * range), per_distance = -0.5 / (distance * distance), reach = 4 * distance * distance;
  parallel_for(mesh.facets.size(), [&](std::size_t f) {
    Vec3 sum = normal[f] * geometry.area[f];
    for (const std::uint32_t g : mesh.two_rings[f]) {
      const double d = squared_norm(geometry.centroid[g] - geometry.centroid[f]);
      if (d > reach) continue;
      sum += normal[g] * (geometry.area[g] * std::exp(per_distance * d + per_range * squared_norm(guide[g] - guide[f])));
    }
    filtered[f] = unit_or(sum, normal[f]);
  });
  return filtered;
}

}  // namespace

std::vector<Vec3> guided_normals(const FacetMesh& mesh, const FacetGeometry& geometry, double range) {
  return joint_bilateral(mesh, geometry, guides(mesh, geometry), range);
}

}  // namespace burnish::denoising
