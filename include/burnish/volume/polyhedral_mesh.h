// PolyhedralMesh: a volume mesh of arbitrary polyhedra, as finite volume solvers see it: faces with an owner and a neighbour.
//
// Each face is stored once. Its normal (right-hand rule over its points) points from the owner to the neighbour, or out of the
// mesh. Internal faces come first; then those of the patches, each patch one range.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish {

struct MeshPatch {
  std::string name;
  std::string type;  // "wall", "patch", "empty", "processor", ...
  std::uint32_t first_face = 0, faces = 0;
};

struct PolyhedralMesh {
  std::vector<Vec3> points;
  std::vector<std::uint64_t> face_start;   // size faces + 1: where a face's points begin in face_points
  std::vector<std::uint32_t> face_points;
  std::vector<std::uint32_t> owner;        // per face
  std::vector<std::uint32_t> neighbour;    // per internal face
  std::vector<MeshPatch> patches;
  std::uint32_t cells = 0;

  std::size_t faces() const { return owner.size(); }
  std::size_t internal_faces() const { return neighbour.size(); }
  std::span<const std::uint32_t> face(std::size_t f) const { return {face_points.data() + face_start[f], face_start[f + 1] - face_start[f]}; }
};

// The faces of each cell, ascending: faces of cell c are at[first[c]] ... at[first[c + 1] - 1].
struct CellFaces {
  std::vector<std::uint64_t> first;
  std::vector<std::uint32_t> at;
  std::span<const std::uint32_t> operator[](std::size_t c) const { return {at.data() + first[c], first[c + 1] - first[c]}; }
};
CellFaces cell_faces(const PolyhedralMesh& mesh);

// [T-MESH-1] A face with more than three points stands for the triangles from the mean of its points to its edges; a cell for the tetrahedra from
// the mean of its faces' points to these. So cells fill the mesh without gap or overlap, even where faces are not plane.
Vec3 face_middle(const PolyhedralMesh& mesh, std::size_t face);

// Of those tetrahedra. Negative volumes are inverted cells.
struct CellGeometry {
  std::vector<double> volume;
  std::vector<Vec3> middle;    // the apex of the cell's tetrahedra
  std::vector<Box3> box;
};
CellGeometry cell_geometry(const PolyhedralMesh& mesh, const CellFaces& faces);

}  // namespace burnish
