// Volume meshes as files: OpenFOAM, VTK, gmsh, SU2, CGNS.
//
// Nothing half-written appears under the name: files are written beside their destination and renamed. Coordinates in text have all digits that it takes to read
// the same double back. Same bytes for any number of threads (CGNS apart).
//
// Names of patches are written as words that all formats take: letters, digits, _ - + . stay (and what is not ASCII), other characters become '_', a '_' comes before a
// first one that is no letter, and of equal names all but the first end in _2, _3, ... A patch "wall" becomes "wall_2": OpenFOAM calls the group of all walls so.
//
// Cost is given for a million hexahedra: CPU seconds, memory beyond that of the mesh (160 MB), bytes of the files.
#pragma once

#include <string>

#include "burnish/core/progress.h"
#include "burnish/io/foam_case.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish {

enum class VolumeFormat : std::uint8_t { foam_case, vtu, msh, su2, cgns };

// By the path's ending: .vtu, .msh, .su2, .cgns; a path without a suffix, or a folder that exists, is an OpenFOAM case. Throws Error{usage} naming the formats for any other.
VolumeFormat volume_format(const std::string& path);

struct VolumeWriteOptions {
  bool overwrite = true;       // replace a file, or the mesh of a case, that is there
  FoamFormat foam{.binary = true};
  int msh_version = 41;        // in binary; or 22, in text
};

// [T-FOAM-1] CASE/constant/polyMesh: points, faces, owner, neighbour (each gzipped if the format says so) and boundary (always text), in OpenFOAM's order. Patches of the type wall
// are in the group wall.
//
// The new mesh replaces the old one as a whole folder. On Linux file systems that exchange names (ext4, xfs, btrfs, tmpfs) an interrupted run, at whatever moment, leaves
// the old mesh or the new one; on others there is a moment without any between two renames. Kept of the old folder is what is of no mesh, such as a blockMeshDict. Gone is what belongs to
// the old mesh: zones, sets, levels and histories of refinement, addressing, and the polyMesh folders of time folders, which programs would read instead of the new one. Without `overwrite`
// any of these is Error{unwritable_output}, and nothing is changed. Fields in time folders, processor folders and meshes of regions stay: they are the user's, and may not fit.
// What is in time folders goes just before the exchange, and files of a new case come before it. A run that ends by itself or by `progress` leaves nothing unfinished; one whose
// process is killed may leave a folder `.polyMesh.XXXXXX.tmp`, which nothing reads.
//
// A case without system/controlDict is taken for a new one, and gets it last, after system/fvSchemes, fvSolution, constant/transportProperties, turbulenceProperties, 0/U and 0/p: laminar, steady,
// for potentialFoam and simpleFoam of openfoam.com. Files that are there stay. Conditions go by group and by pattern, so they fit the case's next mesh as well:
// walls do not slip, the flow enters at the patch xMin with velocity (1 0 0) and leaves at xMax, other patches slip. With walls alone nothing drives the flow, and it
// comes to rest. The viscosity is a hundredth of the mesh' longest side.
//
// Throws Error: usage for lists longer than labels of 32 bits count, unwritable_output, interrupted.
// Cost: 0.3 s in binary, 0.8 s in text, 8 s gzipped; less than 1 MB; 105, 168 and 33 MB.
void write_foam_case(const std::string& case_folder, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

// VTK's XML UnstructuredGrid: appended raw binary, zlib blocks, Float64 points; an array `shape` (CellShape's numbers) of the cells, no patches. Types 10, 12, 13, 14, and for polyhedra 42 with
// `faces` and `faceoffsets`. Cost: 0.9 s, 45 MB, 20 MB; of polyhedra 2.1 s, 145 MB, 56 MB.
void write_vtu(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

// Version 4.1 in binary; version 2.2 in text, for older readers (gmshToFoam reads that alone). Physical groups: one for each patch that has faces, numbered as the patches are from 1 on, and
// "fluid" for the cells ("fluid_2" beside a patch "fluid"). Throws Error{usage} for a mesh with polyhedra. Cost: 0.1 s in binary, 0.3 s in text; less than 1 MB; 103 and 114 MB.
void write_msh(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

// Text; one marker for each patch. Throws Error{usage} for a mesh with polyhedra. Cost: 0.5 s, less than 1 MB, 95 MB.
void write_su2(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

// Whether this build can write .cgns, and Error{usage} naming the path if it cannot.
bool has_cgns();
void require_cgns(const std::string& path);
// CGNS 3.4 in HDF5: a base, an unstructured zone, coordinates as doubles; sections of tetrahedra, pyramids, prisms and hexahedra, then of each patch with faces, NAME_Tri and NAME_Quad, with a boundary condition and a family
// NAME (BCWall, BCSymmetryPlane, or BCTypeUserDefined for what flow passes). Names are cut to 27 bytes, as nodes have 32, but never within a character of UTF-8; they end in _2, _3, ... where they would be the same, or that of another node (Zone, ZoneBC, Tetrahedra).
// No units.
// Throws Error{usage} for a mesh with polyhedra, for one of more than 2^31 corners of one shape (where the library counts in 32 bits), and in a build without the library. Twice the file's room on disk while it is written. HDF5 records times: the bytes are not those of the run before.
void write_cgns(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

// What write_volume_mesh would throw for this path, as far as it can be known before there is a mesh: Error{unwritable_output} for a folder that is missing, not writable or no folder,
// and, unless `overwrite`, for what is there already; Error{usage} for a suffix of no format. Leaves nothing behind.
void require_writable(const std::string& path, const VolumeWriteOptions& options = {});

// The one of the above that the path asks for.
void write_volume_mesh(const std::string& path, const VolumeMesh& mesh, const VolumeWriteOptions& options = {}, Progress& progress = no_progress());

}  // namespace burnish
