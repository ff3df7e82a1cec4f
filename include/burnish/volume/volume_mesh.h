// VolumeMesh: cells with a shape, and the faces between them.
//
// A finite volume solver wants faces with owner and neighbour (`mesh`, see volume/polyhedral_mesh.h); finite element readers want each
// cell's corners in an order that its shape defines. Both are here, of the same cells.
//
// **Order.** Internal faces are sorted by (owner, neighbour), owner < neighbour ("upper triangular order"); then those of the patches, each patch
// one range, sorted by owner. Every point is used. Corners are in VTK's order (tetrahedron 10, pyramid 14, wedge 13, hexahedron 12):
//   tetrahedron 0 1 2 | 3: 3 is on the side that the normal of 0 1 2 points to
//   pyramid     0 1 2 3 | 4: likewise
//   wedge       0 1 2 | 3 4 5: the normal of 0 1 2 points away from 3 4 5 (as VTK says; gmsh and SU2 want it the other way round)
//   hexahedron  0 1 2 3 | 4 5 6 7: the normal of 0 1 2 3 points towards 4 5 6 7
//   polyhedron  its distinct points, ascending; its faces tell the rest
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

enum class CellShape : std::uint8_t { tetrahedron, pyramid, wedge, hexahedron, polyhedron };
inline constexpr int kCellShapes = 5;

struct VolumeMesh {
  PolyhedralMesh mesh;
  std::vector<CellShape> shape;      // per cell
  std::vector<std::uint64_t> first;  // size cells + 1: where a cell's corners begin
  std::vector<std::uint32_t> corners;

  std::size_t cells() const { return shape.size(); }
  std::span<const std::uint32_t> cell(std::size_t c) const { return {corners.data() + first[c], static_cast<std::size_t>(first[c + 1] - first[c])}; }
};

// The faces of a cell of that shape, as places in its corners, normals outwards; unused places of triangles are -1. Not for polyhedra.
std::span<const std::array<int, 4>> faces_of_shape(CellShape shape);

}  // namespace burnish
