#include "burnish/pipeline/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <optional>

#include "burnish/pipeline/field.h"
#include "json.h"

namespace burnish {
namespace {

using burnish::json_of;

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
      {"misnested_shells", d.misnested_shells},
      {"self_intersecting_pairs", d.self_intersections_counted ? Json(d.self_intersecting_pairs) : Json()},
      {"volume", d.volume},
      {"area", d.area},
      {"mean_edge", d.mean_edge},
      {"box", json_of(d.box)},
  };
}

Json json_of(const ResolvedOptions& o) {
  return {
      {"cell", o.cell},
      {"cell_was_chosen", o.cell_was_chosen},
      {"cells_along_longest_side", o.cells_along_longest_side},
      {"smooth", o.smooth},
      {"smooth_auto", o.smooth_auto},
      {"keep_volume", o.keep_volume},
      {"crease_angle", or_null(o.crease_angle)},
      {"curvature_radius", or_null(o.curvature_radius)},
      {"offset", or_null(o.offset)},
      {"hollow", or_null(o.hollow)},
      {"deviation", or_null(o.deviation)},
      {"surface", name(o.surface)},
      {"edge", or_null(o.edge)},
      {"edge_tolerance", or_null(o.edge_tolerance)},
      {"min_angle", or_null(o.min_angle)},
      {"facets", or_null(o.facets)},
      {"simplify", or_null(o.simplify)},
      {"gap", or_null(o.gap)},
      {"max_hole", or_null(o.max_hole)},
      {"thicken", or_null(o.thicken)},
      {"adapt", or_null(o.adapt)},
      {"coarsest_level", o.coarsest_level},
      {"memory_bytes", o.memory_bytes},
  };
}

Json json_of(const RepairActions& a) {
  return {
      {"degenerate_facets_dropped", a.degenerate_facets_dropped},
      {"duplicate_facets_dropped", a.duplicate_facets_dropped},
      {"wall_facets_dropped", a.wall_facets_dropped},
      {"fragments_dropped", a.fragments_dropped},
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
      {"debris_dropped", a.debris_dropped},
      {"facets_cut", a.facets_cut},
      {"needles_flipped", a.needles_flipped},
      {"points_split", a.points_split},
      {"largest_split", a.largest_split},
      {"intersecting_pairs_removed", a.intersecting_pairs_removed},
      {"facets_kept", a.facets_kept},
      {"facets_moved", a.facets_moved},
      {"facets_removed", a.facets_removed},
      {"facets_added", a.facets_added},
  };
}

Json json_of(const Hole& h) {
  return {{"position", json_of(h.position)}, {"edges", h.edges}, {"perimeter", h.perimeter}, {"width", h.width()}, {"area", h.area}, {"filled", h.filled}};
}

Json json_of(const ComponentFate& c) {
  return {{"position", json_of(c.position)}, {"facets", c.facets}, {"area", c.area}, {"volume", c.volume}, {"fate", c.fate}, {"reason", c.reason}};
}

Json json_of(const Change& c) {
  return {{"position", json_of(c.position)}, {"extent", c.extent}, {"facets_removed", c.facets_removed}, {"facets_added", c.facets_added}};
}

// The first thousand of a list that is sorted by importance; its length is told beside it.
template <class T>
Json list_of(const std::vector<T>& items) {
  constexpr std::size_t kMost = 1000;
  Json list = Json::array();
  for (std::size_t i = 0; i < std::min(items.size(), kMost); ++i) list.push_back(json_of(items[i]));
  return {{"count", items.size()}, {"largest", std::move(list)}};
}

Json json_of(const GridSummary& g) {
  return {
      {"blocks", g.blocks},
      {"finest_blocks", g.finest_blocks},
      {"levels", g.levels},
      {"bytes_planned", g.bytes_planned},
  };
}

Json json_of(const NoiseEstimate& n) {
  return {{"sigma", n.sigma},           {"residual", n.residual},           {"mean_edge", n.mean_edge},       {"correlation", n.correlation},
          {"evenness", n.evenness},     {"outlier_share", n.outlier_share}, {"crease_share", n.crease_share}, {"crease_bending", n.crease_bending},
          {"neighborhoods", n.fits}};
}

Json json_of(const SmoothingSummary& s) {
  const bool done = s.mode != SmoothMode::automatic;
  return {
      {"mode", done ? Json(name(s.mode)) : Json()},
      {"mode_reason", s.mode_reason},
      {"noise", s.mode_reason.empty() ? Json() : json_of(s.noise)},
      {"outliers", s.outliers},
      {"rms_moved", s.rms_moved},
      {"max_moved", s.max_moved},
      {"deviation", s.deviation},
      {"length", s.length},
      {"flow_time", s.flow_time},
      {"steps", s.steps},
      {"redistance", s.steps > 0 ? Json(name(s.redistance)) : Json()},
      {"volume_before", s.volume_before},
      {"volume_after", s.volume_after},
  };
}

