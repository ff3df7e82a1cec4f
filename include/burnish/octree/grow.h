// Growing the octree: which blocks have to be finest, and which facets concern them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/octree/field.h"
#include "burnish/octree/octree.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// True if triangle abc overlaps the box with this centre and half side (closed: touching counts).
// Separating axes: the box' three normals, the triangle's normal, nine products of edges (Akenine-Moller 2001).
bool triangle_overlaps_cube(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& center, double half);

// Whether a triangle is near axis-parallel cubes, for many cubes.
//
// Never false if the distance between them is at most `reach`. A separating axis test of the cube rounded by the reach: the
// gap between the bounding boxes, the triangle's normal and, where it is larger than half the cube, nine products of edges. True in vain
// only where a corner or an edge of the cube faces one of the triangle, by a part of the reach.
class TriangleNearBox {
 public:
  TriangleNearBox(const Vec3& a, const Vec3& b, const Vec3& c, double reach);
  bool operator()(const Vec3& center, double half) const;

 private:
  struct Axis {
    Vec3 direction;        // of any length
    double low, high;      // the triangle's projection, relative to a
    double box;            // half extent of the projection of the cube with half side 1
    double reach_squared;  // in units of the projection
  };
  Vec3 a_;
  double reach_squared_;
  Vec3 low_, high_;  // bounding box, relative to a
  double extent_;    // its longest side
  std::array<Axis, 10> axes_;
};

// An octree with the facets of every block near the surface.
struct SurfaceOctree {
  Octree octree;
  // CSR by leaf: all facets within the band of one of the leaf's nodes, ascending, and few more. A leaf without any has no node
  // within the band.
  std::vector<std::uint64_t> first_facet;  // size: leaves + 1
  std::vector<std::uint32_t> facets;
  // Which leaves store values of fields (octree/field.h); empty: all.
  FieldLayout layout;

  std::span<const std::uint32_t> facets_of(std::size_t leaf) const {
    return {facets.data() + first_facet[leaf], static_cast<std::size_t>(first_facet[leaf + 1] - first_facet[leaf])};
  }
  bool near_surface(std::size_t leaf) const { return first_facet[leaf] != first_facet[leaf + 1]; }
  std::size_t bytes() const { return octree.bytes() + first_facet.capacity() * 8 + facets.capacity() * 4 + layout.capacity() * 4; }
};

// A field in the grid's layout.
template <class T>
Field<T> field_over(const SurfaceOctree& grid, T value, T second) {
  return grid.layout.empty() ? Field<T>(grid.octree.size(), value) : Field<T>(grid.layout, value, second);
}

// A uniform finest band: every block with a node within `band` cells of a facet is finest, and so are
// `rings` layers of blocks around these, in which no facets are listed: these store
// fields. With a band of at least 2 the facets that cross the
// block's cells are all listed.
// `lattice_soup`: coordinates in lattice units, inside the domain of 2^depth blocks by more than `band`.
// Large facets descend the octree, small ones test their few blocks. Same result for any thread count.
SurfaceOctree grow_uniform_band(const TriangleSoup& lattice_soup, int depth, double band, int rings = 0,
                                Progress& progress = no_progress());

}  // namespace burnish
