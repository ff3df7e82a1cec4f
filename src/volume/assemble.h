// From cells by their corners to a mesh with faces.
#pragma once

#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "burnish/volume/volume_mesh.h"
#include "stuffing.h"

namespace burnish {

// A mesh of these cells, in the order given, with the faces between them in upper triangular order; points that no cell uses are left out, the others come in the order in which cells
// name them first. `source`, if given, gets the place in `points` of each of the mesh's points. All faces that one cell has alone are in one patch without a name.
// Throws Error: bug if a face has more than two cells; memory_limit for more points, or faces of cells (each inner one counts twice), than 32 bits number. Linear but for sorting the faces at one point.
VolumeMesh assemble(const std::vector<Vec3>& points, const CellList& cells, std::vector<std::uint32_t>* source = nullptr);

// Of all cells, those between two of them twice.
std::uint64_t count_half_faces(const CellList& cells);

// Per point: whether it is on a boundary face that is not on the wall (`on_wall`: per boundary face), so on a side of the domain.
std::vector<std::uint8_t> points_at_end(const PolyhedralMesh& mesh, const std::vector<std::uint8_t>& on_wall);

// Sorts the boundary faces into patches, by owner in each: patch_of(face) is an index into `patches`, whose names and types stay.
void sort_into_patches(VolumeMesh& mesh, std::vector<MeshPatch> patches, const std::vector<std::uint32_t>& patch_of);

// The connected parts over faces: one number per cell, the first cell has 0; returns how many there are.
std::uint32_t connected_parts(const PolyhedralMesh& mesh, std::vector<std::uint32_t>& part);

// The cells that `keep` says, as a list.
CellList kept_cells(const CellList& cells, const std::vector<std::uint8_t>& keep);

}  // namespace burnish
