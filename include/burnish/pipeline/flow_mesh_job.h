// A volume mesh for flow simulation from a triangle file, however dirty: repaired, meshed, measured, judged, written.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/progress.h"
#include "burnish/core/timer.h"
#include "burnish/io/volume_files.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/compare.h"
#include "burnish/volume/flow_mesh.h"
#include "burnish/volume/mesh_quality.h"

namespace burnish {

std::string_view name(MeshSide side);        // "inside", "outside"
std::string_view name(MeshFlavour flavour);  // "conforming", "polyhedral"

// Of the cells at the surface where neither a cell nor a number of cells is asked for: the longest side over this.
inline constexpr double kMeshCellsAlongLongestSide = 100;

// How thick layers may be together, in cells at the surface; and how flat a cell can be that passes checkMesh.
inline constexpr double kThickestLayers = 1.5, kFlattestLayer = 0.035;

// What is meshed outside of the model.
struct MeshDomain {
  std::optional<Box3> box;       // this, or
  std::optional<Length> margin;  // the model's box and so much around it; with neither, its longest side
};

struct BoxWithCell {
  Box3 box;
  Length cell;
};

// Layers of flat cells at the wall.
struct LayersWanted {
  int count = 0;                // 0: none
  std::optional<Length> first;  // height of the cells at the wall; else such that all layers together are half a cell thick
  double ratio = 1.2;           // of the heights of a layer and the one before it
};

// Lengths are in the units of the model's file, whatever `scale` is.
struct FlowMeshJob {
  std::string input;                    // a path, or "-" for standard input
  std::string output;                   // a file or a case (io/volume_files.h); empty: nothing is written
  MeshSide side = MeshSide::inside;
  MeshDomain domain;                    // outside only
  MeshFlavour flavour = MeshFlavour::conforming;
  std::optional<Length> cell;           // side of cells at the surface; or
  std::optional<std::uint64_t> cells;   // about so many cells
  std::vector<BoxWithCell> refinements;
  int coarsest_level = 4;
  int flat_levels = 1;       // see FlowMeshOptions
  double flat_angle = 45;
  int cells_between_levels = 2;
  LayersWanted layers;                  // at most kThickestLayers cells thick
  double crease_angle = kCreaseAngle;   // degrees; 180: no edge is one of the mesh
  bool one_patch = false;               // else one patch for each group of the file (solid of an STL)
  std::vector<std::pair<std::string, std::string>> patch_types;  // of patches, by their names in the mesh
  double scale = 1;                     // what is written has its coordinates multiplied by this
  // Repair and smoothing, as in `clean`. A level set that is needed for it has cells of half the mesh's, unless its cell is set here, smoothing
  // needs smaller ones, or the memory budget larger ones.
  CleanOptions options;
  VolumeWriteOptions write{.overwrite = false};
  bool salvage = false;                 // take what a broken input file holds
  bool allow_invalid = false;           // write the mesh even if its quality is not what it has to be
};

// What `cells` was tried with.
struct MeshTrial {
  double cell = 0;
  std::uint64_t cells = 0;
};

struct MeshedPatch {
  std::string name;
  std::string type;
  std::string group;        // of the input, bytes untouched; empty: none
  std::size_t faces = 0;
  double area = 0;
};

// A cell that fails a check.
struct BadPlace {
  std::string check;
  std::uint32_t cell = 0;
  double value = 0;
  Vec3 at;                  // the mean of its corners
};

// The model after repair.
struct MeshedSolid {
  std::size_t facets = 0;
  std::size_t components = 0, cavities = 0;  // of its surface: cavities are components, too
  double volume = 0, area = 0;
  Box3 box;
  std::string repair;       // "local" or "levelset"
  std::string repair_reason;
  double cell = 0;          // of the level set; 0: none was needed
};

struct MeshedLayers {
  int count = 0;                                // 0: none were asked for
  double first = 0, ratio = 0, thickness = 0;   // as asked for
  double covered = 0;                           // share of the wall's area with all layers
  double least_first = 0, greatest_first = 0;   // height of the first cells there
};

struct MeshCost {
  double seconds = 0;       // CPU time of meshing itself, without trials, repair and measuring
  double cells_per_second = 0;
  std::uint64_t peak_bytes = 0;  // of the whole run
};

// In model units.
struct FlowMeshResult {
  std::string input, input_format;
  std::optional<ModelUnit> unit;  // of the model's coordinates: as the job says, or else as the file does; empty: neither does
  std::string output, output_format;      // empty: nothing was to be written
  bool written = false;
  std::vector<std::string> warnings;
  std::optional<Error> failure;           // the input bounds no solid, nothing could be meshed, or the quality is not what it has to be
  MeshedSolid solid;