Json json_of(const FacetShapes& s) {
  return {
      {"min_angle", s.smallest_angle},
      {"angle_of_thousandth", s.angle_of_thousandth},
      {"angle_of_hundredth", s.angle_of_hundredth},
      {"median_angle", s.median_angle},
      {"below_10", s.share_below_10},
      {"below_25", s.share_below_25},
      {"max_angle", s.largest_angle},
      {"max_ratio", s.largest_ratio},
      {"shortest_edge", s.shortest_edge},
      {"longest_edge", s.longest_edge},
  };
}

Json json_of(const TopologySummary& t) {
  return {
      {"components", t.components},
      {"cavities", t.cavities},
      {"genus", or_null(t.genus)},
      {"level_set_components", or_null(t.wanted_components)},
      {"level_set_genus", or_null(t.wanted_genus)},
      {"agrees", t.wanted_components ? Json(t.agrees()) : Json()},
  };
}

Json json_of(const SurfaceSummary& s) {
  return {
      {"extractor", s.extractor == Extractor::automatic ? Json() : Json(name(s.extractor))},
      {"reason", s.reason},
      {"predicted_facets", s.predicted_facets},
      {"sharpened", s.sharpened},
      {"crease_angle", s.crease_angle},
      {"creases", s.creases},
      {"corners", s.corners},
      {"crease_length", s.crease_length},
      {"points_moved", s.points_moved},
      {"edges_cut", s.edges_cut},
      {"points_kept", s.points_kept},
      {"facets_before", s.facets_before},
      {"simplify_deviation", s.simplify_deviation},
      {"shapes", json_of(s.shapes)},
      {"topology", json_of(s.topology)},
  };
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

// Errors in model units, as all lengths outside are.
Json json_of(const ErrorSummary& e, std::size_t nodes, double cell) {
  return {{"nodes", nodes}, {"max", e.max * cell}, {"rms", e.rms * cell}, {"worst_share_of_allowed", e.worst_share}, {"exceeded", e.exceeded}};
}

Json json_of(const DistanceCheck& check, double cell) {
  Json nodes = Json::object();
  for (std::size_t s = 0; s < kNodeStrata; ++s) nodes[std::string(name(static_cast<NodeStratum>(s)))] = check.nodes[s];
  return {{"passed", check.passed()},
          {"nodes", std::move(nodes)},
          {"kernel", json_of(check.kernel, check.total(), cell)},
          {"stored", json_of(check.stored, check.stored_nodes, cell)}};
}

Json json_of(const FieldRedistancing& r) {
  return {{"method", name(r.method)}, {"accepted", name(r.exact)}, {"cells_cut", r.cells_cut}, {"cells_accepted", r.cells_accepted},
          {"exact_nodes", r.exact_nodes}, {"steps", r.result.steps}, {"residual", r.result.residual}, {"steady", r.result.steady}};
}

Json json_of(const VolumeSummary& v) {
  return {{"array", v.array}, {"type", v.type},   {"nodes", Json(v.nodes)}, {"spacing", json_of(v.spacing)}, {"least", v.least},
          {"most", v.most},   {"iso", v.iso},     {"iso_was_chosen", v.iso_was_chosen}, {"inside", v.below ? "below" : "above"}, {"border_voxels", v.border_voxels}};
}

Json json_of(const LocatedDefect& d, std::size_t index) {
  return {
      {"defect", index},       {"kind", name(d.kind)}, {"position", json_of(d.position)},
      {"box", json_of(d.box)}, {"count", d.count},     {"length", d.length},
      {"area", d.area},        {"facet", d.facet},
  };
}

Json totals_of(const std::vector<LocatedDefect>& locations) {
  Json totals = Json::object();
  for (const DefectKind kind : kAllDefectKinds)
    totals[std::string(name(kind))] = std::ranges::count(locations, kind, &LocatedDefect::kind);
  return totals;
}

Json largest_of(const std::vector<LocatedDefect>& locations) {
  Json list = Json::array();
  std::array<std::size_t, kDefectKinds> of_kind{};
  for (std::size_t i = 0; i < locations.size(); ++i)
    if (++of_kind[static_cast<std::size_t>(locations[i].kind)] <= kMaxLocationsPerKind)
      list.push_back(json_of(locations[i], i));
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
      {"units", json_of(r.unit)},
      {"volume", r.volume ? json_of(*r.volume) : Json()},
      {"output",
       {{"file", r.output}, {"format", r.output_format}, {"written", r.written}, {"verified", r.verified}, {"is_sheet", r.is_sheet}}},
      {"method", r.method.empty() ? Json() : Json(r.method)},
      {"method_reason", r.method_reason},
      {"failure", failure_of(r.failure)},
      {"warnings", Json(r.warnings)},
      {"options", json_of(r.options)},
      {"groups", json_of(r.groups)},
      {"before", json_of(r.before)},
      {"actions", json_of(r.actions)},
      {"holes", list_of(r.holes)},
      {"components", list_of(r.components)},
      {"changes", list_of(r.changes)},
      {"losses", list_of(r.losses)},
      {"recentred_by", json_of(r.recentred_by)},
      {"grid", json_of(r.grid)},
      {"smoothing", json_of(r.smoothing)},
      {"surface", json_of(r.surface)},
      {"after", r.after.facets > 0 ? json_of(r.after) : Json()},
      {"deviation", json_of(r.deviation)},
      {"stages", json_of(r.stages)},
  });
}

