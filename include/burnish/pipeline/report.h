// RepairReport: what a run found, did, and can vouch for.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/timer.h"
#include "burnish/core/model_unit.h"
#include "burnish/pipeline/check.h"
#include "burnish/pipeline/options.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/hole.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/noise.h"
#include "burnish/surface/validate.h"

namespace burnish {

// Raised when a field changes its meaning; new fields do not raise it. docs/report.schema.json.
inline constexpr int kReportVersion = 1;

// What was done to the input's facets. Either gear drops, welds, flips and caps; then each has lines of its own.
struct RepairActions {
  std::size_t degenerate_facets_dropped = 0;
  std::size_t duplicate_facets_dropped = 0;
  std::size_t wall_facets_dropped = 0;    // copies back to back, between two bodies or of a sheet
  std::size_t fragments_dropped = 0;      // stray components, dirt beside the model; `--smooth auto`
  std::size_t points_welded_within_tolerance = 0;
  double weld_tolerance = 0;              // 0: welded by exact coordinates only
  std::size_t facets_flipped = 0;
  std::size_t open_loops_capped = 0;
  double cap_area = 0;                    // model units squared
  std::size_t ambiguous_regions = 0;      // whose side had to be decided node by node
  std::size_t interior_facets_ignored = 0;  // of overlapping bodies: no part of the outer surface
  std::size_t unresolved_facets = 0;      // of sheets, or details thinner than a cell, that the result does not show
  double unresolved_area = 0;             // theirs, model units squared
  // The level set gear's.
  std::size_t components_lost = 0;        // of the input, that the result has nothing of
  double area_lost = 0;                   // of all parts that it is not near to, model units squared
  std::size_t debris_dropped = 0;         // small pieces of the surface that stand for no component of the input
  // The local gear's.
  std::size_t facets_cut = 0;             // that met others, where bodies were united
  std::size_t needles_flipped = 0;        // facets without an area, taken out by flipping an edge
  std::size_t points_split = 0;           // that several fans shared, and were moved apart
  double largest_split = 0;               // how far, model units
  std::size_t intersecting_pairs_removed = 0;
  std::size_t facets_kept = 0;            // bit for bit
  std::size_t facets_moved = 0;           // whose points were denoised
  std::size_t facets_removed = 0;         // of the input
  std::size_t facets_added = 0;           // to it
};

// What became of a component of the input, and why.
struct ComponentFate {
  Vec3 position;          // a point on it
  std::size_t facets = 0;
  double area = 0;
  double volume = 0;      // signed, as oriented in the end
  std::string fate;       // "kept", "cavity", "merged", "absorbed", "dropped", "lost"
  std::string reason;     // empty for "kept"
};

// A part of the input that the result is not near to.
struct Loss {
  Vec3 position;          // where the input is farthest from the result
  double distance = 0;    // how far
  double area = 0;        // of the input's surface concerned, model units squared
  std::size_t samples = 0;
  std::string reason;
};

// A place where the local gear changed facets.
struct Change {
  Vec3 position;          // middle of its box
  double extent = 0;      // the box' diagonal
  std::size_t facets_removed = 0, facets_added = 0;
};

// The size of the discretisation.
struct GridSummary {
  std::uint64_t blocks = 0;          // leaves of the octree, 8 x 8 x 8 cells each
  std::uint64_t finest_blocks = 0;
  int levels = 0;
  std::uint64_t bytes_planned = 0;   // the estimate that was held against the memory budget
};

// In model units and their powers.
struct SmoothingSummary {
  SmoothMode mode = SmoothMode::automatic;  // automatic: nothing was smoothed
  std::string mode_reason;    // why that one; empty if no smoothing was asked for
  NoiseEstimate noise;        // of the prepared input
  std::size_t outliers = 0;   // points that were displaced by more than the noise allows, and were put back
  double rms_moved = 0;       // of the surface along its normals
  double max_moved = 0;       // of points of the facets; 0 for a level set
  double deviation = 0;       // between the repaired surface and the result, the largest either way; measured if a bound was given
  double length = 0;          // waves below it were removed; 0: what was noise
  double flow_time = 0;       // model units squared
  int steps = 0;
  RedistanceMethod redistance = RedistanceMethod::closest;  // what keeps the flow a distance function
  double volume_before = 0;   // of the level set's zero surface, before and after
  double volume_after = 0;
};

// What the result is, beside what the level set says it has to be.
struct TopologySummary {
  std::size_t components = 0;
  std::size_t cavities = 0;
  std::optional<std::int64_t> genus;  // handles of all components together; unset: the surface is open
  // Of the level set, without debris; unset: there was none, or openings were cut into its surface.
  std::optional<std::size_t> wanted_components;
  std::optional<std::int64_t> wanted_genus;

