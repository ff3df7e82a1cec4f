#include <cmath>

#include "burnish/pipeline/cell_octree.h"
#include "json.h"

namespace burnish {
namespace {

Json levels_of(const CellOctreeResult& r) {
  Json levels = Json::array();
  for (std::size_t l = 0; l < r.statistics.levels.size(); ++l) {
    const LevelCount& count = r.statistics.levels[l];
    levels.push_back({{"level", l}, {"side", std::ldexp(r.cell, static_cast<int>(l))}, {"cells", count.cells}, {"cut", count.cells_cut}});
  }
  return levels;
}

}  // namespace

std::string to_json(const CellOctreeResult& r) {
  const FieldFile& o = r.output;
  Json output;
  if (!o.file.empty())
    output = {{"file", o.file},
              {"format", o.format},
              {"written", o.written},
              {"cell_count", o.cell_count},
              {"point_count", o.point_count},
              {"octant_count", o.octant_count},
              {"bytes", o.bytes}};
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", r.input}, {"format", r.input_format}}},
      {"units", json_of(r.unit)},
      {"output", std::move(output)},
      {"warnings", Json(r.warnings)},
      {"options",
       {{"cell", r.cell},
        {"cell_max", r.cell_max},
        {"cells_along_longest_side", r.cells_along_longest_side},
        {"max_face_limit", or_null(r.limits.max_face_limit)},
        {"max_face_cut", or_null(r.limits.max_face_cut)},
        {"refine_tol", or_null(r.limits.refine_tol)}}},
      {"facets", r.facets},
      {"cells", {{"count", r.statistics.cells()}, {"cut", r.statistics.cells_cut()}, {"bytes", r.bytes}, {"levels", levels_of(r)}}},
      {"divided", divisions_of(r.limits, r.statistics)},
      {"stages", json_of(r.stages)},
  });
}

}  // namespace burnish
