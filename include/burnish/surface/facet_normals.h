// Unit normals of facets, with their areas.
#pragma once

#include <cstddef>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Of one facet; zero where it has no area.
Vec3 unit_normal(const TriangleSoup& soup, std::size_t facet);

// By facet. The same as `facet_normal_2a`, divided.
struct FacetNormals {
  std::vector<Vec3> unit;    // zero where a facet has no area
  std::vector<double> area;  // twice the facets'
};

FacetNormals facet_normals(const TriangleSoup& soup);

}  // namespace burnish