  bool agrees() const { return !wanted_components || (components == *wanted_components && genus == wanted_genus); }
};

// How the surface was extracted, and what was made of it. Lengths in model units.
struct SurfaceSummary {
  Extractor extractor = Extractor::automatic;  // automatic: no surface was extracted
  std::string reason;               // why that one
  std::size_t predicted_facets = 0; // of Delaunay
  // Its vertices went to the facets that bound the solid, and the creases of these were cut into it.
  bool sharpened = false;
  double crease_angle = 0;          // degrees
  std::size_t creases = 0;          // chains
  std::size_t corners = 0;
  double crease_length = 0;
  std::size_t points_moved = 0;
  std::size_t edges_cut = 0;
  std::size_t points_kept = 0;      // that were left alone, for the result to be valid
  // Simplification, of whichever gear's surface.
  std::size_t facets_before = 0;    // 0: it was not simplified
  double simplify_deviation = 0;    // the largest distance between the surfaces before and after, either way
  // Of the result.
  FacetShapes shapes;
  TopologySummary topology;
};

// A group of the input: a solid of an STL, a group of an OBJ or PLY.
struct GroupSummary {
  std::string name;        // as in the file, bytes untouched
  std::size_t facets = 0;  // as read, useless ones included
  double area = 0;         // model units squared
};

// The groups of a soup, in order; none for a soup that has none.
std::vector<GroupSummary> summaries_of_groups(const TriangleSoup& soup);

// The volume whose iso-surface the input is.
struct VolumeSummary {
  std::string array;               // empty: it has no name
  std::string type;                // of its values, as in the file: "uint16"
  std::array<std::uint32_t, 3> nodes{};
  Vec3 spacing;                    // model units
  double least = 0, most = 0;      // of its values
  double iso = 0;
  bool iso_was_chosen = false;     // Otsu's threshold
  bool below = false;              // what is inside
  std::size_t border_voxels = 0;   // inside, at the volume's border, where the solid was closed
};

struct RepairReport {
  std::string method;         // "local" or "levelset"; empty if neither was reached
  std::string method_reason;  // why that one
  std::string input;
  std::string input_format;
  std::string output;
  std::string output_format;
  std::optional<ModelUnit> unit;  // of the model's coordinates: as the job says, or else as the file does; empty: neither does. The output gets it, too
  ResolvedOptions options;
  std::optional<VolumeSummary> volume;  // of which the input is an iso-surface
  std::vector<GroupSummary> groups;  // of the input, as read
  Defects before;
  RepairActions actions;
  std::vector<Hole> holes;                // largest first
  std::vector<ComponentFate> components;  // largest first
  std::vector<Change> changes;            // of the local gear, largest first
  std::vector<Loss> losses;               // largest first; empty: the result is near everything
  Vec3 recentred_by;                      // what was subtracted from all coordinates
  GridSummary grid;
  SmoothingSummary smoothing;
  SurfaceSummary surface;
  Defects after;              // of the written file, read back
  Deviation deviation;        // of the written file, read back
  bool verified = false;      // the written file is a valid solid, or a valid sheet where openings were to stay
  bool is_sheet = false;      // openings were to stay, and there are some
  bool written = false;       // the output stands under its final name
  std::vector<std::string> warnings;
  std::optional<Error> failure;  // why the run could not deliver what it promises
  std::vector<StageCost> stages;
};

// The report as JSON text (UTF-8, two-space indent, trailing newline), as docs/report.schema.json says.
// Bytes of names that are not UTF-8 are replaced by U+FFFD.
std::string to_json(const RepairReport& report);

// What of each kind of defect stands in the JSON of a check: the largest.
inline constexpr std::size_t kMaxLocationsPerKind = 1000;

// One check as JSON text: what `burnish check --json` prints. `locations` holds the first
// kMaxLocationsPerKind of each kind, `locations_total` how many there are of each.
std::string to_json(const CheckResult& result);

// {"error": {"code": ..., "exit_code": ..., "message": ..., "hint": ...}} as JSON text.
std::string to_json(const Error& error);

}  // namespace burnish
