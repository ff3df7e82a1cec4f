// The level set gear: the surface is rebuilt from the solid that it bounds, or from a shell about it.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "prepare_input.h"

namespace burnish {

struct BuiltLevelSet {
  LevelSet level_set;
  std::vector<FacetRole> roles;  // of the prepared soup's facets, caps included
};

// Builds the level set for the resolved options and tells report.grid, report.actions and report.warnings.
BuiltLevelSet build_level_set(const PreparedInput& prepared, RepairReport& report, Progress& progress);

// Smooths as report.options say; tells report.smoothing and report.warnings.
void smooth_level_set(LevelSet& level_set, RepairReport& report, Progress& progress);

// The surface (in model units, welded) without what closes the openings that are to stay: those wider than
// `options.max_hole`, which is set. [T-TRIM-1]
TriangleSoup without_kept_caps(const TriangleSoup& surface, const PreparedInput& prepared, const ResolvedOptions& options);

}  // namespace burnish
