// Angles between faces, by the shape of the cells.
#pragma once

#include <array>

#include "burnish/volume/volume_mesh.h"

namespace burnish::quality {

struct AngleRange {
  double least = 0, greatest = 0;  // degrees; 0 and 0 where there is no such cell
};
// [T-QUAL-12] Between two faces with a common edge, inside the cell. Polyhedra are not looked at.
std::array<AngleRange, kCellShapes> dihedral_angles(const VolumeMesh& mesh);

}  // namespace burnish::quality
