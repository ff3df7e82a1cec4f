#include "burnish/pipeline/check.h"

#include <utility>

#include "burnish/io/mesh_io.h"
#include "burnish/surface/weld.h"

namespace burnish {

CheckResult check(const std::string& path, bool salvage, Progress& progress) {
  CheckResult result;
  result.input = path;

  progress.begin_stage("reading");
  MeshReadOptions read_options;
  read_options.salvage = salvage;
  MeshFile file = read_mesh(path, read_options);
  result.input_format = name(file.format);
  result.warnings = std::move(file.warnings);
  progress.check();

  progress.begin_stage("welding");
  const TriangleSoup soup = weld(std::move(file.soup));
  progress.check();

  progress.begin_stage("inspecting");
  result.defects = inspect(soup, {}, progress).defects;
  result.valid_solid = result.defects.valid_solid();
  return result;
}

}  // namespace burnish
