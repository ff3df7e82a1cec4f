// Quality of a volume mesh, measured as OpenFOAM's checkMesh does (primitiveMeshCheck, polyMeshCheck, primitiveMeshTools of OpenFOAM 1912).
//
// The definitions are OpenFOAM's to the letter, because solvers are judged by them: face centres and areas by triangles about the mean of a face's
// points, cell centres by pyramids over the faces [T-QUAL-1, T-QUAL-2]; non-orthogonality between the line of cell centres and the face's normal, skewness
// from where that line passes the face, relative to how far the face reaches in that direction; weights, volume ratios, the determinant of the
// tensor of a cell's internal face areas, concave cells and faces, flatness, aspect ratio, decomposition into tetrahedra. [T-QUAL-3 to T-QUAL-12]
//
// What fails a mesh, and what is only told, is checkMesh's too:
//
//   always             fewer than 4 faces in a cell, unused points, face order, repeated points in a face; boundary or cells not closed (1e-6), aspect ratio
//                      above 1000, areas and volumes below 1e-300, non-orthogonality of 90 degrees (above 70: told), pyramids below -1e-15, skewness above 4
//   -allTopology       edges that only one face of a cell has
//   -allGeometry       tetrahedra of faces, determinant, concave cells, weight, volume ratio
//   told only          edges shorter than 1e-6 of the diagonal, concave faces, flatness, more than one region
//
// Three-dimensional meshes without coupled patches are meant: faces of cyclic and processor patches count as boundary, and "empty" ones do not make a
// mesh two-dimensional. Not looked for, as checkMesh never fails a mesh for it: points near each other that no edge connects, duplicate faces.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish {

// One check of checkMesh: what is measured, the limit, how many fail, the worst.
struct MeshCheck {
  std::string name;            // "cell faces", "unused points", "face order", "face vertices", "zip-up", "boundary openness", "cell openness", "aspect ratio",
                               // "face area", "cell volume", "non-orthogonality", "face pyramids", "skewness", "boundary skewness", "face tetrahedra",
                               // "edge length", "concave faces", "flatness", "determinant", "concave cells", "weight", "volume ratio": in this order
  bool all_geometry = false;   // checked with -allGeometry or -allTopology only
  bool warns = false;          // never fails a mesh
  double limit = 0;
  double worst = 0;            // counts for those that count; angles in degrees, lengths, areas and volumes in the mesh's units
  double best = 0;             // the other end: the largest area, volume or edge
  double mean = 0;             // as checkMesh prints it, where it does (non-orthogonality: the angle of the mean cosine)
  std::uint64_t measured = 0;  // faces or cells; none: worst, best and mean say nothing
  std::uint64_t failing = 0;   // faces or cells beyond the limit, each once
  bool passed = true;          // as checkMesh judges it; by the limits that were given, where these are others
};

struct MeshQuality {
  std::vector<MeshCheck> checks;
  std::array<std::uint64_t, kCellShapes> cells_of_shape{};  // by CellShape
  std::array<double, kCellShapes> volume_of_shape{};
  std::array<double, kCellShapes> least_dihedral_of_shape{}, greatest_dihedral_of_shape{};  // degrees; of polyhedra none
  std::uint64_t cells = 0, points = 0, faces = 0, internal_faces = 0;
  double volume = 0;
  std::uint32_t regions = 0;              // connected parts
  double least_dihedral = 0, greatest_dihedral = 0;  // between faces of tetrahedra, degrees
  int failed = 0;          // N of "Failed N mesh checks", of `checkMesh -allTopology -allGeometry`
  int plain_failed = 0;    // the same without options
  bool ok = false;         // what `checkMesh -allTopology -allGeometry` calls "Mesh OK"
  bool plain_ok = false;   // the same without options

  // By name; throws std::out_of_range for one that is not in the list above.
  const MeshCheck& check(std::string_view name) const;
  // Of the volume, 0 to 1.
  double hexahedron_share() const { return volume > 0 ? volume_of_shape[static_cast<std::size_t>(CellShape::hexahedron)] / volume : 0; }
};

struct MeshQualityLimits {  // checkMesh's own, unless a caller is stricter
  double non_orthogonality = 70, internal_skewness = 4, boundary_skewness = 4, determinant = 1e-3, weight = 0.05, volume_ratio = 0.01, flatness = 0.8, concave_degrees = 10,
         aspect_ratio = 1000;
};

// What a mesh is, without changing it. Same bits for any number of threads.
// Time: 1.4 us a hexahedron, 0.7 us a tetrahedron (of one CPU, measured on a busy machine). Memory besides the mesh: 75 bytes a hexahedron, 65 a tetrahedron.
MeshQuality mesh_quality(const VolumeMesh& mesh, const MeshQualityLimits& limits = {}, Progress& progress = no_progress());
// The same where shapes are not known: nothing by shape, no dihedral angles.
MeshQuality mesh_quality(const PolyhedralMesh& mesh, const MeshQualityLimits& limits = {}, Progress& progress = no_progress());

// A cell that fails a check, by itself or by one of its faces. For the repair of a mesh, and to show where it is bad.
struct BadCell {
  std::uint32_t cell = 0;
  std::string_view check;  // the first one of the list that it fails, one that only warns too
  double value = 0;
  double limit = 0;
};
// Cells that fail any check, ascending, each once.
std::vector<BadCell> bad_cells(const PolyhedralMesh& mesh, const MeshQualityLimits& limits = {}, Progress& progress = no_progress());
inline std::vector<BadCell> bad_cells(const VolumeMesh& mesh, const MeshQualityLimits& limits = {}, Progress& progress = no_progress()) { return bad_cells(mesh.mesh, limits, progress); }

// Those of `cells`, in that order, measured anew from the points as they are now; 5 to 8 us a hexahedron, 2 us a tetrahedron, whatever the size of the mesh. A point that moved
// changes the cells around it and their neighbours. Not looked for: what is of the mesh as a whole (unused points, face order, boundary openness) and short edges.
std::vector<BadCell> bad_cells_among(const PolyhedralMesh& mesh, const CellFaces& faces, std::span<const std::uint32_t> cells, const MeshQualityLimits& limits = {});

}  // namespace burnish
