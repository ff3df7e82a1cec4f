// What of a mesh's connections checkMesh checks as a whole.
#pragma once

#include "burnish/volume/polyhedral_mesh.h"

namespace burnish::quality {

std::uint64_t unused_point_count(const PolyhedralMesh& mesh);
// Internal faces whose owner is not below its neighbour, or that come before a face of the same owner to a lower neighbour. [T-FOAM-1]
std::uint64_t misordered_face_count(const PolyhedralMesh& mesh, const CellFaces& faces);

}  // namespace burnish::quality
