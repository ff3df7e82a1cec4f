// Growing the octree: which blocks have to be finest, and which facets concern them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/octree/octree.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// True if triangle abc overlaps the box with this centre and half side (closed: touching counts).
// Separating axes: the box' three normals, the triangle's normal, nine products of edges (Akenine-Moller 2001).
bool triangle_overlaps_cube(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& center, double half);

// An octree with the facets of every finest block near the surface.
struct SurfaceOctree {
  Octree octree;
  // CSR by leaf: facets that meet the leaf's cube inflated by the band, ascending. Leaves without any
  // are farther than the band from the surface.
  std::vector<std::uint64_t> first_facet;  // size: leaves + 1
  std::vector<std::uint32_t> facets;

  std::span<const std::uint32_t> facets_of(std::size_t leaf) const {
    return {facets.data() + first_facet[leaf], static_cast<std::size_t>(first_facet[leaf + 1] - first_facet[leaf])};
  }
  bool near_surface(std::size_t leaf) const { return first_facet[leaf] != first_facet[leaf + 1]; }
  std::size_t bytes() const { return octree.bytes() + first_facet.capacity() * 8 + facets.capacity() * 4; }
};

// A uniform finest band: every block with a point within `band` cells (maximum norm) of a facet is finest, and so are
// `rings` layers of blocks around these, in which no facets are listed.
// `lattice_soup`: coordinates in lattice units, inside the domain of 2^depth blocks by more than `band`.
// Large facets descend the octree, small ones test their few blocks. Same result for any thread count.
SurfaceOctree grow_uniform_band(const TriangleSoup& lattice_soup, int depth, double band, int rings = 0,
                                Progress& progress = no_progress());

}  // namespace burnish
