// Carrying fields and lists of facets from one octree of a domain to another.
//
// The two octrees have the same depth; any leaf of the new one may be a leaf of the old one, hold several of them, or lie in one.
#pragma once

#include "burnish/octree/field.h"
#include "burnish/octree/grow.h"

namespace burnish {

// Values at nodes. Where the old octree stores a node its value is copied (nodes of two levels coincide); where it does
// not, the value is `node_value`'s, trilinear in the old cell: second order. So refining and coarsening again gives back the
// same bits. T is float or double.
template <class T>
Field<T> transfer_nodal(const Octree& from, const Field<T>& field, const Octree& to);

// How a cell's value is spread over smaller cells.
enum class Reconstruction {
  constant,  // each gets the cell's
  linear,    // slopes by central differences within the block, one-sided at its ends: exact for linear fields
};

// Means over cells: value node_index(i, j, k) of a leaf stands for the cell from node (i, j, k) to (i + 1, j + 1, k + 1).
// A new cell that holds old ones gets their mean weighted by volume; one that lies in an old one gets the reconstruction's mean over
// it. Either way the sum of value times volume stays the same, to rounding, over every octant that both octrees resolve.
template <class T>
Field<T> transfer_conserved(const Octree& from, const Field<T>& field, const Octree& to,
                            Reconstruction reconstruction = Reconstruction::linear);

// Lists of facets: a leaf that holds old ones gets the union of their lists, one that lies in an old one gets that one's.
// If every old leaf lists what is within `band` of its own cells of its nodes, then a new leaf lists at least what is within
// `band` cells of the finest old leaf within it of these nodes, or of its own if it lies in an old one. That is not all
// that a leaf grown on its new level would list: distances from these facets are exact up to `band` *finest* cells.
SurfaceOctree transfer_facets(const SurfaceOctree& from, Octree to);

// The old leaves [begin, end) that an octant of any level holds; if it lies in one, that one alone.
struct LeafRange {
  std::size_t begin = 0, end = 0;
};
LeafRange leaves_in(const Octree& tree, std::uint64_t key);

}  // namespace burnish
