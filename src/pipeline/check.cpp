#include "burnish/pipeline/check.h"

#include <optional>
#include <utility>

#include "burnish/io/mesh_io.h"
#include "burnish/surface/weld.h"
#include "defect_cells.h"
#include "read_input.h"
#include "viewer_file.h"

namespace burnish {
namespace {

constexpr std::size_t kThicknessSamples = 40'000;  // besides one a facet

void measure_thickness(const CheckJob& job, const TriangleSoup& soup, ViewerFile* output, CheckResult& result, Progress& progress) {
  if (!result.valid_solid) {
    result.warnings.push_back("no thickness: that is one of a valid solid; clean it first, by 'burnish IN -o OUT'");
    return;
  }
  progress.begin_stage("measuring thickness");
  const double limit = job.min_thickness ? job.min_thickness->in_model_units(result.defects.box.diagonal(), 0) : 0;
  result.thickness = summary_of(soup, thickness_samples(soup, kThicknessSamples, progress), limit);
  if (!output) return;
  progress.begin_stage("colouring");
  output->write(PointData{soup, {PointArray{"thickness", thickness_at_points(soup, progress)}}, {"thickness in model units"}});
}

TriangleSoup read_welded(const CheckJob& job, CheckResult& result, Progress& progress) {
  progress.begin_stage("reading");
  MeshFile file = read_mesh(job.input, {.salvage = job.salvage});
  result.input_format = name(file.format);
  result.warnings = std::move(file.warnings);
  result.unit = unit_of(job.unit, file.unit, result.warnings);
  progress.check();
  progress.begin_stage("welding");
  return weld(std::move(file.soup));
}

// What was found, one by one.
struct Found {
  Inspection inspection;
  DefectMap map;
};

Found look_at(const TriangleSoup& welded, CheckResult& result, Progress& progress) {
  Found found;
  progress.begin_stage("inspecting");
  found.inspection = inspect(welded, {.elements = true, .max_collected_pairs = kMaxSelfIntersections}, progress);
  result.defects = found.inspection.defects;
  result.valid_solid = result.defects.valid_solid();
  progress.check();
  progress.begin_stage("locating");
  found.map = locate_defects(welded, found.inspection);
  progress.check();
  return found;
}

}  // namespace

CheckResult check(const CheckJob& job, Progress& progress) {
  CheckResult result;
  result.input = job.input;
  std::optional<ViewerFile> output, thickness_output;
  if (!job.defects_output.empty()) output.emplace(job.defects_output, job.overwrite);
  if (!job.thickness_output.empty()) thickness_output.emplace(job.thickness_output, job.overwrite);
  const TriangleSoup soup = read_welded(job, result, progress);
  progress.check();
  Found found = look_at(soup, result, progress);
  if (output) {
    progress.begin_stage("writing defects");
    output->write(defect_cells(soup, found.inspection.elements, found.map));
  }
  result.locations = std::move(found.map.defects);
  if (job.thickness) measure_thickness(job, soup, thickness_output ? &*thickness_output : nullptr, result, progress);
  return result;
}

CheckResult check(TriangleSoup soup, Progress& progress) { return check(std::move(soup), CheckJob{}, progress); }

CheckResult check(TriangleSoup soup, const CheckJob& job, Progress& progress) {
  CheckResult result;
  result.input = result.input_format = kInMemory;
  result.unit = job.unit;
  progress.begin_stage("welding");
  soup = weld(std::move(soup));
  progress.check();
  result.locations = look_at(soup, result, progress).map.defects;
  if (job.thickness) measure_thickness(job, soup, nullptr, result, progress);
  return result;
}

}  // namespace burnish
