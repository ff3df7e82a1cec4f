#include "facet_sides.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/facet_normals.h"

namespace burnish::detail {

PseudoNormals::PseudoNormals(const TriangleSoup& soup)
    : soup_(soup), of_points_(soup.points.size()), across_(soup.facets.size(), {kNoFacet, kNoFacet, kNoFacet}) {
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const Vec3 n = unit_normal(soup, f);
    for (int i = 0; i < 3; ++i) {
      const Vec3 u = soup.corner(f, (i + 1) % 3) - soup.corner(f, i), v = soup.corner(f, (i + 2) % 3) - soup.corner(f, i);
      of_points_[soup.facets[f][static_cast<std::size_t>(i)]] += n * std::atan2(norm(cross(u, v)), dot(u, v));
    }
  }
  const EdgeTable edges(soup);
  parallel_for(edges.size(), [&](std::size_t e) {
    const auto uses = edges.uses(e);
    if (uses.size() != 2) return;
    across_[uses[0].facet][uses[0].side] = uses[1].facet;
    across_[uses[1].facet][uses[1].side] = uses[0].facet;
  });
}

bool PseudoNormals::is_behind(const Vec3& p, std::uint32_t f) const {  // [T-ADAPT-2]
  const auto corner = [&](int i) -> const Vec3& { return soup_.corner(f, i % 3); };
  // Of an edge: the parameter of the projection onto it, times its squared length, and from which side of it p is seen.
  const Vec3 n = facet_normal_2a(soup_, f);
  int closest = 0;
  double least = 0, where = 0;
  bool within = squared_norm(n) > 0, any = false;
  for (int i = 0; i < 3; ++i) {
    const Vec3 e = corner(i + 1) - corner(i), q = p - corner(i);
    within = within && dot(cross(n, e), q) >= 0;
    const double e2 = squared_norm(e), s = e2 > 0 ? std::clamp(dot(q, e) / e2, 0.0, 1.0) : 0;
    const double d2 = squared_norm(q - e * s);
    if (any && d2 >= least) continue;
    any = true;
    closest = i;
    least = d2;
    where = s;
  }
  if (within) return dot(n, p - corner(0)) < 0;
  if (where <= 0 || where >= 1) {
    const int i = (closest + (where >= 1)) % 3;
    return dot(of_points_[soup_.facets[f][static_cast<std::size_t>(i)]], p - corner(i)) < 0;
  }
  Vec3 sum = unit_normal(soup_, f);
  if (const std::uint32_t other = across_[f][static_cast<std::size_t>(closest)]; other != kNoFacet) sum += unit_normal(soup_, other);
  return dot(sum, p - corner(closest)) < 0;
}

}  // namespace burnish::detail
