#include "burnish/surface/thickness.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/core/parallel.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {
namespace {

constexpr double kStart = 1e-7;      // of the diagonal: rays begin that far inside
constexpr double kOpposed = -0.5;    // cosine between the normals of the two sides of a wall
constexpr std::size_t kGrain = 64;

double wall_behind(const TriangleSoup& soup, const TriangleIndex& index, std::size_t f, double start) {
  const Vec3 n = facet_normal_2a(soup, f);
  if (!(norm(n) > 0)) return std::numeric_limits<double>::infinity();
  const Vec3 inwards = n / -norm(n);
  const Vec3 origin = (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3.0 + inwards * start;
  const TriangleIndex::Hit hit = index.first_hit(origin, inwards);
  if (hit.facet == kNoFacet) return std::numeric_limits<double>::infinity();
  const Vec3 other = facet_normal_2a(soup, hit.facet);
  const bool wall = dot(other, n) < kOpposed * norm(other) * norm(n);
  return wall ? hit.distance + start : std::numeric_limits<double>::infinity();
}

}  // namespace

std::vector<double> wall_thicknesses(const TriangleSoup& oriented, std::size_t samples) {
  std::vector<double> cumulative(oriented.facets.size() + 1, 0.0);
  for (std::size_t f = 0; f < oriented.facets.size(); ++f) cumulative[f + 1] = cumulative[f] + norm(facet_normal_2a(oriented, f));
  if (!(cumulative.back() > 0)) return {};
  const TriangleIndex index(oriented);
  const double start = kStart * bounding_box(oriented).diagonal();
  std::vector<double> found(samples);
  parallel_for(samples, [&](std::size_t i) {
    const double target = (static_cast<double>(i) + 0.5) / static_cast<double>(samples) * cumulative.back();
    const auto at = std::upper_bound(cumulative.begin(), cumulative.end() - 1, target) - cumulative.begin() - 1;
    found[i] = wall_behind(oriented, index, static_cast<std::size_t>(at), start);
  }, kGrain);
  std::erase_if(found, [](double t) { return !std::isfinite(t); });
  std::sort(found.begin(), found.end());
  return found;
}

}  // namespace burnish
