// Cells cut by the linear interpolant of a distance. [T-VOF-4]
#pragma once

#include <cstdint>
#include <span>

#include "near_cells.h"

namespace burnish {

// Sets alpha[c] of each of the listed cells. Throws Error{interrupted}.
void cut_linearly(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field, const NearCells& near,
                  std::span<const std::uint32_t> cells, const FractionOptions& options, std::vector<double>& alpha, Progress& progress);

// 0 or 1 for each cell, by phi's sign at its middle.
std::vector<double> whole_fractions(const NearCells& near);

}  // namespace burnish