  bool meshed = false;                    // what follows means something
  MeshSide side = MeshSide::inside;
  MeshFlavour flavour = MeshFlavour::conforming;
  double cell = 0, cells_along_longest_side = 0;
  bool cell_was_chosen = false;           // by the default, or by a number of cells
  std::optional<std::uint64_t> cells_wanted;
  std::vector<MeshTrial> trials;
  Box3 box;                               // of the mesh
  double finest_cell = 0;                 // side; below `cell` where refinements are
  std::vector<std::uint64_t> cells_of_level;  // cells by size: finest_cell first, each twice the one before (see FlowMesh)
  std::uint64_t moved_back = 0;           // boundary points that quality kept from their place on the surface
  double smallest_cell = 0, largest_cell = 0;  // volumes
  MeshedLayers layers;
  std::vector<MeshedPatch> patches;
  MeshQuality quality;
  bool good = false;                      // what is promised holds: the full check of a conforming mesh, the plain one of a polyhedral one
  std::vector<BadPlace> bad_places;       // by check, then by cell; of each check the first 1000
  double volume_wanted = 0;               // of the repaired solid, or of what it leaves of the domain
  std::size_t regions_wanted = 0;         // one for each part of that
  OneSidedDistance surface_to_patches, patches_to_surface;
  std::vector<Loss> losses;               // parts of the surface farther than a cell and a half from the patches
  MeshCost cost;
  std::vector<StageCost> stages;
};

// Reads, repairs as `clean` does, meshes (volume/flow_mesh.h), and measures quality as OpenFOAM's checkMesh does (volume/mesh_quality.h).
//
// **Promise.** What is written passes `checkMesh -allTopology -allGeometry`, or plain `checkMesh` for the polyhedral flavour, by our measures. A mesh that does not
// comes back as `failure` (guarantee_unmet) that names checks and places, and is not written, unless `allow_invalid`.
//
// **Patches.** One for each group of the file that has facets in the repaired surface, its name made a word of OpenFOAM, unique among all; facets of the repair take the
// group of the nearest one. Outside, the domain's sides alone are xMin, xMax, yMin, yMax, zMin, zMax.
//
// **Cells.** A number of cells is met within 10 % in three meshes at most, the first a smaller one; the last one counts, whatever it has; so does the last
// that fits into memory, with a warning. Cells are no larger than the domain has room for.
//
// **Scale.** What is judged is what is written, scaled coordinates and all; what is told of it is in the model's units.
//
// Same bits for any number of threads. An input that bounds no solid, a cell that is too large for any of it, layers that have no room in the cells that a number of them took, and a
// finished mesh that cannot be written, for whatever reason, come back as `failure` as well.
// Throws Error as `clean` does, Error{unwritable_output} before the work as far as that can be known then; Error{usage} for a domain that does not hold the model, for the type of a patch that
// does not exist, and for two types of one patch.
FlowMeshResult flow_mesh(const FlowMeshJob& job, Progress& progress = no_progress());

// The result as JSON text, as docs/mesh.schema.json says: what `burnish mesh --json` prints.
std::string to_json(const FlowMeshResult& result);
// Its quality alone, null without a mesh: $defs/quality of the same schema, what `--quality` writes.
std::string quality_to_json(const FlowMeshResult& result);

}  // namespace burnish
