// The main job: a dirty file in, a verified clean one out.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

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
  std::vector<std::array<std::uint32_t, 2>> intersecting_before{};  // facets of `before`, as Inspection::self_intersections; may be left empty
};

// The same, and fills in `surfaces`.
RepairReport clean(const CleanJob& job, CleanSurfaces& surfaces, Progress& progress = no_progress());

// Of the coordinates of a result that stays in memory: as a .ply stores them, or as an STL does.
enum class Precision { float64, float32 };

struct CleanedSurface {
  RepairReport report;   // its output has no name and is never `written`
  TriangleSoup surface;  // at that precision, with the input's groups and colours; what was found where the run failed, no facets if nothing was
};

// The same without files. Points and facets are those that `clean` would write to .ply (float64), in the same order, or to .stl (float32), welded; what is
// verified is the surface as it is returned. Look at `report.failure` before you use it. `input` need not be welded; names and colours are kept.
// Throws Error as `clean` does: Error{unreadable_input} for a soup without facets, Error{usage} for options of volumes, and
// Error{unwritable_output} for coordinates beyond the range of float32 that are to be rounded to it.
// The input is taken over, not copied, if it is moved.
CleanedSurface clean(TriangleSoup input, const CleanOptions& options, Precision precision = Precision::float64, Progress& progress = no_progress());

// Of a job whose output is not looked at.
CleanedSurface clean_to_memory(const CleanJob& job, Precision precision = Precision::float64, Progress& progress = no_progress());

}  // namespace burnish
