// Deciding which nodes may move onto the surface.
#pragma once

#include "lattice_view.h"

namespace burnish::detail {

// A node moves if a crossing lies within this part of an incident edge, and not farther than so many cells. The second keeps diagonals, up to
// 1.7 cells long, from drawing in nodes that are not near the surface: two corners of a tetrahedron on the surface's either side would flatten it.
inline constexpr double kSnap = 0.32, kSnapLength = 0.34;

// The move that takes node n to its nearest crossing within kSnap, or kStays. Looks at all nodes as unmoved.
Move best_move(const LatticeView& view, LocalNode n);

// Whether moved node n has to go back: a tetrahedron around it is flat or inverted and no other corner was
// moved farther, or the surface around it is not one disc.
bool must_stay(const LatticeView& view, LocalNode n);

}  // namespace burnish::detail
