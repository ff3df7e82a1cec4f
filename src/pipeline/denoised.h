// Denoising on facets, within either gear.
#pragma once

#include <optional>
#include <string>

#include "burnish/core/progress.h"
#include "burnish/pipeline/report.h"
#include "local_gear.h"
#include "smoothing_plan.h"

namespace burnish {

// A surface before and after its points were moved: the same facets.
struct Denoised {
  TriangleSoup before, after;
};

// A local repair with denoising in its middle.
struct DenoisedSolution {
  LocalSolution solution;  // `source`: the facet of the welded input that a facet was, before its points moved
  Denoised surface;        // closed, before what intersects was mended
};

// Closes the prepared input (`valid`: it is a solid as it is), moves its points, and mends what came to intersect. Empty, with the reason
// in `refusal`, if the repair is not a matter of single facets, or would lose something of the input.
// `float32`: the file will be rounded to it. Fills in report.smoothing and the local gear's lines of report.actions, and report.holes.
std::optional<DenoisedSolution> solve_denoised(const TriangleSoup& welded, const PreparedInput& prepared, const SmoothingPlan& plan, bool valid, bool float32,
                                               double tolerance, RepairReport& report, Progress& progress, std::string& refusal);

// What is wrong with the result, as read back, for something that was denoised and then mended: more than mending a few folds explains. Empty: nothing.
std::string objection_to_mending(const DenoisedSolution& solution, const TriangleSoup& result, double tolerance, const RepairReport& report);

// Moves the points of the prepared input, and of its caps' rims with them: outliers, and those that noise has moved, as the plan says. Fills in report.smoothing.
void denoise_prepared(PreparedInput& prepared, const SmoothingPlan& plan, RepairReport& report, Progress& progress);

}  // namespace burnish
