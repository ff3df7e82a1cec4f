// Volume meshes of every kind that solvers meet, all of the box [lower, upper] and valid: each face once, internal faces in upper triangular
// order, one patch "walls".
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "burnish/surface/triangle_soup.h"
#include "burnish/volume/polyhedral_mesh.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish::test {

// A cell: its faces, each a loop that is counter-clockwise seen from outside.
using CellLoops = std::vector<std::vector<std::uint32_t>>;
// Faces with the same points belong together.
PolyhedralMesh mesh_of_cells(std::vector<Vec3> points, const std::vector<CellLoops>& cells);

struct Grid {
  Vec3 lower, upper;
  int nx = 1, ny = 1, nz = 1;
  Vec3 spacing() const { return {(upper.x - lower.x) / nx, (upper.y - lower.y) / ny, (upper.z - lower.z) / nz}; }
};
Grid cubic_grid(const Vec3& lower, const Vec3& upper, int n);  // n cells along each side

// Cell (i, j, k) is i + nx (j + ny k).
PolyhedralMesh hexahedra(const Grid& grid);
// Points inside moved by up to `by` spacings along each axis: faces are warped.
PolyhedralMesh jittered(PolyhedralMesh mesh, const Grid& grid, double by, std::uint32_t seed);
// Six to each cell of the grid (Kuhn).
PolyhedralMesh kuhn_tetrahedra(const Grid& grid);
// Cells for which `is_fine(middle)` holds are cut in eight; the others keep the points of these on their faces and edges: hanging faces.
PolyhedralMesh two_levels(const Grid& grid, const std::function<bool(const Vec3&)>& is_fine);
// One polyhedron for each grid point: the dual of kuhn_tetrahedra. Its faces have up to eight points and are not plane when jittered.
PolyhedralMesh dual_polyhedra(const Grid& grid, double jitter = 0, std::uint32_t seed = 1);

// A cell by its corners (VolumeMesh's order), or a polyhedron by its faces.
struct ShapedCell {
  CellShape shape = CellShape::hexahedron;
  std::vector<std::uint32_t> corners;
  CellLoops faces;
};
// `patch_of(middle of a boundary face)`: index into `patches` (name and type).
VolumeMesh volume_mesh_of(std::vector<Vec3> points, const std::vector<ShapedCell>& cells, std::vector<MeshPatch> patches, const std::function<std::size_t(const Vec3&)>& patch_of);

// Two hexahedra, five pyramids, two tetrahedra, two wedges and, if asked for, a polyhedron (a cube with one face in two triangles), in this order: a row
// of unit cubes along x, with one of two wedges on top of the first. Volume 4, or 5; patches "floor" (wall: z = 0), "xMin" and "xMax" (patch), "rest" (wall).
VolumeMesh mixed_cells(bool with_polyhedron);
// The hexahedra of a grid, patches "xMin" and "xMax" (patch), "walls" (wall).
VolumeMesh hexahedral_volume(const Grid& grid);

}  // namespace burnish::test
