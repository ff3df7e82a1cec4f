// Comparing two files: how far apart their surfaces are, where, and by how much their sizes differ.
#pragma once

#include <algorithm>
#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/length.h"
#include "burnish/core/progress.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/signed_deviation.h"

namespace burnish {

struct CompareJob {
  std::string a, b;              // paths; one of them may be "-" for standard input
  bool salvage = false;          // take what a broken input file holds
  bool exact = false;            // distances by rational arithmetic (surface/exact_distance.h)
  std::size_t samples = 200'000; // of each surface: by area, and as many of the vertices at most
  std::optional<Length> max;     // the largest distance for which the answer is yes; not in cells
  std::string output;            // where to write A with its deviation from B (.vtp or .ply); empty: nowhere
  bool overwrite = false;        // an existing `output` may be replaced
};

struct ComparedFile {
  std::string file;
  std::string format;
  std::vector<std::string> warnings;  // of the reader
  Defects measures;                   // after welding by exact coordinates; self-intersections are not looked for
  std::optional<double> volume;       // of closed surfaces only
  std::string no_volume_reason;       // empty if there is a volume
};

struct CompareResult {
  ComparedFile a, b;
  bool exact = false;
  double diagonal = 0;  // of A's bounding box: what percentages refer to
  OneSidedComparison a_to_b, b_to_a;
  std::optional<double> limit;     // CompareJob::max in model units
  std::optional<SideRule> sign;    // how the sides of the output were told; empty without output

  // The symmetric Hausdorff distance of the samples: a lower bound of that of the surfaces.
  double max() const { return std::max(a_to_b.distance.max, b_to_a.distance.max); }
  bool within_limit() const { return !limit || max() <= *limit; }
};

// Reads both files, welds and measures them, and takes the distances between them both ways.
//
// `output` holds A's surface, welded, with two numbers at each point: `deviation`, the distance from B, positive outside of
// B and negative inside, and `distance`, the same without its sign. Which rule tells the sides follows from B: SideRule.
//
// Throws Error as `read_mesh` and OutputFile do, and Error{usage} for an `output` of another suffix, before anything is read.
// Same bytes for any number of threads.
CompareResult compare_files(const CompareJob& job, Progress& progress = no_progress());

// The result as JSON text, as docs/compare.schema.json says: what `burnish compare --json` prints.
std::string to_json(const CompareResult& result);

}  // namespace burnish
