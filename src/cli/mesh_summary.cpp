#include "mesh_summary.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "burnish/core/text.h"
#include "percent.h"
#include "summary.h"

namespace burnish {
namespace {

std::string line(std::string_view label, const std::string& text) { return fmt::format("{:<20}{}\n", label, text); }

std::string solid_lines(const MeshedSolid& s) {
  std::string repair = s.repair_reason;
  if (s.cell > 0) repair += fmt::format("; level set with cells of {:.4g}", s.cell);
  return line("model", fmt::format("{} facets, {}", s.facets, repair)) + line("  box", text_of(s.box));
}

std::string shape_lines(const MeshQuality& q) {
  constexpr std::string_view kNames[kCellShapes] = {"tetrahedra", "pyramids", "wedges", "hexahedra", "polyhedra"};
  std::string text;
  for (std::size_t s = 0; s < kCellShapes; ++s)
    if (q.cells_of_shape[s] > 0) text += line(fmt::format("  {}", kNames[s]), fmt::format("{}, {} of the volume", q.cells_of_shape[s], percent(100 * q.volume_of_shape[s] / q.volume)));
  return text;
}

std::string level_line(const FlowMeshResult& r) {
  std::string levels;
  for (std::size_t l = 0; l < r.cells_of_level.size(); ++l)
    if (r.cells_of_level[l] > 0) levels += fmt::format("{}{} of {:.4g}", levels.empty() ? "" : ", ", r.cells_of_level[l], std::ldexp(r.finest_cell, static_cast<int>(l)));
  return levels.empty() ? "" : line("  sizes", levels);
}

std::string mesh_lines(const FlowMeshResult& r) {
  const MeshQuality& q = r.quality;
  std::string cell = fmt::format("{:.6g} at the surface{}, {:.4g} along the longest side", r.cell, r.cell_was_chosen ? " (chosen)" : "", r.cells_along_longest_side);
  if (r.cells_wanted) cell += fmt::format("; {} meshes for {} cells", r.trials.size(), *r.cells_wanted);
  std::string text = line("mesh", fmt::format("{}, {}, in {}", name(r.side), name(r.flavour), text_of(r.box))) + line("  cell", cell) +
                     line("  cells", fmt::format("{}, {} points, {} faces", q.cells, q.points, q.faces)) + shape_lines(q) + level_line(r);
  if (const MeshedLayers& l = r.layers; l.count > 0)
    text += line("  layers", fmt::format("{}, {:.4g} thick together, on {} of the wall's area; first {:.4g} to {:.4g} high ({:.4g} asked for)", l.count, l.thickness, percent(100 * l.covered), l.least_first,
                                         l.greatest_first, l.first));
  text += line("  cell volumes", fmt::format("{:.4g} to {:.4g}", r.smallest_cell, r.largest_cell));
  text += line("  volume", fmt::format("{:.8g} of {:.8g} ({})", q.volume, r.volume_wanted, percent(100 * (q.volume / r.volume_wanted - 1), true)));
  text += line("  regions", q.regions == r.regions_wanted ? fmt::format("{}", q.regions) : fmt::format("{}, and {} were wanted", q.regions, r.regions_wanted));
  return text;
}

std::string patch_lines(const FlowMeshResult& r) {
  std::string text;
  for (const MeshedPatch& p : r.patches) {
    const std::string group = p.group.empty() || p.group == p.name ? "" : fmt::format(", made from '{}'", p.group);
    text += line(text.empty() ? "patches" : "", fmt::format("{} ({}): {} faces, area {:.6g}{}", p.name, p.type, p.faces, p.area, group));
  }
  const auto in_cells = [&](const OneSidedDistance& d) { return fmt::format("{:.3g} at most, {:.3g} rms", d.max / r.cell, d.rms / r.cell); };
  if (r.surface_to_patches.samples > 0)
    text += line("surface to patches", in_cells(r.surface_to_patches) + " (in cells)") + line("patches to surface", in_cells(r.patches_to_surface));
  if (r.moved_back > 0) text += line("moved back", fmt::format("{} points, for the quality of their cells", r.moved_back));
  return text;
}

std::string check_lines(const FlowMeshResult& r) {
  std::string text = line("quality", r.quality.ok ? "passes checkMesh -allTopology -allGeometry" : r.quality.plain_ok ? "passes checkMesh, but not with -allTopology -allGeometry" : "does not pass checkMesh");
  for (const MeshCheck& c : r.quality.checks) {
    if (c.measured == 0) continue;
    const std::string mean = c.mean != 0 ? fmt::format(", mean {:.4g}", c.mean) : "";
    const std::string failing = c.failing > 0 ? fmt::format(": {}{}", c.failing, c.passed ? "" : " FAIL") : "";
    text += line("  " + c.name, fmt::format("{:.4g}{} (limit {:.4g}){}", c.worst, mean, c.limit, failing));
  }
  if (r.quality.cells_of_shape[static_cast<std::size_t>(CellShape::tetrahedron)] > 0)
    text += line("  dihedral angles", fmt::format("{:.4g} to {:.4g} degrees, of tetrahedra", r.quality.least_dihedral, r.quality.greatest_dihedral));
  return text;
}

std::string cost_line(const FlowMeshResult& r) {
  return line("meshing", fmt::format("{:.1f} CPU seconds, {:.0f} cells per second; {:.0f} MB at most in this run", r.cost.seconds, r.cost.cells_per_second,
                                     static_cast<double>(r.cost.peak_bytes) / 1e6));
}

}  // namespace

std::string summary_of(const FlowMeshResult& r, double seconds) {
  std::string text = input_line(r.input, r.input_format, r.unit) + solid_lines(r.solid);
  if (r.meshed) text += mesh_lines(r) + patch_lines(r) + check_lines(r) + cost_line(r);
  return text + fmt::format("\n{} ({:.1f} s)\n", r.written ? fmt::format("{} ({})", r.output, r.output_format) : "nothing was written", seconds);
}

}  // namespace burnish