namespace {

Json json_of(const ThinPlace& p) {
  return {{"position", burnish::json_of(p.position)}, {"thickness", p.thickness}, {"area", p.area}, {"box", burnish::json_of(p.box)}, {"facet", p.facet}};
}

Json thickness_of(const std::optional<ThicknessSummary>& t) {
  if (!t) return nullptr;
  constexpr std::size_t kListed = 1000;
  Json percentiles, places = Json::array();
  for (std::size_t i = 0; i < t->percentiles.size(); ++i) percentiles[fmt::format("p{}", ThicknessSummary::kPercentiles[i])] = t->percentiles[i];
  for (std::size_t i = 0; i < std::min(t->places.size(), kListed); ++i) places.push_back(json_of(t->places[i]));
  return {{"minimum", t->minimum}, {"thinnest_at", burnish::json_of(t->thinnest_at)}, {"mean", t->mean}, {"percentiles", percentiles}, {"area", t->area}, {"samples", t->samples},
          {"limit", t->limit > 0 ? Json(t->limit) : Json()}, {"thin_area", t->thin_area}, {"places_total", t->places.size()}, {"places", places}};
}

}  // namespace

std::string to_json(const CheckResult& r) {
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", r.input}, {"format", r.input_format}}},
      {"units", json_of(r.unit)},
      {"warnings", Json(r.warnings)},
      {"defects", json_of(r.defects)},
      {"locations_total", totals_of(r.locations)},
      {"locations", largest_of(r.locations)},
      {"thickness", thickness_of(r.thickness)},
  });
}

std::string to_json(const FieldResult& r) {
  const FieldGrid& g = r.grid;
  const FieldFile& o = r.output;
  Json output;
  if (!o.file.empty())
    output = {{"file", o.file},       {"format", o.format},        {"cells", name(o.cells)},          {"written", o.written},
              {"cell_count", o.cell_count}, {"point_count", o.point_count}, {"octant_count", o.octant_count},
              {"samples", o.samples[0] > 0 ? Json(o.samples) : Json()}, {"spacing", o.spacing > 0 ? Json(o.spacing) : Json()}, {"voxel_count", o.voxel_count}, {"bytes", o.bytes}};
  const auto unless_failed = [&](Json part) { return r.failure ? Json() : std::move(part); };
  Json by_level = Json::array(), divided;
  for (std::size_t l = 0; l < g.by_level.size(); ++l)
    by_level.push_back({{"level", l}, {"blocks", g.by_level[l].blocks}, {"near_blocks", g.by_level[l].near_blocks}});
  if (r.is_adaptive()) {
    divided = divisions_of(r.limits, r.growth);
    divided["adapt"] = r.options.adapt ? Json(r.growth.divided_by.back()) : Json();
  }
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", r.input}, {"format", r.input_format}}},
      {"units", json_of(r.unit)},
      {"output", std::move(output)},
      {"failure", failure_of(r.failure)},
      {"warnings", Json(r.warnings)},
      {"options",
       {{"cell", r.options.cell}, {"cell_was_chosen", r.options.cell_was_chosen}, {"cells_along_longest_side", r.options.cells_along_longest_side},
        {"band", r.band}, {"gap", or_null(r.options.gap)}, {"max_hole", or_null(r.options.max_hole)}, {"adapt", or_null(r.options.adapt)},
        {"max_face_limit", or_null(r.limits.max_face_limit)}, {"max_face_cut", or_null(r.limits.max_face_cut)},
        {"refine_tol", or_null(r.limits.refine_tol)}, {"coarsest_level", r.options.coarsest_level}, {"smooth", r.options.smooth},
        {"smooth_auto", r.options.smooth_auto}, {"memory_bytes", r.options.memory_bytes}}},
      {"before", json_of(r.before)},
      {"facets", unless_failed({{"used", r.facets}, {"interior", r.interior_facets}, {"unresolved", r.unresolved_facets}})},
      {"regions", unless_failed({{"count", r.regions}, {"ambiguous", r.ambiguous_regions}})},
      {"grid",
       unless_failed({{"blocks", g.blocks}, {"finest_blocks", g.finest_blocks}, {"near_blocks", g.near_blocks}, {"nodes", g.nodes}, {"levels", g.levels},
                {"by_level", std::move(by_level)}, {"divided", std::move(divided)}, {"bytes", g.bytes}, {"bytes_planned", g.bytes_planned}})},
      {"volume", unless_failed({{"input", r.volume.input}, {"prepared", r.volume.prepared}, {"level_set", r.volume.level_set}})},
      {"smoothing", json_of(r.smoothing)},
      {"redistancing", r.redistancing ? json_of(*r.redistancing) : Json()},
      {"verification", r.verification ? json_of(*r.verification, r.options.cell) : Json()},
      {"stages", json_of(r.stages)},
  });
}

std::string to_json(const Error& error) { return text_of({{"error", json_of(error)}}); }

}  // namespace burnish
