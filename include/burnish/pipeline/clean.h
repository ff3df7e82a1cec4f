// The main job: a dirty file in, a verified clean one out.
#pragma once

#include <string>

#include "burnish/core/progress.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct CleanJob {
  std::string input;          // a path, or "-" for standard input
  std::string output;         // a path, or "-" for standard output (binary STL)
  CleanOptions options;
  bool salvage = false;       // take what a broken input file holds
  bool overwrite = false;     // an existing output may be replaced
  bool allow_invalid = false; // write the result even if it could not be verified
};

// Reads, repairs, smooths, extracts, writes, reads back, verifies and measures.
//
// The output appears under its name only once it is complete, and only if it is verified (or
// `allow_invalid`). A result that is not verified, or an input that bounds no solid, comes back as
// `report.failure` (guarantee_unmet), so that the report can still be looked at.
// Throws Error for everything else: unreadable input, unwritable output, memory_limit, interrupted.
RepairReport clean(const CleanJob& job, Progress& progress = no_progress());

// The two surfaces of a run, for those that look at them: welded, in model coordinates (behind --recentre: the moved ones).
struct CleanSurfaces {
  TriangleSoup before;  // as read
  TriangleSoup after;   // as written and read back; what was found where the run failed, no facets if nothing was
};

// The same, and fills in `surfaces`.
RepairReport clean(const CleanJob& job, CleanSurfaces& surfaces, Progress& progress = no_progress());

}  // namespace burnish
