// A hexahedra-dominant volume mesh on one side of a closed surface.
//
// Cells of an octree, graded 2:1. Where the surface passes, cells become body-centred cubic tetrahedra that are warped and cut to it (isosurface
// stuffing, Labelle & Shewchuk 2007); what is cut off a tetrahedron leaves a tetrahedron or a wedge with plane faces. All others stay hexahedra; pyramids and
// tetrahedra stand between them and finer ones. [T-HEX-1]
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/octree/grid_frame.h"
#include "burnish/surface/triangle_soup.h"
#include "burnish/volume/volume_mesh.h"

namespace burnish {

enum class MeshSide : std::uint8_t { inside, outside };

// Patches of the domain's sides.
inline constexpr std::array<std::string_view, 6> kDomainPatches{"xMin", "xMax", "yMin", "yMax", "zMin", "zMax"};

enum class MeshFlavour : std::uint8_t {
  conforming,  // hexahedra, pyramids, tetrahedra, wedges: whatever reads meshes reads it
  polyhedral,  // hexahedra beside finer ones keep their place, with split faces: fewer cells, for OpenFOAM and VTK
};

struct MeshRefinement {
  Box3 box;         // one that misses what is meshed has no effect, and is noted
  double cell = 0;  // the longest side of cells that meet the box, up to 1.35 times that where the domain is stretched; at least 1/32 of those at the surface
};

// Layers of flat cells at the wall: heights first, first * ratio, first * ratio^2 ... from the wall inwards.
struct WallLayers {
  int count = 0;       // 0: none
  double first = 0;    // in the surface's units
  double ratio = 1.2;
};

// Outside: cells between the surface's box and each side of the domain.
inline constexpr double kLeastRoom = 4;

struct FlowMeshOptions {
  double cell = 0;           // side of the finest cells, those at the surface where it is not flat; in the surface's units
  MeshSide side = MeshSide::inside;
  Box3 domain;               // outside: the flow domain, at least kLeastRoom cells larger than the surface's box on each side; its sides are met exactly [T-HEX-8]
  MeshFlavour flavour = MeshFlavour::conforming;
  int coarsest_level = 4;    // cells are at most 2^coarsest_level times as large as `cell`; outside also so that four fit between surface and domain
  int flat_levels = 1;       // where the surface is flat its cells may be up to 2^flat_levels times as large
  double flat_angle = 45;    // degrees: flat is where normals turn by less within one cell of that size around [T-HEX-10]
  int cells_between_levels = 2;  // at least 1: rows of cells of one size before the next larger one
  std::vector<MeshRefinement> refinements;
  double crease_angle = 40;  // degrees: edges of the surface that are to be edges of the mesh; 180: none
  WallLayers layers;
  std::uint64_t memory_bytes = ~std::uint64_t{0};
};

// Where the layers are. Columns of points that would make a cell bad are lower than asked for, down to 0.3 of it, or are not there.
struct LayerCoverage {
  double wall_area = 0, covered_area = 0;       // covered: faces of the wall that have all layers
  double least_first = 0, greatest_first = 0;   // height of the first cells there
};

// What the mesh is, next to its quality (volume/mesh_quality.h).
struct FlowMesh {
  VolumeMesh mesh;
  GridFrame frame;                       // its lattice: cells of the finest level have side 2
  std::vector<std::uint64_t> cells_of_level;  // cells of the mesh by the size of the lattice's cell that they lie in, the finest first: of side 2 frame.cell, each twice the one before
  std::uint64_t crease_points = 0;       // boundary points on creases and corners of the surface
  std::uint64_t moved_back = 0;          // boundary points that quality kept from their place on the surface
  LayerCoverage layers;                  // in the surface's units
  std::vector<std::string> notes;        // what a user should know
};

// `surface`: closed, oriented outwards, without intersections, in model units. `patch_of_facet`: index into `patch_names` for each of its facets (empty: one
// patch, patch_names[0] or "surface"). Patches of the mesh: those names (type wall), which no face need have; in that order; outside also kDomainPatches (type patch).
// Same bits for any number of threads. Throws Error: memory_limit; usage for a domain too small and for a refinement too fine; guarantee_unmet where nothing of the side holds a cell; interrupted.
// 9 us a cell (of one CPU; 0.1 M cells a second), 0.8 kB a cell.
FlowMesh flow_mesh(const TriangleSoup& surface, const std::vector<std::uint32_t>& patch_of_facet, const std::vector<std::string>& patch_names, const FlowMeshOptions& options,
                   Progress& progress = no_progress());

}  // namespace burnish
