#include "burnish/surface/facet_normals.h"

#include "burnish/core/parallel.h"

namespace burnish {

Vec3 unit_normal(const TriangleSoup& soup, std::size_t facet) {
  const Vec3 normal = facet_normal_2a(soup, facet);
  const double length = norm(normal);
  return length > 0 ? normal / length : Vec3{};
}

FacetNormals facet_normals(const TriangleSoup& soup) {
  FacetNormals n{std::vector<Vec3>(soup.facets.size()), std::vector<double>(soup.facets.size())};
  parallel_for(soup.facets.size(), [&](std::size_t f) {
    const Vec3 normal = facet_normal_2a(soup, f);
    n.area[f] = norm(normal);
    if (n.area[f] > 0) n.unit[f] = normal / n.area[f];
  });
  return n;
}

}  // namespace burnish
