// Inner points of a volume mesh move to where their cells have better shapes.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/volume/volume_mesh.h"
#include "point_cells.h"

namespace burnish {

// [T-HEX-7] The least mean ratio, 12 (3 V)^(2/3) / sum of l^2, of the tetrahedra at the corners of these cells: 1 at most, negative if one is inverted; of polyhedra nothing counts.
double worst_shape(const VolumeMesh& mesh, std::span<const std::uint32_t> cells);

// Moves the points that are `free`, one after the other, towards the mean of what their cells' other corners would have them, if the worst shape of these cells gets better by it; `sweeps` times.
// Points of polyhedra stay. The same bits always: one thread.
void relax(VolumeMesh& mesh, const PointCells& around, const std::vector<std::uint8_t>& free, int sweeps);

}  // namespace burnish
