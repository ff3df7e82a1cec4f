#include "burnish/volume/volume_mesh.h"

namespace burnish {
namespace {

using Face = std::array<int, 4>;

constexpr std::array<Face, 4> kTetrahedron{{{0, 2, 1, -1}, {0, 1, 3, -1}, {1, 2, 3, -1}, {2, 0, 3, -1}}};
constexpr std::array<Face, 5> kPyramid{{{0, 3, 2, 1}, {0, 1, 4, -1}, {1, 2, 4, -1}, {2, 3, 4, -1}, {3, 0, 4, -1}}};
constexpr std::array<Face, 5> kWedge{{{0, 1, 2, -1}, {3, 5, 4, -1}, {0, 3, 4, 1}, {1, 4, 5, 2}, {2, 5, 3, 0}}};
constexpr std::array<Face, 6> kHexahedron{{{0, 3, 2, 1}, {4, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}};

}  // namespace

std::span<const Face> faces_of_shape(CellShape shape) {
  switch (shape) {
    case CellShape::tetrahedron: return kTetrahedron;
    case CellShape::pyramid: return kPyramid;
    case CellShape::wedge: return kWedge;
    case CellShape::hexahedron: return kHexahedron;
    case CellShape::polyhedron: break;
  }
  return {};
}

}  // namespace burnish
