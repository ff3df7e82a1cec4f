#include "burnish/surface/signed_deviation.h"

#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/winding.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 256;

// How far p is in front of facet f's plane; negative behind it, 0 for a facet without area.
double height_over(const TriangleSoup& soup, std::uint32_t f, const Vec3& p) {
  const Vec3 n = facet_normal_2a(soup, f);
  const double length = norm(n);
  return length > 0 ? dot(n, p - soup.corner(f, 0)) / length : 0;
}

bool is_behind_closest_facet(const Vec3& p, const ClosestPoint& closest, const TriangleSoup& soup, const TriangleIndex& index) {
  // As close as the closest facet, up to rounding of the coordinates.
  constexpr double kSlack = 1e-9;
  const double within = closest.squared_distance * (1 + kSlack);
  std::vector<std::uint32_t> facets;
  index.facets_near(p, within, facets);
  double best = height_over(soup, closest.facet, p);
  for (const std::uint32_t f : facets) {
    const double height = height_over(soup, f, p);
    if (std::abs(height) <= std::abs(best)) continue;
    if (squared_norm(closest_point_on_triangle(p, soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2)) - p) <= within) best = height;
  }
  return best < 0;
}

}  // namespace

SideRule side_rule(const TriangleSoup& welded) {
  return is_closed_chain(welded) ? SideRule::winding_number : SideRule::closest_facet;
}

std::vector<double> signed_deviation(const std::vector<Vec3>& points, const TriangleSoup& to, const TriangleIndex& index,
                                     const ClosestQuery& closest, SideRule rule) {
  const bool by_winding = rule == SideRule::winding_number;
  const std::vector<std::int32_t> winding = by_winding ? winding_numbers(to, points) : std::vector<std::int32_t>{};
  std::vector<double> deviation(points.size());
  parallel_for(points.size(), [&](std::size_t i) {
    const ClosestPoint found = closest(points[i]);
    deviation[i] = std::sqrt(found.squared_distance);
    if (found.facet == kNoFacet || deviation[i] == 0) return;
    const bool inside = by_winding ? winding[i] != 0 : is_behind_closest_facet(points[i], found, to, index);
    if (inside) deviation[i] = -deviation[i];
  }, kGrain);
  return deviation;
}

}  // namespace burnish
