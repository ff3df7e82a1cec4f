#include "noise_creases.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr double kCreaseAngle = std::numbers::pi / 6;
// Of the filter, as a difference of unit normals: below what creases have. The first passes take in what the noise does to normals.
constexpr double kSpread = 0.35, kSpreadOfNoise = 2.25;
constexpr int kFirstPasses = 5, kLastPasses = 10, kCleanPasses = 2;
constexpr double kAngleLeft = 0.21;  // what the filter leaves of the noise, times the tilt: half of the hinges have less than half of it

using Across = std::vector<std::array<std::uint32_t, 3>>;

struct Normals {
  std::vector<Vec3> unit;
  std::vector<double> area;
};

struct Bending {
  double all = 0, creases = 0;
  std::size_t edges = 0, crease_edges = 0;
};

Normals normals_of(const TriangleSoup& soup) {
  Normals n{std::vector<Vec3>(soup.facets.size()), std::vector<double>(soup.facets.size())};
  parallel_for(soup.facets.size(), [&](std::size_t f) {
    const Vec3 normal = facet_normal_2a(soup, f);
    n.area[f] = norm(normal);
    if (n.area[f] > 0) n.unit[f] = normal / n.area[f];
  });
  return n;
}

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
void filter_normals(const Across& across, double spread, int passes, Normals& n) {
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

double altitude(const TriangleSoup& soup, const Normals& n, std::uint32_t f) {
  double longest = 0;
  for (int i = 0; i < 3; ++i) longest = std::max(longest, norm(soup.corner(f, (i + 1) % 3) - soup.corner(f, i)));
  return longest > 0 ? n.area[f] / longest : 0;
}

// sigma in edges of the equilateral triangle that is as high as the median facet: what noise does to normals. Of about 20,000 facets.
double tilt_of_noise(const TriangleSoup& soup, const Normals& n, double sigma) {
  if (!(sigma > 0)) return 0;
  const std::size_t step = 1 + soup.facets.size() / 20000;
  std::vector<double> altitudes;
  for (std::size_t f = 0; f < soup.facets.size(); f += step) altitudes.push_back(altitude(soup, n, static_cast<std::uint32_t>(f)));
  const auto middle = altitudes.begin() + static_cast<std::ptrdiff_t>(altitudes.size() / 2);
  std::nth_element(altitudes.begin(), middle, altitudes.end());
  return *middle > 0 ? 0.5 * std::numbers::sqrt3 * sigma / *middle : 0;
}

Bending bending_of(const TriangleSoup& soup, const EdgeTable& edges, const Normals& n, double sigma, double floor) {
  const auto range = [&](std::size_t begin, std::size_t end) {
    Bending part;
    for (std::size_t e = begin; e < end; ++e) {
      const auto u = edges.uses(e);
      if (u.size() != 2) continue;
      // What is thinner than the noise may have been folded by it.
      if (sigma > 0 && std::min(altitude(soup, n, u[0].facet), altitude(soup, n, u[1].facet)) < sigma) continue;
      const double angle = 2 * std::asin(std::min(1.0, 0.5 * norm(n.unit[u[0].facet] - n.unit[u[1].facet])));
      const double length = norm(soup.points[edges.edge(e)[1]] - soup.points[edges.edge(e)[0]]);
      const double bend = std::sqrt(std::max(0.0, angle * angle - floor * floor)) * length;
      const bool crease = angle > kCreaseAngle;
      part.all += bend;
      part.creases += crease ? bend : 0;
      ++part.edges;
      part.crease_edges += crease ? 1 : 0;
    }
    return part;
  };
  return parallel_reduce(edges.size(), 16384, Bending{}, range, [](Bending a, const Bending& b) {
    return Bending{a.all + b.all, a.creases + b.creases, a.edges + b.edges, a.crease_edges + b.crease_edges};
  });
}

}  // namespace

void set_creases(const TriangleSoup& soup, const EdgeTable& edges, NoiseEstimate& estimate) {
  Normals normals = normals_of(soup);
  const Across across = facets_across(soup, edges);
  const double strength = tilt_of_noise(soup, normals, estimate.sigma);
  if (strength > 0) filter_normals(across, std::max(kSpread, kSpreadOfNoise * strength), kFirstPasses, normals);
  filter_normals(across, kSpread, strength > 0 ? kLastPasses : kCleanPasses, normals);
  const Bending bending = bending_of(soup, edges, normals, estimate.sigma, kAngleLeft * strength);
  if (bending.edges > 0) estimate.crease_share = static_cast<double>(bending.crease_edges) / static_cast<double>(bending.edges);
  if (bending.all > 0) estimate.crease_bending = bending.creases / bending.all;
}

}  // namespace burnish
