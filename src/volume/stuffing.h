// Isosurface stuffing on the cells of a lattice: nodes near the surface move onto it, cells that it passes are cut along it. [T-HEX-3] [T-HEX-4]
//
// Labelle & Shewchuk, Isosurface stuffing: fast tetrahedral meshes with good dihedral angles, SIGGRAPH 2007: what they cut into tetrahedra with a rule for
// diagonals stays a wedge or a pyramid here, with plane faces on the sides of the tetrahedron.
#pragma once

#include <cstdint>
#include <initializer_list>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/volume/volume_mesh.h"
#include "lattice_nodes.h"

namespace burnish {

// Cells by their corners, before faces are known. Corners of polyhedra: the number of faces, and for each face the number of its points and these, normals outwards.
struct CellList {
  std::vector<CellShape> shape;
  std::vector<std::uint64_t> first{0};
  std::vector<std::uint32_t> corners;

  void add(CellShape s, std::initializer_list<std::uint32_t> points) {
    shape.push_back(s);
    corners.insert(corners.end(), points);
    first.push_back(corners.size());
  }
  std::size_t size() const { return shape.size(); }
};

struct StuffedCells {
  CellList cells;
  std::vector<Vec3> points;             // in lattice units: the lattice's nodes, points on edges that the surface cuts, then middles of faces at the domain's end
  std::vector<std::uint8_t> on_surface; // per point
};

// The cells of the lattice on the side where phi > 0 (`sign` 1) or < 0 (-1). Same result for any number of threads.
StuffedCells stuff(const CellLattice& lattice, const LevelSet& set, int sign, MeshFlavour flavour, const CreaseTarget& crease, Progress& progress);

}  // namespace burnish
