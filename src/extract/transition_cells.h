// Cells with hanging nodes: cut into a fan of tetrahedra from their centre.
#pragma once

#include "burnish/octree/field.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish::detail {

// Appends the surface within one cell of a leaf (given by its lower lattice node) to `soup`, every facet with points
// of its own. The cell may have finer neighbours across any of its faces and edges: a face split in four
// contributes eight triangles, a face with split edges only a fan from its centre, any other the two of the
// Kuhn subdivision; neighbours derive the same. Cells without hanging nodes become the six Kuhn tetrahedra.
// `plain`: nodes whose edges are crossed in the middle (empty: none).
template <class T>
void cut_transition_cell(const Octree& tree, const Field<T>& phi, const Field<std::uint8_t>& plain, std::size_t leaf,
                         LatticeNode cell, TriangleSoup& soup);

}  // namespace burnish::detail
