// The volume that a level set encloses.
#pragma once

#include "burnish/levelset/level_set.h"

namespace burnish {

// The volume of {phi >= 0} in cells cubed (of the finest level), with phi linear in each of a cell's six Kuhn tetrahedra:
// what `extract_surface` encloses when it moves no nodes, but for crossings that it keeps from the ends of edges. Same bits for any number of threads.
template <class T>
double enclosed_volume(const BasicLevelSet<T>& level_set);

// The part of a tetrahedron in which the linear function with these corner values is >= 0, in [0, 1].
double positive_fraction(double a, double b, double c, double d);

}  // namespace burnish
