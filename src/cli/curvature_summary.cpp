#include "curvature_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <numbers>

#include "percent.h"
#include "summary.h"

namespace burnish {
namespace {

constexpr int kLabelWidth = 20, kColumnWidth = 12;

std::string line(std::string_view label, const std::string& text) { return fmt::format("{:<{}}{}\n", label, kLabelWidth, text); }

std::string number(double value) { return fmt::format("{:.4g}", value); }

std::string spread_head() {
  std::string text = fmt::format("\n{:<{}}{:>{}}", "", 8, "min", kColumnWidth);
  for (const double p : {1, 50, 99}) text += fmt::format("{:>{}}", fmt::format("{} %", p), kColumnWidth);
  return text + fmt::format("{:>{}}{:>{}}\n", "max", kColumnWidth, "average", kColumnWidth);
}

std::string spread_line(std::string_view label, const CurvatureSpread& s) {
  std::string text = fmt::format("{:<8}{:>{}}", label, number(s.min), kColumnWidth);
  for (const std::size_t i : {std::size_t{0}, std::size_t{2}, std::size_t{4}}) text += fmt::format("{:>{}}", number(s.percentiles[i]), kColumnWidth);
  return text + fmt::format("{:>{}}{:>{}}\n", number(s.max), kColumnWidth, number(s.mean), kColumnWidth);
}

std::string radius_line(std::string_view label, const std::optional<CurvatureRadius>& r) {
  if (!r) return line(label, "none");
  return line(label, fmt::format("{:.4g} at ({:.6g}, {:.6g}, {:.6g})", r->radius, r->position.x, r->position.y, r->position.z));
}

// Gauss and Bonnet.
std::string gaussian_line(const CurvatureSummary& c) {
  const double found = *c.gaussian_integral;
  if (!c.euler_characteristic) return line("integral of k1 k2", fmt::format("{:.6g} (the surface is open)", found));
  const double due = 2 * std::numbers::pi * static_cast<double>(*c.euler_characteristic);
  const std::string off = due != 0 ? percent(100 * (found / due - 1), true) : fmt::format("off by {:.2g}", found);
  return line("integral of k1 k2", fmt::format("{:.6g} of 2 pi {} = {:.6g} ({})", found, *c.euler_characteristic, due, off));
}

std::string share(std::size_t part, std::size_t all) {
  return all > 0 ? percent(100 * static_cast<double>(part) / static_cast<double>(all)) : "0 %";
}

std::string points_lines(const CurvatureResult& r) {
  const CurvatureSummary& c = r.curvature;
  std::string text = line("points", fmt::format("{} of {}", c.points, r.at == CurvaturePoints::surface ? "the extracted surface" : "the input"));
  const std::size_t none = c.points - c.determined;
  std::string undetermined = fmt::format("{} ({})", none, share(none, c.points));
  if (c.determined_area) undetermined += fmt::format(", {} of the area", percent(c.area > 0 ? 100 * (1 - *c.determined_area / c.area) : 0.0));
  text += line("undetermined", undetermined);
  if (c.lower_order > 0) text += line("of lower order", fmt::format("{} ({})", c.lower_order, share(c.lower_order, c.points)));
  return text;
}

}  // namespace

std::string curvature_summary(const CurvatureResult& r, double seconds) {
  const CurvatureSummary& c = r.curvature;
  std::string text = input_line(r.input, r.input_format, r.unit);
  text += line("cell", fmt::format("{:.6g}{}, {:.4g} along the longest side, {:.3g} a mean edge", r.options.cell, r.options.cell_was_chosen ? " (chosen)" : "",
                                   r.options.cells_along_longest_side, c.mean_edge / r.options.cell));
  if (r.options.smooth > 0) text += line("smooth", fmt::format("{:.6g}", r.options.smooth));
  text += line("method", fmt::format("{}, order {}", name(r.method), static_cast<int>(r.order)));
  text += points_lines(r);
  text += spread_head() + spread_line("mean", c.mean);
  if (c.gaussian) text += spread_line("k1 k2", *c.gaussian) + spread_line("k1", *c.k1) + spread_line("k2", *c.k2);
  text += '\n';
  if (c.mean_integral)
    text += line("integral of mean", fmt::format("{:.6g} over {:.6g} of area", *c.mean_integral, *c.determined_area));
  else
    text += line("percentiles", "and averages are of points, all weighing the same");
  if (c.gaussian_integral) text += gaussian_line(c);
  if (c.gaussian) text += radius_line("smallest convex r", c.convex) + radius_line("smallest concave r", c.concave);
  if (r.check)
    text += line("checked by fits", fmt::format("{} points: median {:.2g}, rms {:.2g}, max {:.2g} of rms {:.3g}", r.check->points, r.check->median, r.check->rms,
                                                r.check->max, r.check->rms_curvature));
  const std::string file = r.output.written ? fmt::format("{}: {} points, {:.1f} MB", r.output.file, c.points, static_cast<double>(r.output.bytes) / 1e6) : "nothing was written";
  return text + fmt::format("\n{} ({:.1f} s)\n", file, seconds);
}

}  // namespace burnish
