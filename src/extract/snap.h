// Deciding which nodes may move onto the surface.
#pragma once

#include "lattice_view.h"

namespace burnish::detail {

// A node moves if a crossing lies within this part of an incident edge.
inline constexpr double kSnap = 0.25;

// The move that takes node n to its nearest crossing within kSnap, or kStays. Looks at all nodes as unmoved.
Move best_move(const LatticeView& view, LocalNode n);

// Whether moved node n has to go back: a tetrahedron around it is flat or inverted and no other corner was
// moved farther, or the surface around it is not one disc.
bool must_stay(const LatticeView& view, LocalNode n);

}  // namespace burnish::detail
