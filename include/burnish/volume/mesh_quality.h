// Quality of a volume mesh, measured as OpenFOAM's checkMesh does (primitiveMeshCheck, polyMeshCheck, primitiveMeshTools of OpenFOAM 1912).
//
// The definitions are OpenFOAM's to the letter, because solvers are judged by them: face centres and areas by triangles about the mean of a face's
// points, cell centres by pyramids over the faces; non-orthogonality between the line of cell centres and the face's normal, skewness
// from where that line passes the face, normalised as `skewness(mesh, points, ...)` there; weights, volume ratios, the determinant of a cell's
// face area tensor, concave cells and faces, flatness, aspect ratio, tet decomposition.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish {

// One check of checkMesh: what is measured, the limit, how many fail, the worst.
struct MeshCheck {
  std::string name;            // as in the report: "non-orthogonality", "skewness", ...
  bool all_geometry = false;   // checked with -allGeometry or -allTopology only
  double limit = 0;            // what checkMesh calls an error
  double worst = 0;
  double mean = 0;             // where a mean means something
  std::uint64_t failing = 0;
  bool passed = true;          // as checkMesh judges it: some only warn
};

struct MeshQuality {
  std::vector<MeshCheck> checks;
  std::array<std::uint64_t, 5> cells_of_shape{};  // by CellShape
  std::array<double, 5> volume_of_shape{};
  std::uint64_t cells = 0, points = 0, faces = 0, internal_faces = 0;
  double volume = 0;
  std::uint32_t regions = 0;              // connected parts
  double least_dihedral = 0, greatest_dihedral = 0;  // between faces of tetrahedra, degrees
  bool ok = false;         // what `checkMesh -allTopology -allGeometry` calls "Mesh OK"
  bool plain_ok = false;   // the same without options
};

struct MeshQualityLimits {  // checkMesh's own, unless a caller is stricter
  double non_orthogonality = 70, internal_skewness = 4, boundary_skewness = 20, determinant = 1e-3, weight = 0.05, volume_ratio = 0.01, flatness = 0.8, concave_degrees = 10;
};

// What a mesh is, without changing it. Same result for any number of threads.
MeshQuality mesh_quality(const VolumeMesh& mesh, const MeshQualityLimits& limits = {}, Progress& progress = no_progress());

// Cells that fail any check, ascending, each once; with the check's name. For the repair of a mesh, and to show where it is bad.
struct BadCell {
  std::uint32_t cell;
  std::string check;
  double value;
};
std::vector<BadCell> bad_cells(const VolumeMesh& mesh, const MeshQualityLimits& limits = {}, Progress& progress = no_progress());

}  // namespace burnish
