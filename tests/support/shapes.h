// Shapes with known geometry, and the ways to spoil them. Every shape is closed, oriented outwards and
// shares its points; `unwelded` turns it into what an STL file holds.
#pragma once

#include <functional>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish::test {

// [0, 1]^3 in 12 facets: 8 points, volume 1, area 6.
TriangleSoup cube();
// The four corners given; outwards if (b - a) x (c - a) points to d's other side.
TriangleSoup tetrahedron(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d);
// A unit icosahedron, each facet cut into four `level` times, points moved to the unit sphere: 20 * 4^level
// facets. Volume and area tend to 4/3 pi and 4 pi with order 2 in the edge length.
TriangleSoup icosphere(int level);
// Radii 1 and 0.4 about z, n steps around the axis, m around the tube: 2 n m facets, Euler characteristic 0.
TriangleSoup torus(int n, int m);

// Three points of its own for each facet.
TriangleSoup unwelded(const TriangleSoup& soup);
// Inside out.
// n x n squares, two facets each, over the unit square: facing up, with height z(i, j) at grid point (i / n, j / n).
TriangleSoup height_field(int n, const std::function<double(int, int)>& z);
TriangleSoup flipped(TriangleSoup soup);
TriangleSoup with_flipped_facet(TriangleSoup soup, std::size_t facet);
TriangleSoup with_copied_facet(TriangleSoup soup, std::size_t facet);
// Without the listed facets; their points stay.
TriangleSoup without_facets(TriangleSoup soup, std::vector<std::size_t> facets);
// Each point replaced by map(point).
TriangleSoup mapped(TriangleSoup soup, const std::function<Vec3(const Vec3&)>& map);
TriangleSoup moved(const TriangleSoup& soup, const Vec3& by);
TriangleSoup scaled(const TriangleSoup& soup, double by);
// Facets of both, no points shared.
TriangleSoup merged(TriangleSoup a, const TriangleSoup& b);

}  // namespace burnish::test
