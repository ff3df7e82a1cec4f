// Between NumPy's arrays and the library's vectors.
//
// What comes in is checked and copied once. What goes out is not copied: the array lies on the vector, which a capsule, its `base`, keeps.
#pragma once

#include <pybind11/numpy.h>
#include <pybind11/pybind11.h>

#include <optional>
#include <string>
#include <vector>

#include "burnish/core/model_unit.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// The rows of an (n, 3) array of float32 or float64. Throws Error{usage} that names the array `what`, and the first row that is not finite.
std::vector<Vec3> points_of(const pybind11::handle& array, const std::string& what);

// vertices, faces ((m, 3), int32, int64, uint32 or uint64), groups (a list of (bytes or str, first, count)), and colors ((m, 4) uint8, or None).
// Throws Error{usage} that names array, row, expected and found.
TriangleSoup soup_of(const pybind11::tuple& surface);
// Bytes as a str. Those that are no UTF-8 are surrogates, and come back as they were; or, for texts that are only to be shown, `how` is "backslashreplace".
pybind11::str text_of(const std::string& bytes, const char* how = "surrogateescape");

// The fifth of the tuple: a unit's name, or None. Throws Error{usage} for another.
std::optional<ModelUnit> unit_of(const pybind11::tuple& surface);

// {"vertices": ..., "faces": ..., "groups": [...], "colors": ... or None}, without a copy.
pybind11::dict arrays_of(TriangleSoup&& soup);

pybind11::array array_of(std::vector<double>&& values);

}  // namespace burnish
