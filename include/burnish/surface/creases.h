// Creases: the sharp edges of a surface, as polylines between corners.
//
// A *sharp* edge is one where two facets meet at more than an angle. *Chains* follow sharp edges from corner to corner; a point is a *corner*
// unless exactly two sharp edges meet there and they go on within kCornerTurn of a straight line. Chains without corners are closed.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/surface/edge_table.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct CreaseOptions {
  double angle = 40;     // degrees between the normals of the two facets: sharper edges are creases
  // Edges from this angle on are creases too if both facets reach at least `resolved` away from the edge: what a lattice can show of them. Degrees;
  // at `angle` or more: none.
  double resolved_angle = 180;
  double resolved = 0;   // in the soup's units
  // Chains that are shorter than this and end freely at one end or both are none. 0: all stay.
  double least_length = 0;
  // The noise's standard deviation: normals are filtered before they are compared. 0: they are compared as they are.
  double sigma = 0;
};

struct CreaseEdge {
  Edge points{};                          // of the soup, lower index first
  std::array<std::uint32_t, 2> facets{};  // on both sides: the first runs the edge from points[0] to points[1]
};

struct Creases {
  std::vector<CreaseEdge> edges;                     // lexicographic order of their points
  std::vector<std::vector<std::uint32_t>> chains;    // points of the soup; first == last for a closed one
  std::vector<std::uint32_t> corners;                // ends of chains, ascending

  bool empty() const { return edges.empty(); }
};

// The creases of a welded soup. Edges that are not used by exactly two facets in opposite directions are none. Same result for any number of
// threads, and for the soup multiplied by a power of two (with `resolved`, `least_length` and `sigma` multiplied too). Linear.
Creases find_creases(const TriangleSoup& welded, const CreaseOptions& options = {});

// The edges as triangles {a, b, b}, facet e for edge e: what a TriangleIndex finds closest points of creases in.
TriangleSoup folded(const TriangleSoup& soup, const Creases& creases);

}  // namespace burnish
