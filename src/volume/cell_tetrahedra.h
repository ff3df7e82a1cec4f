// A batch of cells as tetrahedra [T-MESH-1], with phi at their corners.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "near_cells.h"

namespace burnish {

struct CellTetrahedra {
  struct Tetrahedron {
    std::array<std::uint32_t, 4> corner;  // of points
    std::uint32_t slot;                   // which of the batch's cells
    double volume;                        // negative: to be taken away
  };
  std::vector<Vec3> points;
  std::vector<double> phi;
  std::vector<Tetrahedron> tetrahedra;

  void clear();
  // The tetrahedra from the cell's middle to the triangles of its faces; no point twice.
  void add(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const NearCells& near, std::uint32_t cell, std::uint32_t slot);

 private:
  std::uint32_t add_point(const Vec3& p, double value);
  void add_tetrahedron(const std::array<std::uint32_t, 4>& corner, std::uint32_t slot, double sign);
  void add_face(const PolyhedralMesh& mesh, const NearCells& near, std::uint32_t face, std::uint32_t apex, std::uint32_t slot, double sign);

  std::vector<std::uint32_t> ids_;  // of the mesh's points in the cell, ascending; they come in this order from first_ on
  std::uint32_t first_ = 0;
};

}  // namespace burnish
