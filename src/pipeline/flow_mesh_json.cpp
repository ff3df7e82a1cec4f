#include "burnish/pipeline/flow_mesh_job.h"
#include "json.h"

namespace burnish {
namespace {

using burnish::json_of;

constexpr const char* kShapeNames[kCellShapes] = {"tetrahedra", "pyramids", "wedges", "hexahedra", "polyhedra"};

Json if_measured(const MeshCheck& check, double value) { return check.measured > 0 ? Json(value) : Json(); }

Json checks_of(const MeshQuality& q) {
  Json list = Json::array();
  for (const MeshCheck& c : q.checks)
    list.push_back({{"name", c.name}, {"all_geometry", c.all_geometry}, {"warns", c.warns}, {"limit", c.limit}, {"worst", if_measured(c, c.worst)}, {"best", if_measured(c, c.best)},
                    {"mean", if_measured(c, c.mean)}, {"measured", c.measured}, {"failing", c.failing}, {"passed", c.passed}});
  return list;
}

Json places_of(const std::vector<BadPlace>& places) {
  Json list = Json::array();
  for (const BadPlace& p : places) list.push_back({{"check", p.check}, {"cell", p.cell}, {"value", p.value}, {"position", json_of(p.at)}});
  return list;
}

Json shapes_of(const MeshQuality& q) {
  Json shapes = Json::object();
  for (std::size_t s = 0; s < kCellShapes; ++s) {
    const bool has_angles = q.cells_of_shape[s] > 0 && s != static_cast<std::size_t>(CellShape::polyhedron);
    shapes[kShapeNames[s]] = {{"cells", q.cells_of_shape[s]}, {"volume", q.volume_of_shape[s]}, {"share_of_volume", q.volume > 0 ? q.volume_of_shape[s] / q.volume : 0},
                              {"least_dihedral", has_angles ? Json(q.least_dihedral_of_shape[s]) : Json()}, {"greatest_dihedral", has_angles ? Json(q.greatest_dihedral_of_shape[s]) : Json()}};
  }
  return shapes;
}

Json quality_of(const FlowMeshResult& r) {
  if (!r.meshed) return nullptr;
  const MeshQuality& q = r.quality;
  return {{"promise_holds", r.good},
          {"ok", q.ok},
          {"plain_ok", q.plain_ok},
          {"regions", q.regions},
          {"checks", checks_of(q)},
          {"bad_cells", places_of(r.bad_places)}};
}

Json solid_of(const MeshedSolid& s) {
  if (s.facets == 0) return nullptr;
  return {{"facets", s.facets}, {"components", s.components}, {"cavities", s.cavities}, {"volume", s.volume}, {"area", s.area}, {"box", json_of(s.box)},
          {"repair", s.repair}, {"repair_reason", s.repair_reason}, {"level_set_cell", s.cell > 0 ? Json(s.cell) : Json()}};
}

Json patches_of(const std::vector<MeshedPatch>& patches) {
  Json list = Json::array();
  for (const MeshedPatch& p : patches)
    list.push_back({{"name", p.name}, {"type", p.type}, {"group", p.group.empty() ? Json() : Json(p.group)}, {"faces", p.faces}, {"area", p.area}});
  return list;
}

Json losses_of(const std::vector<Loss>& losses) {
  Json list = Json::array();
  for (const Loss& l : losses) list.push_back(json_of(l));
  return list;
}

Json trials_of(const std::vector<MeshTrial>& trials) {
  Json list = Json::array();
  for (const MeshTrial& t : trials) list.push_back({{"cell", t.cell}, {"cells", t.cells}});
  return list;
}

Json layers_of(const MeshedLayers& l) {
  if (l.count == 0) return nullptr;
  return {{"count", l.count}, {"first", l.first}, {"ratio", l.ratio}, {"thickness", l.thickness}, {"covered", l.covered}, {"least_first", l.least_first}, {"greatest_first", l.greatest_first}};
}

Json mesh_of(const FlowMeshResult& r) {
  if (!r.meshed) return nullptr;
  const MeshQuality& q = r.quality;
  return {{"side", name(r.side)},
          {"flavour", name(r.flavour)},
          {"cell", r.cell},
          {"cell_was_chosen", r.cell_was_chosen},
          {"cells_along_longest_side", r.cells_along_longest_side},
          {"cells_wanted", or_null(r.cells_wanted)},
          {"trials", trials_of(r.trials)},
          {"cells", q.cells},
          {"points", q.points},
          {"faces", q.faces},
          {"internal_faces", q.internal_faces},
          {"shapes", shapes_of(q)},
          {"finest_cell", r.finest_cell},
          {"cells_of_level", Json(r.cells_of_level)},
          {"box", json_of(r.box)},
          {"volume", q.volume},
          {"volume_wanted", r.volume_wanted},
          {"smallest_cell", r.smallest_cell},
          {"largest_cell", r.largest_cell},
          {"regions_wanted", r.regions_wanted},
          {"layers", layers_of(r.layers)},
          {"moved_back", r.moved_back},
          {"patches", patches_of(r.patches)},
          {"surface_to_patches", json_of(r.surface_to_patches)},
          {"patches_to_surface", json_of(r.patches_to_surface)},
          {"losses", losses_of(r.losses)}};
}

}  // namespace

std::string quality_to_json(const FlowMeshResult& result) { return text_of(quality_of(result)); }

std::string to_json(const FlowMeshResult& r) {
  Json output;
  if (!r.output.empty()) output = {{"file", r.output}, {"format", r.output_format}, {"written", r.written}};
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", r.input}, {"format", r.input_format}}},
      {"units", json_of(r.unit)},
      {"output", std::move(output)},
      {"failure", failure_of(r.failure)},
      {"warnings", Json(r.warnings)},
      {"solid", solid_of(r.solid)},
      {"mesh", mesh_of(r)},
      {"quality", quality_of(r)},
      {"cost", {{"meshing_cpu_seconds", r.cost.seconds}, {"cells_per_cpu_second", r.cost.cells_per_second}, {"peak_bytes", r.cost.peak_bytes}}},
      {"stages", json_of(r.stages)},
  });
}

}  // namespace burnish
