// Exact unsigned distances, scattered from triangles to the nodes of the blocks near the surface.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/octree/field.h"
#include "burnish/octree/grow.h"

namespace burnish {

struct DistanceField {
  Field<float> distance;          // in finest cells; at most the band
  Field<std::uint32_t> nearest;   // index of a closest facet; kNoFacet beyond the band; empty if not kept
};

enum class KeepNearest { yes, no };

// The distance of every node of the octree to the nearest facet, where it is at most `band` cells; `band`
// where it is more. `active` (empty: all) says which facets take part. Only leaves with facets are
// visited, all others keep `band`.
//
// Computed in double precision from the triangle itself, then rounded to float: off by less than 1e-15 of the distance and 1e-13 of the facet's
// size (1e-16 of it but for slender facets). In a leaf of level l the band is `band` cells of its own, 2^l finest cells each.
// Point-triangle distance after Ericson 2005, sec. 5.1.5, in forms without branches [T-DIST-1]. About 2 ns per node and facet.
DistanceField exact_distances(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, double band,
                              const std::vector<char>& active = {}, Progress& progress = no_progress(), KeepNearest keep = KeepNearest::yes);

// The same for one leaf, in double: `squared` and `nearest` get 512 values each. What `exact_distances` rounds.
void exact_squared_distances(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, std::size_t leaf,
                             double band, const std::vector<char>& active, double* squared, std::uint32_t* nearest);

// Squared distances (in finest cells) of a leaf's 512 nodes, of any level, to the nearest of the given facets.
void squared_distances_to(const TriangleSoup& lattice_soup, std::span<const std::uint32_t> facets, const Octree& tree,
                          std::size_t leaf, double* squared, std::uint32_t* nearest);

}  // namespace burnish
