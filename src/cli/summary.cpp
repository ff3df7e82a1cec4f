#include "summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <functional>
#include <span>

namespace burnish {
namespace {

constexpr int kLabelWidth = 20;
constexpr int kColumnWidth = 14;

struct Row {
  std::string_view label;
  std::function<std::string(const Defects&)> cell;
  int power = 0;  // of the unit of length
};

std::string label_of(const Row& row, const std::optional<ModelUnit>& unit) {
  return unit && row.power > 0 ? fmt::format("{},{}", row.label, unit_suffix(unit, row.power)) : std::string(row.label);
}

std::string real(double value) { return fmt::format("{:.6g}", value); }

Row count_row(std::string_view label, std::size_t Defects::*count) {
  return {label, [count](const Defects& d) { return fmt::format("{}", d.*count); }};
}

const std::vector<Row>& rows() {
  static const std::vector<Row> table = {
      count_row("facets", &Defects::facets),
      count_row("points", &Defects::points),
      count_row("components", &Defects::components),
      count_row("open edges", &Defects::open_edges),
      count_row("open loops", &Defects::open_loops),
      count_row("non-manifold edges", &Defects::non_manifold_edges),
      count_row("non-manifold points", &Defects::non_manifold_points),
      count_row("misoriented edges", &Defects::misoriented_edges),
      count_row("misnested shells", &Defects::misnested_shells),
      count_row("degenerate facets", &Defects::degenerate_facets),
      count_row("duplicate facets", &Defects::duplicate_facets),
      {"self-intersections",
       [](const Defects& d) {
         return d.self_intersections_counted ? fmt::format("{}", d.self_intersecting_pairs) : "-";
       }},
      {"volume", [](const Defects& d) { return real(d.volume); }, 3},
      {"area", [](const Defects& d) { return real(d.area); }, 2},
      {"mean edge", [](const Defects& d) { return real(d.mean_edge); }, 1},
  };
  return table;
}

std::string plural(std::size_t count, std::string_view one, std::string_view many) {
  return fmt::format("{} {}", count, count == 1 ? one : many);
}

std::string box_line(const Box3& box, const std::optional<ModelUnit>& unit) {
  if (box.empty()) return {};
  const Vec3 e = box.extent();
  return fmt::format("{:<{}}{:.6g} x {:.6g} x {:.6g}, diagonal {:.6g}{}\n", "size", kLabelWidth, e.x, e.y, e.z,
                     box.diagonal(), unit_suffix(unit));
}

std::string deviation_line(std::string_view label, const OneSidedDistance& d, double diagonal, const std::string& unit) {
  const auto share = [&](double length) { return diagonal > 0 ? 100 * length / diagonal : 0.0; };
  return fmt::format("{:<{}}rms {:.3g}{} ({:.2g}%), max {:.3g}{} ({:.2g}%)\n", label, kLabelWidth, d.rms, unit,
                     share(d.rms), d.max, unit, share(d.max));
}

std::string defects_table(const RepairReport& report, bool has_after) {
  std::string text = fmt::format("{:<{}}{:>{}}{:>{}}\n", "", kLabelWidth, "before", kColumnWidth,
                                 has_after ? "after" : "", kColumnWidth);
  for (const Row& row : rows()) {
    text += fmt::format("{:<{}}{:>{}}{:>{}}\n", label_of(row, report.unit), kLabelWidth, row.cell(report.before), kColumnWidth,
                        has_after ? row.cell(report.after) : "", kColumnWidth);
  }
  return text;
}

std::string verdict(const RepairReport& report) {
  if (report.verified && report.written)
    return fmt::format("{}: {}", report.output, report.is_sheet ? "a valid open sheet" : "a valid solid");
  if (!report.written) return fmt::format("{}: not written", report.output);
  const std::string found = problems(report.after);
  return fmt::format("{}: written, but not verified{}{}", report.output, found.empty() ? "" : ": ", found);
}

std::string_view plural_of(DefectKind kind) {
  constexpr std::array<std::string_view, kDefectKinds> kPlurals = {
      "open loops",        "non-manifold edges", "non-manifold points", "misoriented edges",
      "degenerate facets", "duplicate facets",   "self-intersections"};
  return kPlurals[static_cast<std::size_t>(kind)];
}

// 76 columns, whatever the numbers: six digits with sign and exponent take 13.
std::string place_line(const LocatedDefect& d) {
  const auto size = [](double value) { return value > 0 ? fmt::format("{:.3g}", value) : std::string("-"); };
  return fmt::format("  {:>14.6g}{:>14.6g}{:>14.6g}{:>10}{:>10}{:>12}\n", d.position.x, d.position.y,
                     d.position.z, size(d.length), size(d.area), d.count);
}

// The first `places` of each kind; `locations` has the largest in front.
std::string where(std::span<const LocatedDefect> locations, std::size_t places) {
  std::string text;
  while (!locations.empty()) {
    const DefectKind kind = locations.front().kind;
    const auto is_kind = [kind](const LocatedDefect& d) { return d.kind == kind; };
    const auto end = std::ranges::find_if_not(locations, is_kind);
    const auto total = static_cast<std::size_t>(end - locations.begin());
    text += fmt::format("{}, ", plural_of(kind));
    text += total > places ? fmt::format("the {} largest of {} places\n", places, total)
                           : plural(total, "place", "places") + '\n';
    for (const LocatedDefect& d : locations.first(std::min(total, places))) text += place_line(d);
    locations = locations.subspan(total);
  }
  if (text.empty()) return text;
  return fmt::format("\n  {:>14}{:>14}{:>14}{:>10}{:>10}{:>12}\n", "x", "y", "z", "length", "area", "count") +
         text;
}

std::string options_details(const ResolvedOptions& options) {
  if (options.cell <= 0) return {};
  std::string text =
      fmt::format("\n{:<{}}{:.6g}{}, {:.4g} along the longest side\n", "cell", kLabelWidth, options.cell,
                  options.cell_was_chosen ? " (chosen)" : "", options.cells_along_longest_side);
  if (options.smooth > 0) text += fmt::format("{:<{}}{:.6g}\n", "smooth", kLabelWidth, options.smooth);
  if (options.smooth > 0) text += fmt::format("{:<{}}{}\n", "redistanced by", kLabelWidth, name(options.redistance));
  if (options.deviation) text += fmt::format("{:<{}}{:.6g}\n", "deviation", kLabelWidth, *options.deviation);
  return text;
}

std::string actions_details(const RepairActions& a) {
  std::string text;
  const auto line = [&](std::string_view label, std::size_t count) {
    if (count > 0) text += fmt::format("{:<32}{}\n", label, count);
  };
  line("degenerate facets dropped", a.degenerate_facets_dropped);
  line("duplicate facets dropped", a.duplicate_facets_dropped);
  line("wall facets dropped", a.wall_facets_dropped);
  line("points welded by tolerance", a.points_welded_within_tolerance);
  line("facets flipped", a.facets_flipped);
  line("open loops capped", a.open_loops_capped);
  line("ambiguous regions", a.ambiguous_regions);
  line("interior facets ignored", a.interior_facets_ignored);
  line("components lost", a.components_lost);
  line("small pieces left out", a.debris_dropped);
  line("facets cut", a.facets_cut);
  line("needles flipped away", a.needles_flipped);
  line("points split", a.points_split);
  line("intersecting pairs removed", a.intersecting_pairs_removed);
  line("facets removed", a.facets_removed);
  line("facets added", a.facets_added);
  return text.empty() ? text : "\n" + text;
}

std::string stages_details(const std::vector<StageCost>& stages) {
  std::string text = fmt::format("\n{:<32}{:>10}{:>10}{:>10}\n", "stage", "seconds", "CPU s", "peak MB");
  for (const StageCost& stage : stages) {
    text += fmt::format("{:<32}{:>10.2f}{:>10.2f}{:>10.0f}\n", stage.name, stage.wall_seconds,
                        stage.cpu_seconds, static_cast<double>(stage.peak_bytes) / 1e6);
  }
  return text;
}

std::string method_line(const RepairReport& report) {
  if (report.method.empty()) return {};
  return fmt::format("{:<{}}{}: {}\n", "method", kLabelWidth, report.method, report.method_reason);
}

std::string surface_details(const SurfaceSummary& surface) {
  std::string text;
  if (surface.extractor != Extractor::automatic) text += fmt::format("{:<{}}{}: {}\n", "surface", kLabelWidth, name(surface.extractor), surface.reason);
  if (surface.creases > 0)
    text += fmt::format("{:<{}}{} of {:.6g} in all, between {}\n", "creases", kLabelWidth, surface.creases, surface.crease_length, plural(surface.corners, "corner", "corners"));
  if (surface.facets_before > 0)
    text += fmt::format("{:<{}}from {} facets, within {:.3g}\n", "simplified", kLabelWidth, surface.facets_before, surface.simplify_deviation);
  const TopologySummary& topology = surface.topology;
  if (topology.genus) text += fmt::format("{:<{}}{}, {}\n", "genus", kLabelWidth, *topology.genus, plural(topology.cavities, "cavity", "cavities"));
  if (surface.shapes.facets > 0)
    text += fmt::format("{:<{}}smallest {:.3g}, {:.3g} of 1 %, {:.3g} of half of the facets\n", "angles", kLabelWidth, surface.shapes.smallest_angle,
                        surface.shapes.angle_of_hundredth, surface.shapes.median_angle);
  return text;
}

std::string details_of(const RepairReport& report) {
  std::string grid;
  if (report.grid.blocks > 0)
    grid = fmt::format("{:<{}}{} of 8 x 8 x 8 cells, {} of them finest, {} levels\n", "blocks", kLabelWidth, report.grid.blocks,
                       report.grid.finest_blocks, report.grid.levels);
  return options_details(report.options) + grid + surface_details(report.surface) + actions_details(report.actions) + stages_details(report.stages);
}

}  // namespace

std::string input_line(const std::string& input, std::string_view format, const std::optional<ModelUnit>& unit) {
  return fmt::format("{} ({}{}{})\n\n", input, format, unit ? ", in" : "", unit_suffix(unit));
}

std::string problems(const Defects& d) {
  std::string text;
  const auto add = [&](std::size_t count, std::string_view one, std::string_view many) {
    if (count > 0) text += (text.empty() ? "" : ", ") + plural(count, one, many);
  };
  if (d.facets == 0) return "no facets";
  add(d.open_edges, "open edge", "open edges");
  if (d.open_edges > 0) text += " in " + plural(d.open_loops, "loop", "loops");
  add(d.non_manifold_edges, "non-manifold edge", "non-manifold edges");
  add(d.non_manifold_points, "non-manifold point", "non-manifold points");
  add(d.misoriented_edges, "misoriented edge", "misoriented edges");
  add(d.degenerate_facets, "degenerate facet", "degenerate facets");
  add(d.duplicate_facets, "duplicate facet", "duplicate facets");
  const bool inside_out = d.volume < 0 && d.misnested_shells == d.components;
  if (!inside_out) add(d.misnested_shells, "misnested shell", "misnested shells");
  add(d.self_intersecting_pairs, "self-intersecting pair", "self-intersecting pairs");
  if (!text.empty() || d.valid_solid()) return text;
  if (!d.self_intersections_counted) return "self-intersections were not looked for";
  return d.volume < 0 ? "turned inside out" : "no volume";
}

namespace {

std::string point_text(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

std::string thickness_text(const ThicknessSummary& t, std::size_t places) {
  std::string text = fmt::format("\n{:<{}}{:.6g} at {}\n", "thinnest", kLabelWidth, t.minimum, point_text(t.thinnest_at));
  for (std::size_t i = 0; i < t.percentiles.size(); ++i)
    text += fmt::format("{:<{}}{:.6g} or less\n", fmt::format("  {} % of the area", ThicknessSummary::kPercentiles[i]), kLabelWidth, t.percentiles[i]);
  if (!(t.limit > 0)) return text;
  if (t.places.empty()) return text + fmt::format("nowhere thinner than {:.6g}\n", t.limit);
  text += fmt::format("thinner than {:.6g}: {:.3g} % of the area, {}\n", t.limit, 100 * t.thin_area / t.area, plural(t.places.size(), "place", "places"));
  for (std::size_t i = 0; i < std::min(places, t.places.size()); ++i) {
    const ThinPlace& p = t.places[i];
    text += fmt::format("  {:.6g} at {}, area {:.3g}, {:.3g} across\n", p.thickness, point_text(p.position), p.area, p.box.diagonal());
  }
  if (places < t.places.size()) text += fmt::format("  and {} more\n", t.places.size() - places);
  return text;
}

}  // namespace

std::string check_summary(const CheckResult& result, std::size_t places) {
  std::string text = input_line(result.input, result.input_format, result.unit);
  for (const Row& row : rows()) {
    text += fmt::format("{:<{}}{:>{}}\n", label_of(row, result.unit), kLabelWidth, row.cell(result.defects), kColumnWidth);
  }
  text += box_line(result.defects.box, result.unit);
  text += where(result.locations, places);
  if (result.thickness) text += thickness_text(*result.thickness, places);
  if (result.valid_solid) return text + "\nvalid solid\n";
  return text + fmt::format("\nnot a valid solid: {}\n", problems(result.defects));
}

std::string clean_summary(const RepairReport& report, double wall_seconds, bool details) {
  const bool has_after = report.after.facets > 0;
  std::string text = fmt::format("{} -> {}\n\n", report.input, report.output);
  text += defects_table(report, has_after);
  text += '\n';
  if (report.deviation.input_to_output.samples + report.deviation.output_to_input.samples > 0) {
    const double diagonal = report.before.box.diagonal();
    text += deviation_line("input -> output", report.deviation.input_to_output, diagonal, unit_suffix(report.unit));
    text += deviation_line("output -> input", report.deviation.output_to_input, diagonal, unit_suffix(report.unit));
  }
  text += method_line(report);
  if (details) text += details_of(report) + '\n';
  return text + fmt::format("{} ({:.1f} s)\n", verdict(report), wall_seconds);
}

}  // namespace burnish
