// An octree whose leaves are cells, refined by the facets of a file as they are: the thesis' octree as a result of its own.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/length.h"
#include "burnish/core/progress.h"
#include "burnish/core/timer.h"
#include "burnish/octree/refine.h"
#include "burnish/pipeline/field.h"

namespace burnish {

// As asked. With nothing set it is the octree of docs/benchmarks.md: cells from 1/160 to 1/5 of the longest side, max_face_limit 3,
// refine_tol 2.
struct CellOctreeJob {
  std::string input;               // a path, or "-" for standard input
  std::string output;              // a .vtu or .htg; empty: nothing is written
  std::optional<Length> cell;      // side of the finest cells, not in cells; at most one of it and `resolution`
  std::optional<int> resolution;   // cells along the longest side, 160 when neither is set
  std::optional<Length> cell_max;  // of cells that a facet cuts; a fifth of the longest side when not set
  RefinementLimits limits;         // `coarsest_level` follows from `cell_max`; max_face_limit 3 and refine_tol 2 where no criterion is set
  // What it may grow to: ended when 3000 bytes for each octant that is divided, and the lists, are more.
  std::uint64_t memory_bytes = std::uint64_t{4} << 30;
  std::optional<ModelUnit> unit;   // of the model; goes before what the file says of itself
  bool salvage = false;            // take what a broken input file holds
  bool overwrite = false;          // an existing output may be replaced
};

struct CellOctreeResult {
  std::string input;
  std::string input_format;
  std::optional<ModelUnit> unit;  // of the model's coordinates: as the job says, or else as the file does; empty: neither does
  std::vector<std::string> warnings;
  std::uint64_t facets = 0;
  double cell = 0;      // side of the finest cells, in model units
  double cell_max = 0;  // of the coarsest that a facet cuts: 2^coarsest_level times that
  double cells_along_longest_side = 0;
  RefinementLimits limits;
  GrowthStatistics statistics;  // `divided_by` as in criteria_of(limits)
  std::uint64_t bytes = 0;      // octree and lists of facets
  FieldFile output;
  std::vector<StageCost> stages;
};

// Reads and welds the input, grows the octree, writes it. Nothing is mended, capped or told inside from outside: sheets, holes and
// intersections are as good as any other facets.
//
// The file (io/field_files.h) has one cell for each leaf, with the arrays `level` (the side is 2^level finest cells), `facets` (whose
// centroid is in the cell: each facet counts once) and `facets_cut` (which meet it, touching included). Octants of
// a .htg that hold cells have -1 there.
//
// Throws Error: usage for an output of another suffix or a `cell_max` below the cell; guarantee_unmet for a model without
// extent; unreadable input, unwritable output; memory_limit for more than 2^20 cells along a side, or more cells than
// `memory_bytes` hold, or than can be written within it; interrupted.
CellOctreeResult cell_octree(const CellOctreeJob& job, Progress& progress = no_progress());

// The result as JSON text, as docs/cell_octree.schema.json says.
std::string to_json(const CellOctreeResult& result);

}  // namespace burnish
