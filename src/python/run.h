// The functions of `_burnish`. What they take has been sorted by the Python side: paths are bytes, surfaces tuples (vertices, faces, groups, colors, unit),
// options bytes or bools by keyword. All let go of the GIL while they work.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <string>

namespace burnish {

// How a run goes, whatever it does: a tuple (threads or None, progress or None, time_limit or None).
using RunSettings = pybind11::tuple;

// The rows of the command line's table: (keyword, what stands for the value or "" for a switch, group, help, opposite or "").
pybind11::list clean_options();
pybind11::dict read(const std::string& path, bool salvage, bool weld);
void write(const std::string& path, const pybind11::tuple& surface, bool overwrite);
// {"json": text of the check}. `min_thickness`: bytes, or None.
pybind11::dict check(const pybind11::tuple& surface, bool thickness, const pybind11::object& min_thickness, const RunSettings& settings);
// arrays_of, and "json" (the report), "warnings", "failure" (None, or (code, message, hint)).
pybind11::dict clean(const pybind11::object& source, const pybind11::dict& options, bool salvage, bool float32, const RunSettings& settings);
pybind11::dict compare(const pybind11::tuple& a, const pybind11::tuple& b, std::size_t samples, bool exact, bool align, const RunSettings& settings);
pybind11::array signed_distance(const pybind11::tuple& surface, const pybind11::object& points, bool exact, const RunSettings& settings);

}  // namespace burnish
