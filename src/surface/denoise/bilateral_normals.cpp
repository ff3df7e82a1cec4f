#include "bilateral_normals.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

// Of the filter, as a difference of unit normals: below what creases have. The first passes take in what the noise does to normals.
constexpr double kSpread = 0.35, kSpreadOfNoise = 2.25;
constexpr int kFirstPasses = 5, kLastPasses = 10;

using Across = std::vector<std::array<std::uint32_t, 3>>;

// The facet across each side, where there is exactly one.
Across facets_across(const TriangleSoup& soup, const EdgeTable& edges) {
  Across across(soup.facets.size(), {kNoFacet, kNoFacet, kNoFacet});
  parallel_for(edges.size(), [&](std::size_t e) {
    const auto u = edges.uses(e);
    if (u.size() != 2) return;
    across[u[0].facet][u[0].side] = u[1].facet;
    across[u[1].facet][u[1].side] = u[0].facet;
  });
  return across;
}

// A bilateral filter over the sides of facets. [T-NOISE-6]
void filter(const Across& across, double spread, int passes, FacetNormals& n) {
  std::vector<Vec3> filtered(n.unit.size());
  const double scale = -0.5 / (spread * spread);
  for (int pass = 0; pass < passes; ++pass) {
    parallel_for(n.unit.size(), [&](std::size_t f) {
      Vec3 sum = n.unit[f] * n.area[f];
      for (const std::uint32_t g : across[f])
        if (g != kNoFacet) sum += n.unit[g] * (n.area[g] * std::exp(scale * squared_norm(n.unit[f] - n.unit[g])));
      const double length = norm(sum);
      filtered[f] = length > 0 ? sum / length : n.unit[f];
    });
    n.unit.swap(filtered);
  }
}

// Of about 20,000 facets.
double tilt_of_noise(const TriangleSoup& soup, const FacetNormals& n, double sigma) {
  if (!(sigma > 0)) return 0;
  const std::size_t step = 1 + soup.facets.size() / 20000;
  std::vector<double> altitudes;
  for (std::size_t f = 0; f < soup.facets.size(); f += step) altitudes.push_back(altitude(soup, n, static_cast<std::uint32_t>(f)));
  if (altitudes.empty()) return 0;
  const auto middle = altitudes.begin() + static_cast<std::ptrdiff_t>(altitudes.size() / 2);
  std::nth_element(altitudes.begin(), middle, altitudes.end());
  return *middle > 0 ? 0.5 * std::numbers::sqrt3 * sigma / *middle : 0;
}

}  // namespace

double altitude(const TriangleSoup& soup, const FacetNormals& n, std::uint32_t f) {
  double longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, norm(soup.corner(f, (i + 1) % 3) - soup.corner(f, i)));
  return longest > 0 ? n.area[f] / longest : 0;
}

double filter_normals(const TriangleSoup& soup, const EdgeTable& edges, double sigma, int clean_passes, FacetNormals& normals) {
  const Across across = facets_across(soup, edges);
  const double strength = tilt_of_noise(soup, normals, sigma);
  if (strength > 0) filter(across, std::max(kSpread, kSpreadOfNoise * strength), kFirstPasses, normals);
  filter(across, kSpread, strength > 0 ? kLastPasses : clean_passes, normals);
  return strength;
}

}  // namespace burnish
