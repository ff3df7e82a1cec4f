// Volume meshes as files: OpenFOAM, VTK, gmsh, SU2.
//
// All write through OutputFile: nothing half-written appears under the name. Coordinates have all digits that it takes to read the same
// double back.
#pragma once

#include <string>

#include "burnish/core/progress.h"
#include "burnish/io/foam_case.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish {

enum class VolumeFormat : std::uint8_t { foam_case, vtu, msh, su2 };

// By the path's ending: .vtu, .msh, .su2; a path without a suffix, or a folder that exists, is an OpenFOAM case. Throws Error{usage} naming the formats for any other.
VolumeFormat volume_format(const std::string& path);

struct VolumeWriteOptions {
  bool overwrite = true;       // replace a file, or the mesh of a case, that is there
  FoamFormat foam{.binary = true};
  int msh_version = 41;        // or 22
};

// [T-FOAM-1] CASE/constant/polyMesh, in OpenFOAM's order. A case that has none gets system/controlDict, fvSchemes and fvSolution as well (for potentialFoam and
// simpleFoam, laminar, with 0/U, 0/p: walls by patch type, a case that runs); files that are there stay. Old cell zones and sets, which are of another mesh, are an error unless
// `overwrite`.
void write_foam_case(const std::string& case_folder, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

// Appended raw binary, zlib blocks, Float64 points; arrays `shape` of cells.
void write_vtu(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());
// Binary; physical groups: "fluid" for the cells, one per patch with its name. Throws Error{usage} for a mesh with polyhedra.
void write_msh(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());
// Text; one marker per patch. Throws Error{usage} for a mesh with polyhedra.
void write_su2(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

// The one of the above that the path asks for.
void write_volume_mesh(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

}  // namespace burnish
