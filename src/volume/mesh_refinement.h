// Boxes in which a volume mesh is finer than at its surface, on its lattice.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burnish/octree/grid_frame.h"
#include "burnish/octree/refine.h"
#include "burnish/volume/flow_mesh.h"

namespace burnish {

// In finest cells of the mesh, lower corner included, upper excluded.
struct LatticeBox {
  std::array<std::int64_t, 3> lower{}, upper{};

  // How many octants of a level meet it.
  double octants(int level) const;
};

// Cells that meet the box are of this level or below.
struct LatticeRefinement {
  LatticeBox box;
  int level = 0;
  std::size_t number = 0;  // in FlowMeshOptions::refinements
};

// [T-HEX-8] Beyond the surface's box the lattice is stretched so that the domain's sides come to lie exactly where they were asked for. All in lattice units.
struct DomainStretch {
  Box3 body;     // within it nothing moves
  Box3 lattice;  // sides of the lattice's region
  Box3 domain;   // where they go; the same where nothing is stretched

  Vec3 to_domain(const Vec3& q) const;
  Vec3 to_lattice(const Vec3& r) const;  // the inverse
};

// Takes refinements that do not meet `meshed` away, and tells of each in `notes`.
void drop_refinements_beside(const Box3& meshed, std::vector<MeshRefinement>& refinements, std::vector<std::string>& notes);

// How many levels of cells there have to be below those at the surface. Throws Error{usage} for a box that asks for more than `most`, naming it.
int levels_below_surface(const FlowMeshOptions& options, int most);

// The refinements as the lattice has them, of no larger cells than the coarsest, and cut to `cells`: the part of its region where cells may be of the mesh.
std::vector<LatticeRefinement> on_lattice(const FlowMeshOptions& options, const GridFrame& frame, const DomainStretch& stretch, const LatticeBox& cells, int surface_level);

// Where the level set has to be finer than cells at the surface ask for: around the refinements, as far as cells of each level below that of the surface reach.
std::vector<LevelInBox> level_set_boxes(std::span<const LatticeRefinement> refinements, int cells_between_levels, int surface_level);

}  // namespace burnish
