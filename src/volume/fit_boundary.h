// The boundary of a volume mesh goes to the surface that the mesh was made from, its edges to the surface's creases; as far as the cells' quality allows.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/extract/reference_surface.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish {

struct BoundaryFit {
  std::uint64_t corners = 0;       // points that went to corners of the creases, before any went back
  std::uint64_t crease_points = 0; // points that went to creases, before any went back
  std::uint64_t moved_back = 0;    // points that the cells' quality kept from their place
  std::uint64_t bad = 0;           // cells beyond the limits (some of which checkMesh may bear) that nothing has mended
  std::uint64_t mended = 0;        // points that had to move for a cell that was bad from the start, by up to a fifth of a cell at a time
};

// `mesh` in lattice units; `level`: per point, half a side of the cells there is 2^level; `on_wall`: per boundary face, whether it is on the surface; `sign`: 1 where the cells are inside it, -1 where outside.
// Points that are on no such face stay. [T-HEX-6] 1. Every boundary point moves to the closest point of the surface. 2. The ends of a boundary edge on two sheets are parted by a
// crease: the nearer end moves there, the nearest ones first, until no edge is parted. 3. While a cell fails (volume/mesh_quality.h, with limits as below), of its points the one that
// moved farthest goes back by a quarter of its way, again and again; in the end all points around it go all the way back. 4. What is bad even so is mended. Same bits for any number of threads.
BoundaryFit fit_boundary(VolumeMesh& mesh, const std::vector<std::uint8_t>& on_wall, const ReferenceSurface& reference, double sign, const std::vector<std::uint8_t>& level, Progress& progress);

}  // namespace burnish
