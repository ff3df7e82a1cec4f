#include "compare_summary.h"

#include <fmt/format.h>

#include <numbers>
#include <vector>

namespace burnish {
namespace {

constexpr int kLabelWidth = 20;
constexpr int kColumnWidth = 14;
constexpr int kWideColumn = 24;
constexpr int kErrorLabelWidth = 26;
constexpr int kErrorColumn = 14;

std::string real(double value) { return fmt::format("{:.6g}", value); }

std::string row(std::string_view label, const std::string& a, const std::string& b, const std::string& difference) {
  return fmt::format("{:<{}}{:>{}}{:>{}}{:>{}}\n", label, kLabelWidth, a, kColumnWidth, b, kColumnWidth, difference, kColumnWidth);
}

std::string count_row(std::string_view label, std::size_t a, std::size_t b) {
  const auto difference = static_cast<std::int64_t>(b) - static_cast<std::int64_t>(a);
  return row(label, fmt::format("{}", a), fmt::format("{}", b), fmt::format("{:+}", difference));
}

std::string real_row(std::string_view label, double a, double b) {
  return row(label, real(a), real(b), fmt::format("{:+.6g}", b - a));
}

std::string volume_rows(const ComparedFile& a, const ComparedFile& b) {
  if (a.volume && b.volume) return real_row("volume", *a.volume, *b.volume);
  const auto cell = [](const ComparedFile& f) { return f.volume ? real(*f.volume) : std::string("-"); };
  std::string text = row("volume", cell(a), cell(b), "-");
  for (const ComparedFile* f : {&a, &b})
    if (!f->volume) text += fmt::format("  no volume of {}: {}\n", f == &a ? "A" : "B", f->no_volume_reason);
  return text;
}

std::string sizes(const ComparedFile& a, const ComparedFile& b) {
  const Defects &p = a.measures, &q = b.measures;
  std::string text = row("", "A", "B", "B - A");
  text += count_row("facets", p.facets, q.facets);
  text += count_row("points", p.points, q.points);
  text += count_row("components", p.components, q.components);
  text += count_row("open edges", p.open_edges, q.open_edges);
  text += volume_rows(a, b);
  text += real_row("area", p.area, q.area);
  for (int i = 0; i < 3; ++i)
    text += real_row(fmt::format("size along {}", "xyz"[i]), p.box.extent()[i], q.box.extent()[i]);
  return text + real_row("diagonal", p.box.diagonal(), q.box.diagonal());
}

// A row for each of max, mean, rms and the percentiles; `cell` makes a text of a value.
template <class Cell>
std::string distribution_rows(const Distribution& there, const Distribution& back, Cell&& cell) {
  const auto line = [&](const std::string& label, double x, double y) {
    return fmt::format("{:<{}}{:>{}}{:>{}}\n", label, kLabelWidth, cell(x), kWideColumn, cell(y), kWideColumn);
  };
  std::string text = line("  mean", there.mean, back.mean) + line("  rms", there.rms, back.rms);
  for (std::size_t i = 0; i < kPercentiles.size(); ++i)
    text += line(fmt::format("  {} % within", kPercentiles[i]), there.percentiles[i], back.percentiles[i]);
  return text + line("  max", there.max, back.max);
}

std::string place(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

std::string farthest_line(std::string_view from, std::string_view to, const OneSidedComparison& side) {
  return fmt::format("farthest of {} from {}: {:.6g}\n  from {} on {}\n  to   {} on {}\n", from, to, side.distance.max,
                     place(side.farthest), from, place(side.opposite), to);
}

// A column of the table of errors: a surface.
struct ErrorColumn {
  std::string_view title;
  const TruthFigures& figures;
};

std::string percent_cell(const std::optional<double>& percent) { return percent ? fmt::format("{:+.3f}", *percent) : "-"; }

// `value` of each column, and of two columns their difference.
template <class Value>
std::string error_row(std::string_view label, const std::vector<ErrorColumn>& columns, Value&& value) {
  std::string text = fmt::format("{:<{}}", label, kErrorLabelWidth);
  for (const ErrorColumn& c : columns) text += fmt::format("{:>{}}", fmt::format("{:.4g}", value(c.figures)), kErrorColumn);
  if (columns.size() == 2) {
    text += fmt::format("{:>{}}", fmt::format("{:+.4g}", value(columns[0].figures) - value(columns[1].figures)), kErrorColumn);
  }
  return text + '\n';
}

// The rows of one part of the surfaces: all of it, near creases, elsewhere.
std::string part_rows(std::string_view name, TwoWayError TruthError::*part, const std::vector<ErrorColumn>& columns, double mean_edge) {
  if ((columns[0].figures.error.*part).empty()) return fmt::format("{}: no samples\n", name);
  const auto of = [&](const TruthFigures& f) -> const TwoWayError& { return f.error.*part; };
  std::string text = fmt::format("{}\n", name);
  text += error_row("  angle, degrees", columns, [&](const TruthFigures& f) { return of(f).angle(); });
  text += error_row("    A -> B", columns, [&](const TruthFigures& f) { return of(f).there.angle; });
  text += error_row("    B -> A", columns, [&](const TruthFigures& f) { return of(f).back.angle; });
  if (mean_edge > 0)
    text += error_row("  rms, mean edges of B", columns, [&](const TruthFigures& f) { return of(f).rms() / mean_edge; });
  return text + error_row("  rms", columns, [&](const TruthFigures& f) { return of(f).rms(); });
}

std::string drift_rows(const TruthComparison& t) {
  std::string text = fmt::format("{:<{}}{:>{}}", "volume off B's, %", kErrorLabelWidth, percent_cell(t.result.volume_percent), kErrorColumn);
  if (t.floor) text += fmt::format("{:>{}}", percent_cell(t.floor->figures.volume_percent), kErrorColumn);
  text += '\n';
  if (t.input)
    text += fmt::format("{:<{}}{:>{}}\n", "volume off input's, %", kErrorLabelWidth, percent_cell(t.input->volume_percent), kErrorColumn);
  return text;
}

std::string truth_rows(const TruthComparison& t) {
  std::vector<ErrorColumn> columns{{"A", t.result}};
  if (t.floor) columns.push_back({"floor", t.floor->figures});
  std::string text = fmt::format("\nerrors against B, of {} and {} samples; mean edge of B {:.4g}\n", t.result.error.all.there.samples,
                                 t.result.error.all.back.samples, t.mean_edge);
  text += fmt::format("creases of B over {:g} degrees: {}; near: within {:.4g}\n", t.crease_angle, t.creases, t.crease_width);
  text += fmt::format("{:<{}}", "", kErrorLabelWidth);
  for (const ErrorColumn& c : columns) text += fmt::format("{:>{}}", c.title, kErrorColumn);
  if (t.floor) text += fmt::format("{:>{}}", "A - floor", kErrorColumn);
  text += '\n' + part_rows("everywhere", &TruthError::all, columns, t.mean_edge);
  text += part_rows("near creases", &TruthError::near_creases, columns, t.mean_edge);
  text += part_rows("elsewhere", &TruthError::elsewhere, columns, t.mean_edge);
  return text + drift_rows(t);
}

std::string alignment_rows(const Registration& r) {
  std::string text = fmt::format("\nA was moved onto B: rotated by {:.6g} degrees about ({:.6g}, {:.6g}, {:.6g}),\n  then shifted by {}\n", r.motion.angle() * 180 / std::numbers::pi,
                                 r.motion.axis().x, r.motion.axis().y, r.motion.axis().z, place(r.motion.translation));
  text += fmt::format("  rms {:.4g} before, {:.4g} after, {:.4g} of the {:.0f} % of samples that counted\n", r.rms_before, r.rms_after, r.rms_kept, 100 * r.kept);
  if (!r.converged) text += "  it did not converge: the surfaces may not be of the same shape\n";
  if (r.free_motions > 0) text += fmt::format("  not unique: {} of 6 motions make no difference to the surfaces\n", r.free_motions);
  return text;
}

std::string answer(const CompareResult& r) {
  if (!r.limit) return {};
  return fmt::format("{}: the largest distance, {:.6g}, is {} {:.6g}\n", r.within_limit() ? "yes" : "no", r.max(),
                     r.within_limit() ? "within" : "beyond", *r.limit);
}

}  // namespace

std::string compare_summary(const CompareResult& r) {
  const auto length = [&](double value) {
    if (!(r.diagonal > 0)) return fmt::format("{:.4g}", value);
    return fmt::format("{:.4g} ({:.2g}%)", value, 100 * value / r.diagonal);
  };
  const auto degrees = [](double value) { return fmt::format("{:.4g}", value); };
  std::string text = fmt::format("A: {} ({})\nB: {} ({})\n{}\n", r.a.file, r.a.format, r.b.file, r.b.format, r.unit ? fmt::format("lengths in{}\n", unit_suffix(r.unit)) : "");
  text += sizes(r.a, r.b);
  if (r.alignment) text += alignment_rows(*r.alignment);
  text += fmt::format("\n{:<{}}{:>{}}{:>{}}\n", "", kLabelWidth, "A -> B", kWideColumn, "B -> A", kWideColumn);
  text += fmt::format("{}distance, of {} and {} samples\n", r.exact ? "exact " : "", r.a_to_b.distance.samples,
                      r.b_to_a.distance.samples);
  text += distribution_rows(r.a_to_b.distance, r.b_to_a.distance, length);
  if (r.a_to_b.angle.samples + r.b_to_a.angle.samples > 0) {
    text += "angle between normals, degrees\n" + distribution_rows(r.a_to_b.angle, r.b_to_a.angle, degrees);
  }
  text += '\n' + farthest_line("A", "B", r.a_to_b) + farthest_line("B", "A", r.b_to_a);
  text += fmt::format("largest distance either way: {}\n", length(r.max()));
  if (r.truth) text += truth_rows(*r.truth);
  return text + answer(r);
}

}  // namespace burnish
