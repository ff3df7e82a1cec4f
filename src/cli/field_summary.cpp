#include "field_summary.h"

#include <fmt/format.h>

#include <cmath>
#include <optional>
#include <vector>

#include "percent.h"
#include "summary.h"

namespace burnish {
namespace {

std::string line(std::string_view label, const std::string& text) { return fmt::format("{:<20}{}\n", label, text); }

std::string check_lines(const DistanceCheck& check, double cell) {
  std::string strata;
  for (std::size_t s = 0; s < kNodeStrata; ++s)
    strata += fmt::format("{}{} {}", s == 0 ? "" : ", ", check.nodes[s], name(static_cast<NodeStratum>(s)));
  const auto errors = [&](const ErrorSummary& e) {
    const std::string verdict = e.exceeded == 0 ? fmt::format("at most {:.2g} of what is allowed", e.worst_share)
                                                : fmt::format("{} nodes beyond what is allowed", e.exceeded);
    return fmt::format("max {:.3g}, rms {:.3g}, {}", e.max * cell, e.rms * cell, verdict);
  };
  return line("nodes compared", fmt::format("{}", check.total())) + line("", strata) + line("error of kernel", errors(check.kernel)) +
         line("error of phi", errors(check.stored));
}

std::string redistancing_lines(const FieldRedistancing& r) {
  std::string text = line("accepted", r.exact == ExactNodes::cells ? fmt::format("{} cells, {} of them cut; {} nodes", r.cells_accepted, r.cells_cut, r.exact_nodes)
                                                                  : fmt::format("{} nodes, all within the band", r.exact_nodes));
  std::string how(name(r.method));
  if (r.result.steps > 0)
    how += fmt::format(", {} steps, the last one's rms change {:.2g} of it{}", r.result.steps, r.result.residual, r.result.steady ? "" : ": not steady");
  return text + line("redistanced", how);
}

std::string volume_line(const FieldVolume& v) {
  const std::string shift = v.prepared != 0 ? fmt::format(" ({})", percent(100 * (v.level_set / v.prepared - 1), true)) : "";
  return line("volume", fmt::format("{:.6g} of {:.6g}{}", v.level_set, v.prepared, shift));
}

std::string file_lines(const FieldFile& o) {
  const double megabytes = static_cast<double>(o.bytes) / 1e6;
  if (o.samples[0] > 0) return fmt::format("{}: {} x {} x {} samples, {:.6g} apart, {:.1f} MB", o.file, o.samples[0], o.samples[1], o.samples[2], o.spacing, megabytes);
  if (o.format == ".vdb") return fmt::format("{}: {} voxels of {:.6g} in the band, {:.1f} MB", o.file, o.voxel_count, o.spacing, megabytes);
  std::string size = fmt::format("{} cells, ", o.cell_count);
  size += o.octant_count > 0 ? fmt::format("{} octants", o.octant_count) : fmt::format("{} points", o.point_count);
  return fmt::format("{}: {}, {:.1f} MB", o.file, size, megabytes);
}

std::string division_lines(const RefinementLimits& limits, const GrowthStatistics& statistics, const std::optional<double>& adapt = {}) {
  std::vector<std::string> by;
  if (limits.max_face_limit) by.push_back(fmt::format("max-face-limit {}", *limits.max_face_limit));
  if (limits.max_face_cut) by.push_back(fmt::format("max-face-cut {}", *limits.max_face_cut));
  if (limits.refine_tol) by.push_back(fmt::format("refine-tol {:g}", *limits.refine_tol));
  if (adapt) by.push_back(fmt::format("adapt {:.4g}", *adapt));
  std::string text;
  for (std::size_t c = 0; c < by.size(); ++c)
    text += line(c == 0 ? "octants divided" : "", fmt::format("{} by {}", statistics.divided_by[c], by[c]));
  return text + line(by.empty() ? "octants divided" : "", fmt::format("{} for the balance alone", statistics.divided_by_balance));
}

}  // namespace

std::string summary_of(const FieldResult& r, double seconds) {
  std::string text = input_line(r.input, r.input_format, r.unit);
  text += line("cell", fmt::format("{:.6g}{}, {:.4g} along the longest side", r.options.cell, r.options.cell_was_chosen ? " (chosen)" : "",
                                   r.options.cells_along_longest_side));
  text += line("band", fmt::format("{:g} cells", r.band));
  text += line("blocks", fmt::format("{} of 8 x 8 x 8 cells, {} finest, {} near", r.grid.blocks, r.grid.finest_blocks, r.grid.near_blocks));
  text += line("levels", fmt::format("{}", r.grid.levels));
  if (r.is_adaptive()) {
    for (std::size_t l = 0; l < r.grid.by_level.size(); ++l)
      if (const FieldLevel& level = r.grid.by_level[l]; level.blocks > 0)
        text += line(fmt::format("  level {}", l), fmt::format("{} blocks, {} near, cells of {:.6g}", level.blocks, level.near_blocks,
                                                               std::ldexp(r.options.cell, static_cast<int>(l))));
    text += division_lines(r.limits, r.growth, r.options.adapt);
  }
  text += line("nodes", fmt::format("{}", r.grid.nodes));
  text += line("memory", fmt::format("{:.1f} MB", static_cast<double>(r.grid.bytes) / 1e6));
  text += line("regions", fmt::format("{}, {} of them ambiguous", r.regions, r.ambiguous_regions));
  text += line("facets", fmt::format("{}, {} of them inside, {} unresolved", r.facets, r.interior_facets, r.unresolved_facets));
  if (r.smoothing.mode != SmoothMode::automatic)
    text += line("smoothed", fmt::format("mode {} ({}), the surface moved by {:.4g} (rms)", name(r.smoothing.mode), r.smoothing.mode_reason, r.smoothing.rms_moved));
  else if (!r.smoothing.mode_reason.empty())
    text += line("smoothed", "not: " + r.smoothing.mode_reason);
  if (r.redistancing) text += redistancing_lines(*r.redistancing);
  text += volume_line(r.volume);
  if (r.verification) text += check_lines(*r.verification, r.options.cell);
  return text + fmt::format("\n{} ({:.1f} s)\n", r.output.written ? file_lines(r.output) : "nothing was written", seconds);
}

std::string summary_of(const CellOctreeResult& r, double seconds) {
  const GrowthStatistics& s = r.statistics;
  std::string text = input_line(r.input, r.input_format, r.unit);
  text += line("facets", fmt::format("{}", r.facets));
  text += line("cell", fmt::format("{:.6g} to {:.6g}, {:.4g} along the longest side", r.cell, r.cell_max, r.cells_along_longest_side));
  text += line("cells", fmt::format("{}, {} cut by facets", s.cells(), s.cells_cut()));
  for (std::size_t l = 0; l < s.levels.size(); ++l)
    if (s.levels[l].cells > 0)
      text += line(fmt::format("  level {}", l), fmt::format("{}, {} cut, side {:.6g}", s.levels[l].cells, s.levels[l].cells_cut,
                                                             std::ldexp(r.cell, static_cast<int>(l))));
  text += division_lines(r.limits, s);
  text += line("memory", fmt::format("{:.1f} MB", static_cast<double>(r.bytes) / 1e6));
  return text + fmt::format("\n{} ({:.1f} s)\n", r.output.written ? file_lines(r.output) : "nothing was written", seconds);
}

}  // namespace burnish
