#include <fmt/format.h>

#include <numbers>

#include "burnish/pipeline/compare_files.h"
#include "burnish/pipeline/report.h"
#include "json.h"

namespace burnish {
namespace {

using burnish::json_of;

Json json_of(const ComparedFile& f) {
  const Defects& m = f.measures;
  return {
      {"file", f.file},
      {"format", f.format},
      {"warnings", Json(f.warnings)},
      {"facets", m.facets},
      {"points", m.points},
      {"components", m.components},
      {"open_edges", m.open_edges},
      {"volume", or_null(f.volume)},
      {"no_volume_reason", f.no_volume_reason},
      {"area", m.area},
      {"box", json_of(m.box)},
  };
}

std::int64_t difference(std::size_t a, std::size_t b) { return static_cast<std::int64_t>(b) - static_cast<std::int64_t>(a); }

Json differences(const ComparedFile& a, const ComparedFile& b) {
  const Box3 &p = a.measures.box, &q = b.measures.box;
  return {
      {"facets", difference(a.measures.facets, b.measures.facets)},
      {"components", difference(a.measures.components, b.measures.components)},
      {"volume", a.volume && b.volume ? Json(*b.volume - *a.volume) : Json()},
      {"area", b.measures.area - a.measures.area},
      {"box_lower", json_of(q.lower - p.lower)},
      {"box_upper", json_of(q.upper - p.upper)},
  };
}

Json json_of(const Distribution& d) {
  if (d.samples == 0) return nullptr;
  Json json = {{"max", d.max}, {"mean", d.mean}, {"rms", d.rms}};
  for (std::size_t i = 0; i < kPercentiles.size(); ++i) json[fmt::format("p{}", kPercentiles[i])] = d.percentiles[i];
  json["samples"] = d.samples;
  return json;
}

Json percent_of(const Distribution& d, double diagonal) {
  if (!(diagonal > 0)) return nullptr;
  Distribution percent = d;
  percent.max *= 100 / diagonal;
  percent.mean *= 100 / diagonal;
  percent.rms *= 100 / diagonal;
  for (double& value : percent.percentiles) value *= 100 / diagonal;
  Json json = json_of(percent);
  json.erase("samples");
  return json;
}

Json json_of(const OneSidedComparison& side, double diagonal) {
  return {
      {"distance", json_of(side.distance)},
      {"distance_percent", percent_of(side.distance, diagonal)},
      {"angle_degrees", json_of(side.angle)},
      {"farthest", json_of(side.farthest)},
      {"opposite", json_of(side.opposite)},
  };
}

Json name_of(const std::optional<SideRule>& rule) {
  if (!rule) return nullptr;
  return *rule == SideRule::winding_number ? "winding_number" : "closest_facet";
}

Json json_of(const TwoWayError& e, double mean_edge) {
  if (e.empty()) return nullptr;
  const auto in_edges = [&](double rms) { return mean_edge > 0 ? Json(rms / mean_edge) : Json(); };
  return {
      {"angle_degrees", e.angle()},
      {"angle_degrees_there", e.there.angle},
      {"angle_degrees_back", e.back.angle},
      {"rms", e.rms()},
      {"rms_there", e.there.rms},
      {"rms_back", e.back.rms},
      {"rms_mean_edges", in_edges(e.rms())},
      {"rms_mean_edges_there", in_edges(e.there.rms)},
      {"rms_mean_edges_back", in_edges(e.back.rms)},
      {"samples_there", e.there.samples},
      {"samples_back", e.back.samples},
  };
}

Json json_of(const TruthFigures& f, double mean_edge) {
  return {
      {"all", json_of(f.error.all, mean_edge)},
      {"near_creases", json_of(f.error.near_creases, mean_edge)},
      {"elsewhere", json_of(f.error.elsewhere, mean_edge)},
      {"volume_percent", or_null(f.volume_percent)},
  };
}

Json json_of(const std::optional<InputFigures>& input) {
  if (!input) return nullptr;
  return {{"file", json_of(input->file)}, {"volume_percent", or_null(input->volume_percent)}};
}

Json json_of(const std::optional<FloorFigures>& floor, double mean_edge) {
  if (!floor) return nullptr;
  return {{"file", json_of(floor->file)}, {"figures", json_of(floor->figures, mean_edge)}};
}

Json json_of(const std::optional<TruthComparison>& t) {
  if (!t) return nullptr;
  return {
      {"mean_edge", t->mean_edge},
      {"crease_angle_degrees", t->crease_angle},
      {"crease_width", t->crease_width},
      {"creases", t->creases},
      {"crease_length", t->crease_length},
      {"result", json_of(t->result, t->mean_edge)},
      {"input", json_of(t->input)},
      {"floor", json_of(t->floor, t->mean_edge)},
  };
}

Json json_of(const std::optional<Registration>& r) {
  if (!r) return nullptr;
  Json rotation = Json::array();
  for (const Vec3& row : r->motion.rows) rotation.push_back(json_of(row));
  return {
      {"rotation", rotation},
      {"translation", json_of(r->motion.translation)},
      {"axis", json_of(r->motion.axis())},
      {"angle_degrees", r->motion.angle() * 180 / std::numbers::pi},
      {"rms_before", r->rms_before},
      {"rms_after", r->rms_after},
      {"rms_kept", r->rms_kept},
      {"kept", r->kept},
      {"samples", r->samples},
      {"starts", r->starts},
      {"iterations", r->iterations},
      {"converged", r->converged},
      {"free_motions", r->free_motions},
  };
}

}  // namespace

std::string to_json(const CompareResult& r) {
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"units", json_of(r.unit)},
      {"a", json_of(r.a)},
      {"b", json_of(r.b)},
      {"difference", differences(r.a, r.b)},
      {"exact", r.exact},
      {"diagonal", r.diagonal},
      {"alignment", json_of(r.alignment)},
      {"a_to_b", json_of(r.a_to_b, r.diagonal)},
      {"b_to_a", json_of(r.b_to_a, r.diagonal)},
      {"max", r.max()},
      {"max_percent", r.diagonal > 0 ? Json(100 * r.max() / r.diagonal) : Json()},
      {"limit", or_null(r.limit)},
      {"within_limit", r.limit ? Json(r.within_limit()) : Json()},
      {"deviation_sign", name_of(r.sign)},
      {"truth", json_of(r.truth)},
  });
}

}  // namespace burnish
