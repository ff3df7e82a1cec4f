// How much of a tetrahedron is inside, by phi at its corners and at the middles of its edges.
#pragma once

#include <array>
#include <cstddef>

#include "burnish/volume/volume_fraction.h"

namespace burnish {

inline constexpr std::array<std::array<std::size_t, 2>, 6> kTetrahedronEdges{{{0, 1}, {0, 2}, {0, 3}, {1, 2}, {1, 3}, {2, 3}}};

// What phi's quadratic interpolant adds to positive_share of its values at the corners (phi[0] to phi[3]), to first order; phi[4 + e] is that at the
// middle of edge e. 0 where the corners are on one side. [T-VOF-4]
double quadratic_share(const std::array<double, 10>& phi);

}  // namespace burnish
