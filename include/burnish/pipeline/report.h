// RepairReport: what a run found, did, and can vouch for.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/timer.h"
#include "burnish/pipeline/options.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/inspect.h"

namespace burnish {

// Raised when a field changes its meaning; new fields do not raise it. docs/report.schema.json.
inline constexpr int kReportVersion = 1;

// What was done to the input's facets before the level set saw them.
struct RepairActions {
  std::size_t degenerate_facets_dropped = 0;
  std::size_t duplicate_facets_dropped = 0;
  std::size_t points_welded_within_tolerance = 0;
  double weld_tolerance = 0;              // 0: welded by exact coordinates only
  std::size_t facets_flipped = 0;
  std::size_t open_loops_capped = 0;
  double cap_area = 0;                    // model units squared
  std::size_t ambiguous_regions = 0;      // whose side had to be decided node by node
  std::size_t interior_facets_ignored = 0;  // of overlapping bodies: no part of the outer surface
  std::size_t unresolved_facets = 0;      // of sheets, or details thinner than a cell, that the result does not show
  double unresolved_area = 0;             // theirs, model units squared
  std::size_t components_lost = 0;        // of the input, that the result has nothing of
  double area_lost = 0;                   // of theirs, model units squared
};

// The size of the discretisation.
struct GridSummary {
  std::uint64_t blocks = 0;          // leaves of the octree, 8 x 8 x 8 cells each
  std::uint64_t finest_blocks = 0;
  int levels = 0;
  std::uint64_t bytes_planned = 0;   // the estimate that was held against the memory budget
};

struct SmoothingSummary {
  double length = 0;          // model units; 0: none was asked for
  double flow_time = 0;       // model units squared
  int steps = 0;
  double volume_before = 0;   // of the level set's zero surface, before and after
  double volume_after = 0;
};

// A group of the input: a solid of an STL, a group of an OBJ or PLY.
struct GroupSummary {
  std::string name;        // as in the file, bytes untouched
  std::size_t facets = 0;  // as read, useless ones included
  double area = 0;         // model units squared
};

// The groups of a soup, in order; none for a soup that has none.
std::vector<GroupSummary> summaries_of_groups(const TriangleSoup& soup);

struct RepairReport {
  std::string input;
  std::string input_format;
  std::string output;
  std::string output_format;
  ResolvedOptions options;
  std::vector<GroupSummary> groups;  // of the input, as read
  Defects before;
  RepairActions actions;
  GridSummary grid;
  SmoothingSummary smoothing;
  Defects after;              // of the written file, read back
  Deviation deviation;        // of the written file, read back
  bool verified = false;      // the written file is a valid solid
  bool written = false;       // the output stands under its final name
  std::vector<std::string> warnings;
  std::optional<Error> failure;  // why the run could not deliver what it promises
  std::vector<StageCost> stages;
};

// The report as JSON text (UTF-8, two-space indent, trailing newline), as docs/report.schema.json says.
// Bytes of names that are not UTF-8 are replaced by U+FFFD.
std::string to_json(const RepairReport& report);

// One inspection as JSON text: what `burnish check --json` prints.
std::string to_json(const Defects& defects, const std::string& input, const std::string& format,
                    const std::vector<std::string>& warnings);

// {"error": {"code": ..., "exit_code": ..., "message": ..., "hint": ...}} as JSON text.
std::string to_json(const Error& error);

}  // namespace burnish
