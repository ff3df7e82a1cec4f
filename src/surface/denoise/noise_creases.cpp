#include "noise_creases.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "bilateral_normals.h"
#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr double kCreaseAngle = std::numbers::pi / 6;
constexpr int kCleanPasses = 2;
constexpr double kAngleLeft = 0.21;  // what the filter leaves of the noise, times the tilt: half of the hinges have less than half of it

struct Bending {
  double all = 0, creases = 0;
  std::size_t edges = 0, crease_edges = 0;
};

Bending bending_of(const TriangleSoup& soup, const EdgeTable& edges, const FacetNormals& n, double sigma, double floor) {
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
  FacetNormals normals = facet_normals(soup);
  const double strength = filter_normals(soup, edges, estimate.sigma, kCleanPasses, normals);
  const Bending bending = bending_of(soup, edges, normals, estimate.sigma, kAngleLeft * strength);
  if (bending.edges > 0) estimate.crease_share = static_cast<double>(bending.crease_edges) / static_cast<double>(bending.edges);
  if (bending.all > 0) estimate.crease_bending = bending.creases / bending.all;
}

}  // namespace burnish
