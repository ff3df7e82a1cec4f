// What is measured of each face and each cell, and what is too much: one table for the report and for the list of bad cells.
#pragma once

#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "burnish/volume/mesh_quality.h"
#include "foam_geometry.h"

namespace burnish::quality {

// In the order of checkMesh's report: topology, then geometry.
enum Check : int {
  faces_of_cell, unused_points, face_order, face_vertices, zip_up,
  boundary_openness, cell_openness, aspect_ratio, face_area, cell_volume, non_orthogonality, pyramids, internal_skewness, boundary_skewness,
  tetrahedra, edge_length, concave_faces, flatness, determinant, concave_cells, weight, volume_ratio,
  kChecks
};

struct Row {
  const char* name;
  int counted_as;       // rows with one number are one check in "Failed N mesh checks"
  bool all;             // with -allGeometry or -allTopology only
  bool warns;           // never fails a mesh
  bool greater_is_worse;
  bool has_mean;
};
inline constexpr std::array<Row, kChecks> kRows{{
    {"cell faces", 0, false, false, false, false},
    {"unused points", 1, false, false, true, false},
    {"face order", 2, false, false, true, false},
    {"face vertices", 3, false, false, true, false},
    {"zip-up", 4, true, false, true, false},
    {"boundary openness", 5, false, false, true, false},
    {"cell openness", 6, false, false, true, false},
    {"aspect ratio", 6, false, false, true, false},
    {"face area", 7, false, false, false, false},
    {"cell volume", 8, false, false, false, false},
    {"non-orthogonality", 9, false, false, false, true},
    {"face pyramids", 10, false, false, false, false},
    {"skewness", 11, false, false, true, false},
    {"boundary skewness", 11, false, false, true, false},
    {"face tetrahedra", 12, true, false, true, false},
    {"edge length", 13, true, true, false, false},
    {"concave faces", 14, true, true, true, false},
    {"flatness", 15, true, true, false, true},
    {"determinant", 16, true, false, false, true},
    {"concave cells", 17, true, false, true, false},
    {"weight", 18, true, false, false, true},
    {"volume ratio", 19, true, false, false, true},
}};

inline constexpr Check kOfFaces[] = {face_vertices, face_area, non_orthogonality, pyramids, internal_skewness, boundary_skewness, tetrahedra, edge_length,
                                      concave_faces, flatness, weight, volume_ratio};
inline constexpr Check kOfCells[] = {faces_of_cell, zip_up, cell_openness, aspect_ratio, cell_volume, determinant, concave_cells};
inline constexpr Check kOfMesh[] = {unused_points, face_order, boundary_openness};

// Per row; non-orthogonality as a cosine, the angles of concave faces as sines.
using Limits = std::array<double, kChecks>;
Limits limits_of(const MeshQualityLimits& limits);                              // no edge is too short
Limits limits_of(const MeshQualityLimits& limits, const PolyhedralMesh& mesh);

inline bool fails(int check, double value, const Limits& limits) {
  return kRows[static_cast<std::size_t>(check)].greater_is_worse ? value > limits[static_cast<std::size_t>(check)] : value < limits[static_cast<std::size_t>(check)];
}
// As it is reported: cosines and sines as degrees.
double shown(int check, double value);

// NaN: not measured there.
struct Measures {
  std::array<double, kChecks> value;
  Measures() { value.fill(std::numeric_limits<double>::quiet_NaN()); }
  double& operator[](Check c) { return value[c]; }
};

// What a thread needs for its work, and a cell whose geometry it keeps.
struct Scratch {
  std::vector<foam::Side> sides;
  std::size_t kept = ~std::size_t{0};
  foam::Cell kept_geometry;
};

// Cells of a mesh, computed once: 32 bytes a cell. Faces are computed each time: to store them takes 144 bytes a hexahedron, and no less time.
struct StoredGeometry {
  const PolyhedralMesh& mesh;
  const CellFaces& faces;
  std::vector<foam::Cell> cell_geometry;

  foam::Face face(std::size_t f) const { return foam::face(mesh.face(f), mesh.points); }
  const foam::Cell& cell(std::size_t c, Scratch&) const { return cell_geometry[c]; }
  void keep(std::size_t, Scratch&) const {}
};
StoredGeometry stored_geometry(const PolyhedralMesh& mesh, const CellFaces& faces);

// The same from the points as they are now, for a few cells.
struct LocalGeometry {
  const PolyhedralMesh& mesh;
  const CellFaces& faces;

  foam::Face face(std::size_t f) const { return foam::face(mesh.face(f), mesh.points); }
  foam::Cell cell(std::size_t c, Scratch& scratch) const { return c == scratch.kept ? scratch.kept_geometry : foam::cell(mesh, faces, c, scratch.sides); }
  void keep(std::size_t c, Scratch& scratch) const {
    scratch.kept_geometry = foam::cell(mesh, faces, c, scratch.sides);
    scratch.kept = c;
  }
};

int repeated_points(foam::Loop loop);
double shortest_edge(foam::Loop loop, foam::Points points);
// Edges that only one of the cell's faces has. [T-QUAL-11]
int open_edges(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell);

template <class Geometry>
void measure_face(const Geometry& g, std::size_t f, double least_concave_sine, Scratch& scratch, Measures& m) {
  const auto loop = g.mesh.face(f);
  const foam::Points points = g.mesh.points;
  const foam::Face face = g.face(f);
  const foam::Cell owner = g.cell(g.mesh.owner[f], scratch);
  m[face_vertices] = repeated_points(loop);
  m[face_area] = norm(face.area);
  m[edge_length] = shortest_edge(loop, points);
  m[concave_faces] = foam::concave_sine(loop, points, face.area, least_concave_sine);
  if (loop.size() > 3 && m[face_area] > foam::kVerySmall) m[flatness] = foam::flatness(loop, points, face);
  m[pyramids] = foam::pyramid_volume(face, owner.centre);
  if (f >= g.mesh.internal_faces()) {
    m[boundary_skewness] = foam::boundary_skewness(loop, points, face, owner.centre);
    m[tetrahedra] = foam::tetrahedra_errors(loop, points, face, owner.centre, nullptr);
    return;
  }
  const foam::Cell neighbour = g.cell(g.mesh.neighbour[f], scratch);
  m[pyramids] = std::fmin(m[pyramids], -foam::pyramid_volume(face, neighbour.centre));
  m[tetrahedra] = foam::tetrahedra_errors(loop, points, face, owner.centre, &neighbour.centre);
  m[non_orthogonality] = foam::cosine(owner.centre, neighbour.centre, face.area);
  m[internal_skewness] = foam::skewness(loop, points, face, owner.centre, neighbour.centre);
  m[weight] = foam::weight(face, owner.centre, neighbour.centre);
  m[volume_ratio] = foam::volume_ratio(owner.volume, neighbour.volume);
}

// Of a cell by itself. Gives back its geometry.
foam::Cell measure_cell(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell, std::vector<foam::Side>& sides, Measures& m);

}  // namespace burnish::quality
