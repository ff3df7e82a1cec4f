// Which edges of the lattice a facet crosses.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/octree/field.h"
#include "burnish/octree/grow.h"

namespace burnish {

// Facets closer than this to a lattice edge's end count as crossing it, in cells: touching is crossing.
inline constexpr double kTouching = 1e-6;

// Per node three bits: bit a is set if some facet crosses the lattice edge from this node to the next one along axis
// a (x, y, z), a cell of its leaf away. A closed test: two facets that share an edge let nothing pass between them.
Field<std::uint8_t> crossed_edges(const TriangleSoup& lattice_soup, const SurfaceOctree& grid,
                                  Progress& progress = no_progress());

// The facets that cross some edge whose two ends are on one side: where the lattice shows that they bound nothing, or that another
// facet is close. 1 for these, 0 for all others. `inside`: 1 for nodes inside, 0 outside.
std::vector<char> facets_across_idle_edges(const TriangleSoup& lattice_soup, const SurfaceOctree& grid,
                                           const Field<std::uint8_t>& crossed, const Field<std::uint8_t>& inside,
                                           Progress& progress = no_progress());

// What the lattice edges that a facet crosses have at their two ends.
struct FacetSides {
  bool separates = false;       // some edge has one end inside, the other outside
  bool within_inside = false;   // some edge has both ends inside
  bool within_outside = false;  // some edge has both ends outside

  bool crosses() const { return separates || within_inside || within_outside; }
};

// For every facet that is `wanted`, over all lattice edges that it crosses; nothing is said of the others.
std::vector<FacetSides> facet_sides(const TriangleSoup& lattice_soup, const SurfaceOctree& grid,
                                    const Field<std::uint8_t>& inside, const std::vector<char>& wanted,
                                    Progress& progress = no_progress());

}  // namespace burnish
