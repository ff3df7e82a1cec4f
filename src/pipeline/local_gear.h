// The local gear: broken facets are mended, all others come out as they went in.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/local_repair.h"
#include "burnish/surface/triangle_soup.h"
#include "prepare_input.h"

namespace burnish {

// A surface to be written.
struct LocalSolution {
  TriangleSoup soup;                  // welded
  std::vector<std::uint32_t> source;  // facet of the welded input with the same points, or kNoFacet
  std::vector<char> fills_hole;
  bool united = false;                // bodies that overlapped were united: what lies inside is gone
};

// Why these options rule the local gear out, or empty. `flows`: the level set is to be smoothed.
std::string reason_against_local(const CleanOptions& options, bool flows);

// Mends the prepared input. Empty, with the reason in `refusal`, if that is not a matter of single facets. The options' `max_hole` is
// report.options'. Fills in the local gear's lines of report.actions, and report.holes.
std::optional<LocalSolution> solve_locally(const TriangleSoup& welded, const PreparedInput& prepared, LocalRepairOptions options, RepairReport& report, Progress& progress,
                                           std::string& refusal);
// The solution for an input that is valid as it is.
LocalSolution unchanged(const TriangleSoup& welded);

// Measures the result, as read back, against the welded input where the two differ; fills in report.deviation and
// report.changes. Returns what is wrong with it: input or result farther than `tolerance` from the other, holes that were
// filled aside, or a volume that is not that of the prepared input. Empty: nothing.
std::string objection_to(const LocalSolution& solution, const TriangleSoup& result, const TriangleSoup& welded,
                         const PreparedInput& prepared, double tolerance, RepairReport& report);

// Whether two facets have the same points, whichever way round.
bool has_same_points(const TriangleSoup& a, std::size_t f, const TriangleSoup& b, std::size_t g);

// Whether 4096 points all over the box are inside both closed surfaces or outside both, by winding numbers: up to 0.5 % of those inside, and the
// share `more` of them.
bool is_same_solid(const TriangleSoup& before, const TriangleSoup& after, double more);

}  // namespace burnish
