// The level set itself as a result: built as `clean` builds it, reported, checked against exact distances, written.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/accepted.h"
#include "burnish/levelset/redistance.h"
#include "burnish/levelset/verify.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"

namespace burnish {

// What a cell of the written file is.
enum class FieldCells {
  near,    // a cell of the octree in blocks near the surface; beyond them a block
  blocks,  // a block: the octree itself
  cells,   // a cell of the octree everywhere
};

std::string_view name(FieldCells cells);  // "near", "blocks", "cells"

// Which nodes keep the exact distances to the facets, where all others are recomputed from them.
enum class ExactNodes {
  cells,  // those of the thesis' ACCEPTED cells (levelset/accepted.h)
  band,   // all within the band
};

std::string_view name(ExactNodes nodes);  // "cells", "band"

// Arrays of cells in a .vtu or .htg, as docs/formats.md describes them.
enum class FieldArray : std::uint8_t { phi, level, inside, block, facet, curvature, sign_confidence, accepted };
inline constexpr std::size_t kFieldArrays = 8;

// "phi", "level", "inside", "block", "facet", "mean_curvature", "sign_confidence", "accepted": names in the file.
std::string_view name(FieldArray array);

// What is written, beside FieldCells.
struct FieldContent {
  std::vector<FieldArray> arrays;     // of a .vtu or .htg; empty: all that there are
  bool cell_centred = false;          // of a .vtu: no values at points
  // Distances that matter. A .vtu has no cells whose centre is farther from the surface; elsewhere |phi| ends there. Of a .vdb half the band's width;
  // unset: 3 voxels.
  std::optional<Length> narrow_band;
  // Of a .vti or .nrrd: what it covers (unset: the model's box and 5 % of its longest side around it), and how finely: nodes along the
  // box' longest side, or the distance between nodes; neither: the finest cell.
  std::optional<Box3> box;
  std::optional<int> samples;
  std::optional<Length> spacing;
};

struct FieldJob {
  std::string input;          // a path, or "-" for standard input
  std::string output;         // a .vtu, .htg, .vti, .nrrd or .vdb; empty: nothing is written
  FieldContent content;
  // Those of preparation, resolution and smoothing. A mode that works on facets is applied before distances, a flow to the level set, after which
  // distances of the whole domain are computed anew. Thickness, walls and extraction are not looked at.
  CleanOptions options;
  double band = 3;            // cells of exact distances on both sides of the surface, of the level of the cells there
  // The thesis' criteria for dividing blocks, beside options.adapt; the coarsest level follows from options.cell_max. With
  // neither all blocks near the surface are finest.
  RefinementLimits limits;
  // The thesis' way to a full field (section 4.4.2): beyond `exact` nodes by this method. Unset: by the facets (levelset/far_field.h).
  std::optional<RedistanceMethod> redistance;
  ExactNodes exact = ExactNodes::cells;
  FieldCells cells = FieldCells::near;
  std::size_t verify = 0;     // nodes to compare with exact distances
  bool salvage = false;       // take what a broken input file holds
  bool overwrite = false;     // an existing output may be replaced
};

// The band that a job needs, in cells: with ACCEPTED cells 3.5, so that their distances are exact; twice that if blocks of several levels may meet there.
double least_band(const FieldJob& job);

// Blocks of one level.
struct FieldLevel {
  std::uint64_t blocks = 0;
  std::uint64_t near_blocks = 0;  // of them, within the band of a facet
};

// The octree and what it carries.
struct FieldGrid {
  std::uint64_t blocks = 0;         // leaves, 8 x 8 x 8 cells each
  std::uint64_t finest_blocks = 0;
  std::uint64_t near_blocks = 0;    // within the band of a facet
  std::uint64_t nodes = 0;          // that the blocks store
  int levels = 0;
  std::vector<FieldLevel> by_level; // 0, the finest, first
  std::uint64_t bytes = 0;          // octree, lists of facets, and phi
  std::uint64_t bytes_planned = 0;  // of the whole run: the estimate that was held against the memory budget
};

// In model units cubed.
struct FieldVolume {
  double input = 0;      // as the input is oriented, by the divergence theorem
  double prepared = 0;   // of the closed chain that the level set was built from
  double level_set = 0;  // of {phi >= 0}
};

// How the field came about beyond the nodes that are exact.
struct FieldRedistancing {
  RedistanceMethod method = RedistanceMethod::closest;
  ExactNodes exact = ExactNodes::cells;
  std::uint64_t cells_cut = 0;       // by facets of the solid's surface
  std::uint64_t cells_accepted = 0;  // these and their neighbours
  std::uint64_t exact_nodes = 0;
  RedistanceResult result;
};

struct FieldFile {
  std::string file;      // empty: none was asked for
  std::string format;
  FieldCells cells = FieldCells::near;
  bool written = false;
  std::uint64_t cell_count = 0;
  std::uint64_t point_count = 0;   // of a .vtu
  std::uint64_t octant_count = 0;  // of a .htg: cells, and what holds them
  std::array<std::uint32_t, 3> samples{};  // of a .vti or .nrrd: nodes along x, y, z
  double spacing = 0;              // of these, and the voxel of a .vdb, in model units
  std::uint64_t voxel_count = 0;   // of a .vdb: in the band
  std::uint64_t bytes = 0;
};

struct FieldResult {
  std::string input;
  std::string input_format;
  std::optional<ModelUnit> unit;  // of the model's coordinates: as the job says, or else as the file does; empty: neither does
  std::vector<std::string> warnings;
  ResolvedOptions options;
  double band = 0;                    // cells
  Defects before;                     // of the input
  RefinementLimits limits;
  GrowthStatistics growth;            // of an adaptive octree; `divided_by` as in criteria_of(limits), then options.adapt
  std::size_t regions = 0;            // connected parts of the lattice that facets separate
  std::size_t ambiguous_regions = 0;  // whose side had to be decided node by node
  std::size_t facets = 0;             // with an area, caps included: what the level set was built from
  std::size_t interior_facets = 0;    // of them, inside the solid: no part of its surface
  std::size_t unresolved_facets = 0;  // of them, outside on both sides: sheets, or walls thinner than a cell
  FieldGrid grid;
  FieldVolume volume;
  SmoothingSummary smoothing;
  std::optional<FieldRedistancing> redistancing;
  std::optional<DistanceCheck> verification;
  FieldFile output;
  std::optional<Error> failure;       // the input bounds no solid: there is no field
  std::vector<StageCost> stages;

