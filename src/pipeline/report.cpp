#include "burnish/pipeline/report.h"

#include <nlohmann/json.hpp>

namespace burnish {
namespace {

using Json = nlohmann::ordered_json;

// Names may hold any bytes; JSON holds UTF-8 only.
std::string text_of(const Json& json) {
  return json.dump(2, ' ', false, Json::error_handler_t::replace) + '\n';
}

Json generator() { return "burnish " BURNISH_VERSION; }

Json json_of(const Vec3& v) { return {v.x, v.y, v.z}; }

Json json_of(const Box3& box) {
  if (box.empty()) return nullptr;
  return {{"lower", json_of(box.lower)}, {"upper", json_of(box.upper)}, {"diagonal", box.diagonal()}};
}

Json json_of(const Defects& d) {
  return {
      {"valid_solid", d.valid_solid()},
      {"facets", d.facets},
      {"points", d.points},
      {"components", d.components},
      {"degenerate_facets", d.degenerate_facets},
      {"duplicate_facets", d.duplicate_facets},
      {"open_edges", d.open_edges},
      {"open_loops", d.open_loops},
      {"non_manifold_edges", d.non_manifold_edges},
      {"non_manifold_points", d.non_manifold_points},
      {"misoriented_edges", d.misoriented_edges},
      {"self_intersecting_pairs", d.self_intersections_counted ? Json(d.self_intersecting_pairs) : Json()},
      {"volume", d.volume},
      {"area", d.area},
      {"mean_edge", d.mean_edge},
      {"box", json_of(d.box)},
  };
}

Json json_of(const Error& error) {
  return {
      {"code", name(error.code())},
      {"exit_code", exit_code(error.code())},
      {"message", error.what()},
      {"hint", error.hint()},
  };
}

Json json_of(const ResolvedOptions& o) {
  return {
      {"cell", o.cell},
      {"cell_was_chosen", o.cell_was_chosen},
      {"cells_along_longest_side", o.cells_along_longest_side},
      {"smooth", o.smooth},
      {"deviation", o.deviation ? Json(*o.deviation) : Json()},
      {"memory_bytes", o.memory_bytes},
  };
}

Json json_of(const RepairActions& a) {
  return {
      {"degenerate_facets_dropped", a.degenerate_facets_dropped},
      {"duplicate_facets_dropped", a.duplicate_facets_dropped},
      {"points_welded_within_tolerance", a.points_welded_within_tolerance},
      {"weld_tolerance", a.weld_tolerance},
      {"facets_flipped", a.facets_flipped},
      {"open_loops_capped", a.open_loops_capped},
      {"cap_area", a.cap_area},
      {"ambiguous_regions", a.ambiguous_regions},
      {"interior_facets_ignored", a.interior_facets_ignored},
      {"unresolved_facets", a.unresolved_facets},
      {"unresolved_area", a.unresolved_area},
      {"components_lost", a.components_lost},
      {"area_lost", a.area_lost},
  };
}

Json json_of(const GridSummary& g) {
  return {
      {"blocks", g.blocks},
      {"finest_blocks", g.finest_blocks},
      {"levels", g.levels},
      {"bytes_planned", g.bytes_planned},
  };
}

Json json_of(const SmoothingSummary& s) {
  return {
      {"length", s.length},
      {"flow_time", s.flow_time},
      {"steps", s.steps},
      {"volume_before", s.volume_before},
      {"volume_after", s.volume_after},
  };
}

Json json_of(const OneSidedDistance& d) {
  if (d.samples == 0) return nullptr;
  return {{"max", d.max}, {"mean", d.mean}, {"rms", d.rms}, {"samples", d.samples}};
}

Json json_of(const Deviation& d) {
  return {
      {"input_to_output", json_of(d.input_to_output)},
      {"output_to_input", json_of(d.output_to_input)},
  };
}

Json json_of(const std::vector<GroupSummary>& groups) {
  Json list = Json::array();
  for (const GroupSummary& group : groups)
    list.push_back({{"name", group.name}, {"facets", group.facets}, {"area", group.area}});
  return list;
}

Json json_of(const std::vector<StageCost>& stages) {
  Json list = Json::array();
  for (const StageCost& stage : stages) {
    list.push_back({
        {"name", stage.name},
        {"wall_seconds", stage.wall_seconds},
        {"cpu_seconds", stage.cpu_seconds},
        {"peak_bytes", stage.peak_bytes},
    });
  }
  return list;
}

}  // namespace

std::vector<GroupSummary> summaries_of_groups(const TriangleSoup& soup) {
  std::vector<GroupSummary> summaries;
  for (const FacetGroup& group : soup.groups) {
    summaries.push_back({group.name, group.facet_count, 0});
    for (std::size_t f = group.first_facet; f < group.first_facet + std::size_t{group.facet_count}; ++f)
      summaries.back().area += 0.5 * norm(facet_normal_2a(soup, f));
  }
  return summaries;
}

std::string to_json(const RepairReport& r) {
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", r.input}, {"format", r.input_format}}},
      {"output",
       {{"file", r.output}, {"format", r.output_format}, {"written", r.written}, {"verified", r.verified}}},
      {"failure", r.failure ? json_of(*r.failure) : Json()},
      {"warnings", Json(r.warnings)},
      {"options", json_of(r.options)},
      {"groups", json_of(r.groups)},
      {"before", json_of(r.before)},
      {"actions", json_of(r.actions)},
      {"grid", json_of(r.grid)},
      {"smoothing", json_of(r.smoothing)},
      {"after", r.after.facets > 0 ? json_of(r.after) : Json()},
      {"deviation", json_of(r.deviation)},
      {"stages", json_of(r.stages)},
  });
}

std::string to_json(const Defects& defects, const std::string& input, const std::string& format,
                    const std::vector<std::string>& warnings) {
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", input}, {"format", format}}},
      {"warnings", Json(warnings)},
      {"defects", json_of(defects)},
  });
}

std::string to_json(const Error& error) { return text_of({{"error", json_of(error)}}); }

}  // namespace burnish
