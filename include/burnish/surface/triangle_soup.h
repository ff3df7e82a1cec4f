// TriangleSoup: triangles as a file holds them, which promises nothing.
//
// Facets may be degenerate, duplicated, flipped, open, overlapping, and need not share points. What
// *is* guaranteed: every index is valid and every coordinate is finite. Names and colours say nothing about
// the surface; they are carried along for the programs that come after.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish {

// Three indices into the points, counter-clockwise seen from outside where orientation means anything.
using Facet = std::array<std::uint32_t, 3>;

// Stands for no facet wherever a facet has a number.
inline constexpr std::uint32_t kNoFacet = 0xffffffffu;

// A colour: red in the lowest byte, then green, blue and alpha, 255 for opaque. Alpha 0 is no colour at all,
// whatever the rest, and is stored as kNoColor.
using Color = std::uint32_t;
inline constexpr Color kNoColor = 0;

constexpr Color color_of(std::uint32_t red, std::uint32_t green, std::uint32_t blue, std::uint32_t alpha = 255) {
  return alpha == 0 ? kNoColor : red | green << 8 | blue << 16 | alpha << 24;
}

// Red, green, blue or alpha (0 to 3) of a colour: 0 to 255.
constexpr std::uint32_t channel(Color color, int i) { return color >> (8 * i) & 0xff; }

// A named run of facets: a `solid` of an ASCII STL, a group of an OBJ or PLY. Runs are disjoint, in order,
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
  std::vector<Color> colors{};  // one per facet; empty: no facet has one

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
