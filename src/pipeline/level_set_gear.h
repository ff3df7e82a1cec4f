// The level set gear: the surface is rebuilt from the solid that it bounds, or from a shell about it.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "prepare_input.h"
#include "smoothing_plan.h"
#include "volume_input.h"

namespace burnish {

struct BuiltLevelSet {
  LevelSet level_set;
  std::vector<FacetRole> roles;  // of the prepared soup's facets, caps included
  // Those of them that have an area, which are what the octree's lists number. Not of a shell.
  std::vector<std::uint32_t> facets;
  Field<std::uint32_t> nearest;  // the prepared soup's facet nearest to each node, if it was asked for
  Field<std::uint8_t> certainty; // of each node's side (levelset/sign.h); empty: all are certain, or it is a shell
  std::size_t regions = 0;       // connected parts of the lattice that facets separate
  GrowthStatistics growth;       // of an adaptive octree (levelset/from_triangles.h)
};

// Closes the prepared input anew if openings are to stay and the rest is a sheet that has a top side: as a block.
void close_sheet(PreparedInput& prepared, const CleanOptions& asked, RepairReport& report);

// Builds the level set for the resolved options and tells report.grid, report.actions and report.warnings.
BuiltLevelSet build_level_set(const PreparedInput& prepared, RepairReport& report, Progress& progress);
// The same with another band, room or far field than smoothing and extraction need.
BuiltLevelSet build_level_set(const PreparedInput& prepared, const LevelSetOptions& set, RepairReport& report, Progress& progress);

// The level set of a volume, whose iso-surface the prepared input is: on the volume's own lattice, which report.options.cell has to be that of.
BuiltLevelSet build_level_set(const VolumeInput& volume, const PreparedInput& prepared, RepairReport& report, Progress& progress);

// Makes an octree with finest blocks only as coarse as report.options.adapt allows; tells report.grid.
void coarsen_level_set(LevelSet& level_set, RepairReport& report, Progress& progress);

// Smooths as the plan and report.options say; tells report.smoothing and report.warnings.
void smooth_level_set(LevelSet& level_set, const SmoothingPlan& plan, RepairReport& report, Progress& progress);

// Moves the surface by report.options.offset, then leaves a wall of report.options.hollow of what it bounds.
void move_walls(LevelSet& level_set, const ResolvedOptions& options, Progress& progress);

// Leaves out debris: small pieces of the extracted surface (lattice coordinates) that stand for no component of the
// input. Returns their facets. A component of the input keeps its piece, however small. [T-DEBRIS-1]
std::vector<Facet> leave_out_debris(TriangleSoup& surface, const PreparedInput& prepared, const GridFrame& frame);

// The surface (in model units, welded) without what closes the openings that are to stay: those wider than
// `options.max_hole`, which is set. [T-TRIM-1]
TriangleSoup without_kept_caps(const TriangleSoup& surface, const PreparedInput& prepared, const ResolvedOptions& options);

}  // namespace burnish
