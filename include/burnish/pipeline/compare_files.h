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
#include "burnish/surface/registration.h"
#include "burnish/surface/signed_deviation.h"
#include "burnish/surface/truth_error.h"

namespace burnish {

// B is taken for the truth, and A for a result that should be it: what is asked of how far it is off.
struct TruthJob {
  double crease_angle = 30;            // of the truth's edges that are creases, more than this between their facets' normals, in degrees
  std::optional<Length> crease_width;  // what is this near to one is "near creases"; not in cells; unset: the truth's mean edge
  std::string input;  // what the result was made from: its volume is compared too; empty: nothing
  std::string floor;  // what the way from input to result makes of the truth itself: the error that is not the noise's; empty: nothing
  std::string map;    // where to write A with its facets' errors (.vtp); empty: nowhere
};

struct CompareJob {
  std::string a, b;              // paths; one of them may be "-" for standard input
  std::optional<ModelUnit> unit;  // of both; goes before what the files say of themselves
  bool salvage = false;          // take what a broken input file holds
  bool exact = false;            // distances by rational arithmetic (surface/exact_distance.h)
  std::size_t samples = 200'000; // of each surface: by area, and as many of the vertices at most
  std::optional<Length> max;     // the largest distance for which the answer is yes; not in cells
  std::string output;            // where to write A with its deviation from B (.vtp or .ply); empty: nowhere
  bool overwrite = false;        // an existing output or map may be replaced
  bool align = false;            // first move A onto B, rigidly
  std::string aligned;           // where to write A as it was moved (a triangle file); empty: nowhere; asks for `align`
  std::optional<TruthJob> truth;
};

struct ComparedFile {
  std::string file;
  std::string format;
  std::vector<std::string> warnings;  // of the reader
  Defects measures;                   // after welding by exact coordinates; self-intersections are not looked for
  std::optional<double> volume;       // of closed surfaces only
  std::string no_volume_reason;       // empty if there is a volume
};

// A surface's error against the truth.
struct TruthFigures {
  TruthError error;
  std::optional<double> volume_percent;  // its volume less the truth's, in percent of that; of closed surfaces only
};

struct FloorFigures {
  ComparedFile file;
  TruthFigures figures;
};

struct InputFigures {
  ComparedFile file;
  std::optional<double> volume_percent;  // the result's volume less the input's, in percent of that; of closed surfaces only
};

struct TruthComparison {
  double mean_edge = 0;     // of the truth, in model units
  double crease_angle = 0;  // degrees
  double crease_width = 0;  // model units
  std::size_t creases = 0;  // edges
  double crease_length = 0; // of these together, in model units
  TruthFigures result;
  std::optional<InputFigures> input;
  std::optional<FloorFigures> floor;
};

struct CompareResult {
  std::optional<ModelUnit> unit;   // as the job says, or else as A does; empty: neither does
  ComparedFile a, b;
  bool exact = false;
  double diagonal = 0;  // of A's bounding box: what percentages refer to; after it was moved, if it was
  std::optional<Registration> alignment;  // that moved A; everything else is told of A at its new place
  OneSidedComparison a_to_b, b_to_a;
  std::optional<double> limit;     // CompareJob::max in model units
  std::optional<SideRule> sign;    // how the sides of the output were told; empty without output
  std::optional<TruthComparison> truth;

  // The symmetric Hausdorff distance of the samples: a lower bound of that of the surfaces.
  double max() const { return std::max(a_to_b.distance.max, b_to_a.distance.max); }
  bool within_limit() const { return !limit || max() <= *limit; }
};

// Reads both files, welds and measures them, and takes the distances between them both ways.
//
// `output` holds A's surface, welded, with two numbers at each point: `deviation`, the distance from B, positive outside of
// B and negative inside, and `distance`, the same without its sign. Which rule tells the sides follows from B: SideRule.
//
// With `truth`, A's normals and distances are compared with B's as surface/truth_error.h says, and the same is done with a floor. Its map holds
// A's surface with two numbers at each facet, taken at its centroid: `angle_error` in degrees and `distance_error` in model units.
//
// With `align`, A is moved onto B as surface/registration.h says before anything is measured but counts. Fits that are poor, or not unique, are
// told in `alignment`, and are no error.
//
// Throws Error as `read_mesh` and OutputFile do, and Error{usage} for an `output` of another suffix, before anything is read.
// Same bytes for any number of threads.
CompareResult compare_files(const CompareJob& job, Progress& progress = no_progress());

// The same of two surfaces in memory, welded or not: of the job, `unit`, `exact`, `samples`, `max` and `align` count.
CompareResult compare_surfaces(TriangleSoup a, TriangleSoup b, const CompareJob& job, Progress& progress = no_progress());

// The distance of each point from the surface, welded or not, in model units: positive outside and negative inside, as SideRule tells for it.
// `exactly`: off by one rounding (surface/exact_distance.h); else by a few roundings of the coordinates, about 15 times faster.
// Same bits for any number of threads. Throws Error as `compare_files` does.
std::vector<double> signed_distances(TriangleSoup surface, const std::vector<Vec3>& points, bool exactly, Progress& progress = no_progress());

// The result as JSON text, as docs/compare.schema.json says: what `burnish compare --json` prints.
std::string to_json(const CompareResult& result);

}  // namespace burnish
