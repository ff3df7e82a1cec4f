// Inspecting a file without changing it: what is wrong with it, and where.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "burnish/core/length.h"
#include "burnish/core/model_unit.h"
#include "burnish/core/progress.h"
#include "burnish/surface/defect_map.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/thickness.h"

namespace burnish {

struct CheckJob {
  std::string input;           // a path, or "-" for standard input
  bool salvage = false;        // take what a broken input file holds
  std::string defects_output;  // where to write the defects to be looked at (.vtp or .ply); empty: nowhere
  bool overwrite = false;      // an existing output may be replaced
  bool thickness = false;      // of a valid solid also: how thick it is
  std::optional<Length> min_thickness;  // what is thinner is listed, and the answer is no; not in cells; asks for `thickness`
  std::string thickness_output;         // where to write the thickness at points (.vtp or .ply); asks for `thickness`
  std::optional<ModelUnit> unit;  // of the model; goes before what the file says of itself
};

struct CheckResult {
  std::string input;
  std::string input_format;
  std::optional<ModelUnit> unit;  // of the model's coordinates: as the job says, or else as the file does; empty: neither does
  Defects defects;                       // after welding by exact coordinates
  std::vector<LocatedDefect> locations;  // as DefectMap::defects: by kind, the largest first
  std::vector<std::string> warnings;     // of the reader
  bool valid_solid = false;
  std::optional<ThicknessSummary> thickness;  // empty if not asked for, or of no valid solid, which `warnings` tells

  bool too_thin() const { return thickness && thickness->thin_area > 0; }
};

// Reads the file, welds it, inspects it, locates its defects and, if asked to, writes them.
//
// `defects_output` holds a vert at the position of each located defect, the open, non-manifold and
// misoriented edges as lines, and the degenerate, duplicate and intersecting facets as triangles; a facet
// that is defective in two ways stands there twice. Cells carry their kind (as DefectKind counts them) and
// `defect`, the index into `locations`. It is written for a valid solid, too, without cells.
//
// `thickness_output` holds the surface, welded, with `thickness` at its points.
//
// Throws Error as `read_mesh` and OutputFile do, and Error{usage} for a `defects_output` of another suffix,
// before anything is read. Locating takes a few percent of the time of inspecting.
CheckResult check(const CheckJob& job, Progress& progress = no_progress());

// The same of a surface in memory, welded or not, without an output.
CheckResult check(TriangleSoup soup, Progress& progress = no_progress());
// Of the job, `thickness`, `min_thickness` and `unit` count.
CheckResult check(TriangleSoup soup, const CheckJob& job, Progress& progress = no_progress());

}  // namespace burnish
