#include "run.h"

#include <fmt/format.h>
#include <pybind11/numpy.h>
#include <pybind11/stl.h>

#include <algorithm>
#include <optional>
#include <utility>
#include <vector>

#include "arrays.h"
#include "burnish/core/error.h"
#include "burnish/core/length.h"
#include "burnish/core/model_unit.h"
#include "burnish/core/parallel.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/pipeline/check.h"
#include "burnish/pipeline/clean.h"
#include "burnish/pipeline/compare_files.h"
#include "burnish/surface/weld.h"
#include "cli/clean_options.h"
#include "cli/suggest.h"
#include "python_progress.h"

namespace py = pybind11;

namespace burnish {
namespace {

// Runs `work(progress)` without the GIL.
template <class Work>
auto run(const RunSettings& settings, Work&& work) {
  PythonProgress progress(settings[1], settings[2].cast<std::optional<double>>());
  const int threads = settings[0].cast<std::optional<int>>().value_or(0);
  try {
    auto result = [&] {
      const py::gil_scoped_release released;
      const ThreadLimit limit(threads);
      return work(progress);
    }();
    progress.rethrow();
    return result;
  } catch (const Error&) {
    progress.rethrow();  // what has stopped it, rather than that it was stopped
    throw;
  }
}

std::string keyword_of(const Option& row) {
  std::string keyword(row.name.substr(2));
  std::replace(keyword.begin(), keyword.end(), '-', '_');
  return keyword;
}

const Option& row_of(const std::string& keyword, const std::vector<Option>& rows) {
  std::vector<std::string> known;
  for (const Option& row : rows) {
    known.push_back(keyword_of(row));
    if (known.back() == keyword) return row;
  }
  const auto near = nearest(keyword, known);
  throw py::type_error(fmt::format("clean() got an unexpected keyword argument '{}'{}", keyword, near ? fmt::format("; did you mean '{}'?", *near) : ""));
}

void set_switch(const Option& row, const std::string& keyword, bool on, const std::vector<Option>& rows) {
  if (on) return row.set({keyword, ""});
  if (row.opposite.empty()) return;
  const auto opposite = std::find_if(rows.begin(), rows.end(), [&](const Option& o) { return o.name == row.opposite; });
  opposite->set({keyword, ""});
}

// A value, by the rules of the command line; messages name the keyword. `unit`: the model's, if it is known.
void set_option(const Option& row, const std::string& keyword, const py::handle& value, const std::optional<ModelUnit>& unit, const std::vector<Option>& rows) {
  const bool is_bool = py::isinstance<py::bool_>(value);
  if (row.value.empty() != is_bool)
    throw Error(ErrorCode::usage, fmt::format("{} {}: expected {}", keyword, is_bool ? std::string(py::str(value)) : value.cast<std::string>(), is_bool ? "a value" : "True or False"), std::string(row.help));
  if (is_bool) return set_switch(row, keyword, value.cast<bool>(), rows);
  const std::string text = value.cast<std::string>();
  row.set({keyword, text, row.value.words, unit});
}

py::list sentences_of(const std::vector<std::string>& sentences) {
  py::list list;
  for (const std::string& s : sentences) list.append(text_of(s, "backslashreplace"));
  return list;
}

CleanOptions clean_options_of(const py::dict& given, const std::optional<ModelUnit>& unit) {
  CleanOptions options;
  options.unit = unit;
  const std::vector<Option> rows = with_clean_options({}, options);
  const auto set = [&](const std::string& keyword, const py::handle& value) { set_option(row_of(keyword, rows), keyword, value, options.unit, rows); };
  if (given.contains("units")) set("units", given["units"]);  // before the lengths that may be in another
  for (const auto& [key, value] : given)
    if (const std::string keyword = key.cast<std::string>(); keyword != "units") set(keyword, value);
  require_consistent(options);
  return options;
}

std::vector<std::string> warnings_of(const CleanOptions& options, const RepairReport& report) {
  std::vector<std::string> warnings;
  for (const std::string& name : idle_options(options)) warnings.push_back(name + " has no effect without --smooth");
  warnings.insert(warnings.end(), report.warnings.begin(), report.warnings.end());
  return warnings;
}

Length thickness_limit(const std::string& text, const std::optional<ModelUnit>& unit) {
  const auto length = parse_length(text, unit);
  if (length && length->value > 0 && length->unit != LengthUnit::cells) return *length;
  throw Error(ErrorCode::usage, fmt::format("min_thickness {}: expected a length above 0, not in cells", text),
              "write it as 0.5, as 0.2% of the diagonal, or, of a Mesh with a unit, as 0.5mm");
}

std::optional<ModelUnit> unit_of_source(const py::object& source) {
  return py::isinstance<py::tuple>(source) ? unit_of(source) : std::nullopt;
}

// The words of a file that says another unit than --units; a Mesh says it in memory.
void warn_of_units(const std::optional<ModelUnit>& of_source, const CleanOptions& options, std::vector<std::string>& warnings) {
  if (of_source && options.unit != of_source)
    warnings.push_back(fmt::format("the mesh says that its unit is {}, units says {}: the latter was believed, and no coordinate is changed", name(*of_source), name(*options.unit)));
}

CleanedSurface run_clean(const py::object& source, const CleanOptions& options, bool salvage, Precision precision, const RunSettings& settings) {
  if (py::isinstance<py::tuple>(source)) {
    TriangleSoup soup = soup_of(source);
    return run(settings, [&](Progress& progress) { return clean(std::move(soup), options, precision, progress); });
  }
  CleanJob job;
  job.input = source.cast<std::string>();
  job.options = options;
  job.salvage = salvage;
  return run(settings, [&](Progress& progress) { return clean_to_memory(job, precision, progress); });
}

}  // namespace

py::list clean_options() {
  py::list list;
  CleanOptions options;
  for (const Option& row : with_clean_options({}, options)) {
    std::string opposite(row.opposite.empty() ? "" : row.opposite.substr(2));
    std::replace(opposite.begin(), opposite.end(), '-', '_');
    list.append(py::make_tuple(keyword_of(row), row.value.name, row.group, row.help, opposite));
  }
  return list;
}

py::dict read(const std::string& path, bool salvage, bool welded) {
  MeshFile file;
  {
    const py::gil_scoped_release released;
    file = read_mesh(path, {.salvage = salvage});
    if (welded) file.soup = weld(std::move(file.soup));
  }
  py::dict result = arrays_of(std::move(file.soup));
  result["format"] = name(file.format);
  result["unit"] = file.unit ? py::object(py::str(std::string(name(*file.unit)))) : py::none();
  result["warnings"] = sentences_of(file.warnings);
  return result;
}

void write(const std::string& path, const py::tuple& surface, bool overwrite) {
  const TriangleSoup soup = soup_of(surface);
  const std::optional<ModelUnit> unit = unit_of(surface);
  const py::gil_scoped_release released;
  MeshWriteOptions options;
  options.format = format_for_writing(path);
  if (unit) options.unit = *unit;
  OutputFile file(path, overwrite);
  write_mesh(file.fd(), file.destination(), soup, options);
  file.commit();
}

py::dict check(const py::tuple& surface, bool thickness, const py::object& min_thickness, const RunSettings& settings) {
  TriangleSoup soup = soup_of(surface);
  CheckJob job;
  job.unit = unit_of(surface);
  job.thickness = thickness || !min_thickness.is_none();
  if (!min_thickness.is_none()) job.min_thickness = thickness_limit(min_thickness.cast<std::string>(), job.unit);
  const CheckResult found = run(settings, [&](Progress& progress) { return check(std::move(soup), job, progress); });
  py::dict result;
  result["json"] = to_json(found);
  return result;
}

py::dict clean(const py::object& source, const py::dict& given, bool salvage, bool float32, const RunSettings& settings) {
  const std::optional<ModelUnit> unit = unit_of_source(source);
  const CleanOptions options = clean_options_of(given, unit);
  CleanedSurface cleaned = run_clean(source, options, salvage, float32 ? Precision::float32 : Precision::float64, settings);
  RepairReport& report = cleaned.report;
  warn_of_units(unit, options, report.warnings);
  py::dict result = arrays_of(std::move(cleaned.surface));
  result["json"] = to_json(report);
  result["warnings"] = sentences_of(warnings_of(options, report));
  result["failure"] = py::none();
  if (report.failure) result["failure"] = py::make_tuple(name(report.failure->code()), text_of(report.failure->what(), "backslashreplace"), text_of(report.failure->hint(), "backslashreplace"));
  return result;
}

py::dict compare(const py::tuple& a, const py::tuple& b, std::size_t samples, bool exact, bool align, const RunSettings& settings) {
  CompareJob job;
  job.samples = samples;
  job.exact = exact;
  job.align = align;
  job.unit = unit_of(a);
  TriangleSoup first = soup_of(a), second = soup_of(b);
  CompareResult compared = run(settings, [&](Progress& progress) { return compare_surfaces(std::move(first), std::move(second), job, progress); });
  if (const auto of_b = unit_of(b); job.unit && of_b && job.unit != of_b)
    compared.b.warnings.push_back(fmt::format("its unit is {}, that of A is {}: coordinates are compared as they are", name(*of_b), name(*job.unit)));
  py::dict result;
  result["json"] = to_json(compared);
  return result;
}

py::array signed_distance(const py::tuple& surface, const py::object& points, bool exact, const RunSettings& settings) {
  TriangleSoup soup = soup_of(surface);
  const std::vector<Vec3> at = points_of(points, "points");
  return array_of(run(settings, [&](Progress& progress) { return signed_distances(std::move(soup), at, exact, progress); }));
}

}  // namespace burnish
