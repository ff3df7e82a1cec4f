// What a volume mesh takes, before it is made.
#pragma once

#include <cstdint>
#include <span>

#include "burnish/surface/triangle_soup.h"
#include "burnish/volume/flow_mesh.h"
#include "mesh_refinement.h"

namespace burnish {

// Throws Error{memory_limit} for a mesh that would not fit into options.memory_bytes. The message names what takes most (cells at the surface, a refinement, the largest cells), and
// what would fit. `region`: all that has cells; levels as CellLattice has them; `band`: of the level set, in lattice units of its cells. What several boxes hold counts once, with the smallest
// cells. Within a factor of 2.
void require_memory(const TriangleSoup& surface, const FlowMeshOptions& options, std::span<const LatticeRefinement> refinements, const LatticeBox& region, int surface_level, double band);

// The same once the number of cells is known (before those at the surface are cut), which is told.
void require_memory(std::uint64_t cells, const FlowMeshOptions& options);

// The area of what a box holds of the surface.
double area_within(const TriangleSoup& surface, const Box3& box);

}  // namespace burnish
