#include "read_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/io/mesh_io.h"
#include "burnish/surface/weld.h"
#include "resolve_options.h"

namespace burnish {
namespace {

constexpr double kLargestDiagonal = 1e60, kSmallestDiagonal = 1e-60;
constexpr double kLargeCaps = 0.1;          // of the input's area: caps beyond this are worth a warning
constexpr double kRecentreSteps = 0x1p-22;  // of the coordinates' size: what it is moved by is a multiple of that

// Multiples of a power of two, so that differences of float32 coordinates stay exact.
TriangleSoup recentred(TriangleSoup soup, Vec3& moved_by) {
  const Box3 box = bounding_box(soup);
  const Vec3 reach = max(box.upper, box.lower * -1.0);
  const double size = std::max({reach.x, reach.y, reach.z});
  if (!(size > 0)) return soup;
  const double step = std::exp2(std::ceil(std::log2(size))) * kRecentreSteps;
  const Vec3 c = box.center();
  moved_by = {std::round(c.x / step) * step, std::round(c.y / step) * step, std::round(c.z / step) * step};
  for (Vec3& p : soup.points) p -= moved_by;
  return weld(std::move(soup));
}

void warn_of_large_caps(const PreparedInput& prepared, RepairReport& report) {
  const double share = prepared.capped.cap_area / std::max(report.before.area, 1e-300);
  if (share <= kLargeCaps) return;
  report.warnings.push_back(fmt::format("closing the {} open loops added {:.0f} % to the area; if the model is meant to be open there, 'burnish IN -o OUT' "
                                        "cleans it with --keep-openings, or gives it a thickness with --thicken T",
                                        report.actions.open_loops_capped, 100 * share));
}

bool has_an_area(const TriangleSoup& input, const PreparedInput& prepared, RepairReport& report) {
  if (area(prepared.oriented) > 0) return true;
  report.failure = Error(ErrorCode::guarantee_unmet, fmt::format("nothing to work on: none of the {} facets has an area", input.facets.size()),
                         "re-export the model; every facet in this file is a line or a point");
  return false;
}

}  // namespace

void require_measurable(const std::string& path, double diagonal) {
  if (!(diagonal > kLargestDiagonal || (diagonal > 0 && diagonal < kSmallestDiagonal))) return;
  throw Error(ErrorCode::unreadable_input,
              fmt::format("{}: expected a size between {:g} and {:g}, found a bounding box with a diagonal of {:g}", path,
                          kSmallestDiagonal, kLargestDiagonal, diagonal),
              "areas and volumes of such a model are beyond double precision: scale it");
}

TriangleSoup read_input(const std::string& path, bool salvage, const CleanOptions& options, RepairReport& report) {
  MeshFile file = read_mesh(path, {.salvage = salvage});
  report.input_format = name(file.format);
  report.unit = file.unit;
  report.warnings = std::move(file.warnings);
  return placed_input(weld(std::move(file.soup)), path, options, report);
}

TriangleSoup placed_input(TriangleSoup input, const std::string& path, const CleanOptions& options, RepairReport& report) {
  report.groups = summaries_of_groups(input);
  const double diagonal = bounding_box(input).diagonal();
  require_measurable(path, diagonal);
  if (options.recentre) input = recentred(std::move(input), report.recentred_by);
  report.options = resolve_lengths(options, diagonal);
  return input;
}

bool prepare_solid(const TriangleSoup& input, const Inspection& inspection, const CleanOptions& options, PreparedInput& prepared,
                   RepairReport& report) {
  prepared = prepare_input(input, inspection.self_intersections, options, report);
  if (options.thicken || options.keeps_openings()) return has_an_area(input, prepared, report);
  if (report.before.valid_solid() && report.components.size() == prepared.shells.shells.size()) return true;  // nothing was dropped
  report.failure = reason_for_no_solid(input, prepared, report.before);
  if (!report.failure) warn_of_large_caps(prepared, report);
  return !report.failure;
}

}  // namespace burnish
