// Layers of flat cells at the wall of a volume mesh: columns of points from the wall inwards, prisms between them.
//
// The mesh is made and fitted as without layers; then it makes room for them, and its wall stays where it is with every crease. (snappyHexMesh does it in this order too; to mesh the side of
// an offset surface instead loses gaps narrower than the layers, and rounds or cuts what is sharp.)
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/volume/flow_mesh.h"
#include "stuffing.h"

namespace burnish {

// The mesh of `cells.cells`, whose points on the wall are on the surface. All in lattice units, the finest cells at the surface with side 2 `cell`.
//
// `mesh` is assembled from `cells`, with `source` as assemble() gives it, and fitted: its points' places count. `on_wall`: per boundary face. `layers.first` in lattice units.
// Afterwards `cells` has the layers' cells behind those there were, and places of all points; `on_surface` tells those of the new wall. `mesh` and `source` are assembled anew.
// What was told as areas and lengths is in lattice units. Same bits for any number of threads. Throws Error{interrupted}.
//
// [T-LAYER-1] Points on the wall get a direction, [T-LAYER-2] the mesh makes room, [T-LAYER-3] columns at bad cells get lower and vanish.
LayerCoverage grow_wall_layers(StuffedCells& cells, VolumeMesh& mesh, std::vector<std::uint32_t>& source, const std::vector<std::uint8_t>& on_wall, const WallLayers& layers, double cell, Progress& progress);

}  // namespace burnish
