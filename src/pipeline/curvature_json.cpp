#include <fmt/format.h>

#include "burnish/pipeline/curvature.h"
#include "json.h"

namespace burnish {
namespace {

using burnish::json_of;

Json json_of(const CurvatureSpread& s) {
  Json json = {{"min", s.min}, {"max", s.max}, {"mean", s.mean}};
  for (std::size_t i = 0; i < kCurvaturePercentiles.size(); ++i) json[fmt::format("p{}", kCurvaturePercentiles[i])] = s.percentiles[i];
  return json;
}
Json json_of(const std::optional<CurvatureSpread>& s) { return s ? json_of(*s) : Json(); }

Json json_of(const std::optional<CurvatureRadius>& r) {
  if (!r) return nullptr;
  return {{"radius", r->radius}, {"position", json_of(r->position)}};
}

Json json_of(const CurvatureSummary& c) {
  return {
      {"points", c.points},
      {"determined", c.determined},
      {"lower_order", c.lower_order},
      {"facets", c.facets},
      {"area", c.area},
      {"determined_area", or_null(c.determined_area)},
      {"mean", json_of(c.mean)},
      {"mean_integral", or_null(c.mean_integral)},
      {"gaussian", json_of(c.gaussian)},
      {"gaussian_integral", or_null(c.gaussian_integral)},
      {"k1", json_of(c.k1)},
      {"k2", json_of(c.k2)},
      {"smallest_convex", json_of(c.convex)},
      {"smallest_concave", json_of(c.concave)},
      {"euler_characteristic", or_null(c.euler_characteristic)},
  };
}

Json json_of(const std::optional<CurvatureCheck>& c) {
  if (!c) return nullptr;
  return {{"points", c->points}, {"rms", c->rms}, {"median", c->median}, {"max", c->max}, {"rms_curvature", c->rms_curvature}, {"worst", json_of(c->worst)}};
}

Json output_of(const CurvatureFile& o) {
  if (o.file.empty()) return nullptr;
  return {{"file", o.file}, {"format", o.format}, {"written", o.written}, {"bytes", o.bytes}};
}

Json options_of(const CurvatureResult& r) {
  return {
      {"cell", r.options.cell},
      {"cell_was_chosen", r.options.cell_was_chosen},
      {"cells_along_longest_side", r.options.cells_along_longest_side},
      {"cells_per_mean_edge", r.options.cell > 0 ? Json(r.before.mean_edge / r.options.cell) : Json()},
      {"band", r.band},
      {"order", static_cast<int>(r.order)},
      {"at", name(r.at)},
      {"method", name(r.method)},
      {"gap", or_null(r.options.gap)},
      {"max_hole", or_null(r.options.max_hole)},
      {"memory_bytes", r.options.memory_bytes},
  };
}

Json smoothing_of(const SmoothingSummary& s) {
  if (!(s.length > 0)) return nullptr;
  return {{"length", s.length},         {"flow_time", s.flow_time},         {"steps", s.steps},
          {"redistance", name(s.redistance)}, {"volume_before", s.volume_before}, {"volume_after", s.volume_after}};
}

}  // namespace

std::string to_json(const CurvatureResult& r) {
  return text_of({
      {"version", kReportVersion},
      {"generator", generator()},
      {"input", {{"file", r.input}, {"format", r.input_format}}},
      {"units", json_of(r.unit)},
      {"output", output_of(r.output)},
      {"failure", failure_of(r.failure)},
      {"warnings", Json(r.warnings)},
      {"options", options_of(r)},
      {"smoothing", smoothing_of(r.smoothing)},
      {"curvature", r.failure ? Json() : json_of(r.curvature)},
      {"check", json_of(r.check)},
      {"stages", json_of(r.stages)},
  });
}

}  // namespace burnish
