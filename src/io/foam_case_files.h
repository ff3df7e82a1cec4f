// What an OpenFOAM case is made of, as files.
#pragma once

#include <string>

#include "burnish/core/progress.h"
#include "burnish/io/foam_case.h"
#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

// points, faces, owner, neighbour and boundary of a polyMesh folder that has none of them.
void write_poly_mesh(const std::string& folder, const PolyhedralMesh& mesh, const FoamFormat& format, Progress& progress);

// Of system, constant and 0, what potentialFoam and simpleFoam want; files that are there stay.
void write_case_files(const std::string& case_folder, const PolyhedralMesh& mesh);

}  // namespace burnish
