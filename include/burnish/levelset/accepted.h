// The thesis' ACCEPTED cells (section 4.4.1): those whose distances come from the facets, and from which all others follow.
//
// A cell is ACCEPTED if a facet cuts it (closed: touching counts), or if it touches such a cell, over a face, an edge or a corner, of
// whatever level. In the thesis values sit at the centres of cells; ours sit at nodes. So a *node* is ACCEPTED if some ACCEPTED cell holds it
// (closed): as a corner, or hanging in the middle of its face or edge.                                     [T-ACC-1]
//
// None of these nodes is farther from a facet than accepted_band() cells of its leaf's level: with a band of at least that, their distances are
// exact (levelset/distance.h). Where all cells are of one level, every node within two cells of a facet is among them.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// How far an ACCEPTED node can be from a facet, in cells of its leaf's level: 2 sqrt(3) = 3.47; where cells of several levels meet at the
// surface, twice that.
double accepted_band(bool several_levels);

enum class AcceptedMark : std::uint8_t { none, neighbor, cut };

struct AcceptedCells {
  Field<std::uint8_t> cells;     // an AcceptedMark of each cell, at the place of its lower node
  Field<std::uint8_t> nodes;     // 1: ACCEPTED
  std::uint64_t cells_cut = 0;
  std::uint64_t cells_accepted = 0;  // these, and their neighbours
  std::uint64_t nodes_accepted = 0;
};

// Both fields are in phi's layout; leaves that store nothing have none. `lattice_soup`: the facets that the grid's lists number, of which
// those with active[f] count (empty: all). With a band of 2 or more the lists have all facets that cut a leaf's cells.
// Same bits for any number of threads. Throws Error{interrupted}.
template <class T>
AcceptedCells accepted_cells(const TriangleSoup& lattice_soup, const BasicLevelSet<T>& level_set, const std::vector<char>& active = {},
                             Progress& progress = no_progress());

// The nodes of leaves with facets that have |phi| below the band of their leaf's level: exact distances all of them, more than ACCEPTED.
template <class T>
Field<std::uint8_t> nodes_within_band(const BasicLevelSet<T>& level_set, Progress& progress = no_progress());

}  // namespace burnish
