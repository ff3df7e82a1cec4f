// Which cells a surface may pass through, by its distance.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/volume/volume_fraction.h"

namespace burnish {

struct NearCells {
  std::vector<std::uint32_t> cells;                  // ascending
  std::vector<double> at_middle, at_face, at_point;  // phi; of faces and points of no near cell: none
};

// [T-VOF-6] Cells that no surface passes through are left out if a ball about their middle shows it. Throws Error{interrupted}.
NearCells near_cells(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field, Progress& progress);

// Whether the value at a point shows that no surface is within `reach` of it.
inline bool shows_free(double phi, double band, double reach) {
  constexpr double kSlack = 1.1;  // phi may be an interpolant's
  return std::min(std::abs(phi), band) > kSlack * reach;
}

}  // namespace burnish
