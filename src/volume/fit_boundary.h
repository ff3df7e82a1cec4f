// The boundary of a volume mesh goes to the surface that the mesh was made from, its edges to the surface's creases; as far as the cells' quality allows.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/extract/reference_surface.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish {

struct BoundaryFit {
  std::uint64_t corners = 0;       // points on corners of the creases
  std::uint64_t crease_points = 0; // points on creases
  std::uint64_t moved_back = 0;    // points that the cells' quality kept from their place
  std::uint64_t mended = 0;        // points that had to move for a cell that was bad from the start, by up to a fifth of a cell at a time
};

// `mesh` in lattice units (its cells at the surface have side 2 `cell`); `on_wall`: per boundary face, whether it is on the surface; `sign`: 1 where the cells are inside it, -1 where outside.
// Points that are on no such face stay. [T-HEX-6] 1. Every boundary point moves to the closest point of the surface. 2. The ends of a boundary edge on two sheets are parted by a
// crease: the nearer end moves there, the nearest ones first, until no edge is parted. 3. While a cell fails (volume/mesh_quality.h, with limits as below), its points and those of its neighbours go
// half the way back, in the end all the way. Same bits for any number of threads.
BoundaryFit fit_boundary(VolumeMesh& mesh, const std::vector<std::uint8_t>& on_wall, const ReferenceSurface& reference, double sign, double cell, Progress& progress);

}  // namespace burnish
