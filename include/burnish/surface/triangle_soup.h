// TriangleSoup: triangles as a file holds them, which promises nothing.
//
// Facets may be degenerate, duplicated, flipped, open, overlapping, and need not share points. What
// *is* guaranteed: every index is valid and every coordinate is finite.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish {

// Three indices into the points, counter-clockwise seen from outside where orientation means anything.
using Facet = std::array<std::uint32_t, 3>;

// A named run of facets: a `solid` of an ASCII STL, a group of an OBJ. Runs are disjoint, in order,
// and together cover all facets if there are any runs at all.
struct FacetGroup {
  std::string name;  // as in the file, bytes untouched
  std::uint32_t first_facet = 0;
  std::uint32_t facet_count = 0;
};

struct TriangleSoup {
  std::vector<Vec3> points;
  std::vector<Facet> facets;
  std::vector<FacetGroup> groups;

  const Vec3& corner(std::size_t facet, int i) const { return points[facets[facet][static_cast<std::size_t>(i)]]; }
};

// The box of all points that a facet uses. Empty for a soup without facets.
Box3 bounding_box(const TriangleSoup& soup);

// Twice the vector area of facet f: normal direction by the right-hand rule, length 2 x area.
inline Vec3 facet_normal_2a(const TriangleSoup& soup, std::size_t f) {
  const Vec3& a = soup.corner(f, 0);
  return cross(soup.corner(f, 1) - a, soup.corner(f, 2) - a);
}

// Sum of the facets' areas.
double area(const TriangleSoup& soup);

// Volume by the divergence theorem, positive when facets are oriented outwards. Means something only
// for closed, oriented soups; taken about the box' centre, so that an open soup gives a bounded number.
double signed_volume(const TriangleSoup& soup);

// Mean length of the facets' edges (each facet's three edges count once). 0 without facets.
double mean_edge_length(const TriangleSoup& soup);

}  // namespace burnish
