#include "ic_summary.h"

#include <fmt/format.h>

#include "burnish/core/text.h"

namespace burnish {
namespace {

std::string line(std::string_view label, const std::string& text) { return fmt::format("{:<20}{}\n", label, text); }

std::string mesh_lines(const CaseMesh& m) {
  std::string patches;
  for (const CaseMesh::Patch& p : m.patches) patches += fmt::format("{}{} ({}, {} faces)", patches.empty() ? "" : ", ", p.name, p.type, p.faces);
  return line("mesh", m.folder) + line("  cells", fmt::format("{}, of {:.4g} to {:.4g}, {:.6g} together", m.cells, m.smallest_cell, m.largest_cell, m.volume)) +
         line("  faces", fmt::format("{}, {} of them inside", m.faces, m.internal_faces)) + line("  patches", patches) + line("  box", text_of(m.box));
}

std::string solid_lines(const InitialConditionResult& r) {
  const SolidSummary& s = r.solid;
  return line("model", fmt::format("{} facets, {}{}", s.facets, s.repair_reason, r.scale != 1 ? fmt::format("; scaled by {:g}", r.scale) : "")) +
         line("  volume", fmt::format("{:.10g}, area {:.6g}", s.volume, s.area)) + line("  box", text_of(s.box));
}

std::string alpha_lines(const InitialConditionResult& r) {
  const FractionSummary& a = r.alpha;
  std::string how(name(a.method));
  if (a.cell > 0) how += fmt::format(", level set with cells of {:.4g}", a.cell);
  const double of = a.method == FractionMethod::exact ? r.solid.volume : a.in_mesh;
  const std::string difference = a.difference ? fmt::format("{:+.3g} of {:.10g}{}", *a.difference, of, of > 0 ? fmt::format(" ({:+.2g} of it)", *a.difference / of) : "")
                                              : fmt::format("{:.6g} of {:.6g} is in the mesh", a.in_mesh, r.solid.volume);
  std::string text = line("method", how) + line("phase", fmt::format("{:.10g}{}", a.volume, r.invert ? ", outside the model" : "")) + line("  difference", difference) +
                     line("  mixed cells", fmt::format("{}", a.mixed)) + line("  range", fmt::format("{:g} to {:g}", a.min, a.max));
  if (a.clamped > 0) text += line("  clamped", fmt::format("{} cells, by {:.2g} at most", a.clamped, a.worst_clamp));
  return text;
}

std::string field_lines(const InitialConditionResult& r) {
  std::string text;
  for (const CaseField& f : r.fields)
    text += fmt::format("{}{}: {}\n", f.file, f.written ? "" : " (not written)", f.from.empty() ? "new, zeroGradient" : "conditions of " + f.from);
  return text;
}

}  // namespace

std::string summary_of(const InitialConditionResult& r, double seconds) {
  return fmt::format("{} ({})\n\n", r.input, r.input_format) + mesh_lines(r.mesh) + solid_lines(r) + alpha_lines(r) + "\n" + field_lines(r) + fmt::format("{:.1f} s\n", seconds);
}

}  // namespace burnish