  bool is_adaptive() const { return !growth.levels.empty(); }
};

// Reads, inspects and prepares the input and builds its level set, as `clean` does with the level set gear, but with distances in the
// whole domain (levelset/far_field.h, or redistancing if that is asked for); compares nodes with exact distances and writes the file, if asked to.
//
// The file (io/field_files.h; docs/formats.md) has a cell for each cell of the octree in blocks with facets within the band, and one
// for each block beyond them, unless `cells` says otherwise. Other formats have phi at the nodes of a uniform grid, or a narrow band of voxels: the
// distance to the facets, exact but for rounding within the band, beyond it up to 1 % too large; of a field that was smoothed or
// redistanced the tricubic interpolant of its nodes, off by O(h^4) where that is smooth. The file is written also when a comparison fails.
//
// An input that bounds no solid comes back as `failure`. Throws Error for everything else: usage for an output of another suffix, for a band below
// least_band, and for smoothing beside a comparison or ACCEPTED cells, before anything is read; unreadable input, unwritable output; memory_limit, also when the cells are too many to be written within
// the budget; interrupted.
FieldResult field(const FieldJob& job, Progress& progress = no_progress());

// The result as JSON text, as docs/field.schema.json says: what `burnish field --json` prints.
std::string to_json(const FieldResult& result);

}  // namespace burnish
