// Where the surface crosses lattice edges, for redistancing by a PDE with a surface that must stay.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "node_bits.h"
#include "weno_kernel.h"

namespace burnish::detail {

// A node too close to the surface for steps in pseudo-time: its distance is computed at once, in own units, and stays.
struct HeldNode {
  std::uint16_t node;
  double distance;
};

// What a block's kernel must know of the surface.
struct BlockCrossings {
  NodeBits still{};  // accepted, cut and held nodes
  bool any = false;  // whether some bit of `still` is set
  std::vector<CutNodes> cut;
  std::vector<HeldNode> held;
};

// The crossings of phi0 = 0 on edges of nodes that are not in `crossings.still` yet, from the halo block of phi0 in own units.
void find_crossings(const HaloBlock& phi0, BlockCrossings& crossings);

}  // namespace burnish::detail
