// Noise and impulses of known size, for what estimates and removes them.
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>
#include <vector>

#include "burnish/surface/triangle_soup.h"
#include "support/damage.h"

namespace burnish::test {

// Unit, area-weighted.
inline std::vector<Vec3> point_normals(const TriangleSoup& soup) {
  std::vector<Vec3> normals(soup.points.size());
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) normals[p] += facet_normal_2a(soup, f);
  for (Vec3& n : normals)
    if (norm(n) > 0) n = n / norm(n);
  return normals;
}

inline double gaussian(Random& random) {
  const double u = 1 - random.uniform(0, 1), v = random.uniform(0, 1);
  return std::sqrt(-2 * std::log(u)) * std::cos(2 * std::numbers::pi * v);
}

// Each point moved along its normal, by a normal distribution with a standard deviation of `edges` mean edges.
inline TriangleSoup with_noise(TriangleSoup soup, double edges, std::uint64_t seed) {
  const std::vector<Vec3> normals = point_normals(soup);
  const double sigma = edges * mean_edge_length(soup);
  Random random(seed);
  for (std::size_t p = 0; p < soup.points.size(); ++p) soup.points[p] += normals[p] * (sigma * gaussian(random));
  return soup;
}

}  // namespace burnish::test
