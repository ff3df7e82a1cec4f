#include "burnish/pipeline/check.h"

#include <optional>
#include <utility>

#include "burnish/io/marked_cells.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/weld.h"
#include "defect_cells.h"
#include "read_input.h"

namespace burnish {
namespace {

// Created before the work: a file that cannot be written is to be known before it, not after.
class DefectsOutput {
 public:
  DefectsOutput(const std::string& path, bool overwrite)
      : format_(marked_format_for_writing(path)), file_(path, overwrite) {}

  void write(const MarkedCells& cells) {
    write_marked_cells(file_.fd(), file_.destination(), cells, format_);
    file_.commit();
  }

 private:
  MarkedFormat format_;
  OutputFile file_;
};

TriangleSoup read_welded(const CheckJob& job, CheckResult& result, Progress& progress) {
  progress.begin_stage("reading");
  MeshFile file = read_mesh(job.input, {.salvage = job.salvage});
  result.input_format = name(file.format);
  result.warnings = std::move(file.warnings);
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
  std::optional<DefectsOutput> output;
  if (!job.defects_output.empty()) output.emplace(job.defects_output, job.overwrite);
  const TriangleSoup soup = read_welded(job, result, progress);
  progress.check();
  Found found = look_at(soup, result, progress);
  if (output) {
    progress.begin_stage("writing defects");
    output->write(defect_cells(soup, found.inspection.elements, found.map));
  }
  result.locations = std::move(found.map.defects);
  return result;
}

CheckResult check(TriangleSoup soup, Progress& progress) {
  CheckResult result;
  result.input = result.input_format = kInMemory;
  progress.begin_stage("welding");
  soup = weld(std::move(soup));
  progress.check();
  result.locations = look_at(soup, result, progress).map.defects;
  return result;
}

}  // namespace burnish
