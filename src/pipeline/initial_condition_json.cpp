#include "burnish/pipeline/initial_condition.h"
#include "json.h"

namespace burnish {
namespace {

using burnish::json_of;

Json mesh_of(const CaseMesh& m) {
  Json patches = Json::array();
  for (const CaseMesh::Patch& p : m.patches) patches.push_back({{"name", p.name}, {"type", p.type}, {"faces", p.faces}});
  return {{"folder", m.folder}, {"points", m.points}, {"faces", m.faces}, {"internal_faces", m.internal_faces}, {"cells", m.cells}, {"patches", std::move(patches)},
          {"box", json_of(m.box)}, {"volume", m.volume}, {"smallest_cell", m.smallest_cell}, {"largest_cell", m.largest_cell}, {"inverted_cells", m.inverted_cells}};
}

Json solid_of(const InitialConditionResult& r) {
  const SolidSummary& s = r.solid;
  if (s.facets == 0) return nullptr;
  return {{"facets", s.facets}, {"volume", s.volume}, {"area", s.area}, {"box", json_of(s.box)}, {"scale", r.scale}, {"repair", s.repair}, {"repair_reason", s.repair_reason}};
}

Json alpha_of(const InitialConditionResult& r) {
  const FractionSummary& a = r.alpha;
  if (r.failure) return nullptr;
  return {{"method", name(a.method)}, {"inverted", r.invert}, {"cell", a.cell > 0 ? Json(a.cell) : Json()}, {"volume", a.volume}, {"solid_in_mesh", a.in_mesh},
          {"difference", or_null(a.difference)}, {"mixed_cells", a.mixed}, {"min", a.min}, {"max", a.max}, {"clamped", a.clamped}, {"worst_clamp", a.worst_clamp}};
}

Json fields_of(const std::vector<CaseField>& fields) {
  Json list = Json::array();
  for (const CaseField& f : fields) list.push_back({{"name", f.name}, {"file", f.file}, {"conditions_from", f.from.empty() ? Json() : Json(f.from)}, {"written", f.written}});
  return list;
}

}  // namespace

std::string to_json(const InitialConditionResult& r) {
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", r.input}, {"format", r.input_format}}},
      {"case", {{"folder", r.case_folder}, {"time", r.time}, {"region", r.region.empty() ? Json() : Json(r.region)}}},
      {"failure", failure_of(r.failure)},
      {"warnings", Json(r.warnings)},
      {"mesh", mesh_of(r.mesh)},
      {"solid", solid_of(r)},
      {"alpha", alpha_of(r)},
      {"fields", fields_of(r.fields)},
      {"stages", json_of(r.stages)},
  });
}

}  // namespace burnish
