// Names of patches as files take them.
#pragma once

#include <string>
#include <vector>

#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

// A name for each patch: letters, digits, _ - + . and what is not ASCII stay, each other byte becomes '_'; one that does not begin with a letter or '_'
// gets a '_' before it; of equal ones, all but the first end in _2, _3, ... So does "wall", which is
// the name of OpenFOAM's group of all walls.
std::vector<std::string> patch_names(const std::vector<MeshPatch>& patches);

}  // namespace burnish
