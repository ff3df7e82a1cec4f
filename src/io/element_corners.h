// Elements as gmsh and SU2 number their corners.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>

#include "burnish/volume/volume_mesh.h"

namespace burnish {

// Corners of a cell, counter-clockwise from inside for the base: those of a wedge are turned round, all others are VTK's.
struct ElementCorners {
  std::array<std::uint32_t, 8> at{};
  std::size_t count = 0;
  std::span<const std::uint32_t> span() const { return {at.data(), count}; }
};

inline ElementCorners element_corners(const VolumeMesh& mesh, std::size_t cell) {
  constexpr std::array<std::size_t, 8> kSame{0, 1, 2, 3, 4, 5, 6, 7}, kWedge{0, 2, 1, 3, 5, 4, 6, 7};
  const auto corners = mesh.cell(cell);
  const auto& order = mesh.shape[cell] == CellShape::wedge ? kWedge : kSame;
  ElementCorners result;
  result.count = corners.size();
  for (std::size_t i = 0; i < result.count; ++i) result.at[i] = corners[order[i]];
  return result;
}

// Throws Error{usage} for a mesh with polyhedra.
void require_elements(const std::string& path, const VolumeMesh& mesh);

}  // namespace burnish
