#include "arrays.h"

#include <fmt/format.h>

#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <limits>
#include <type_traits>
#include <utility>

#include "burnish/core/error.h"

namespace py = pybind11;

namespace burnish {
namespace {

static_assert(sizeof(Vec3) == 3 * sizeof(double) && std::is_trivially_copyable_v<Vec3>, "arrays lie on vectors of points");
static_assert(sizeof(Facet) == 3 * sizeof(std::uint32_t), "arrays lie on vectors of facets");
static_assert(std::endian::native == std::endian::little, "a colour's first byte is red");

template <class T>
using Rows = py::array_t<T, py::array::c_style | py::array::forcecast>;

[[noreturn]] void refuse(const std::string& message, const std::string& hint = {}) { throw Error(ErrorCode::usage, message, hint); }

std::string shape_of(const py::array& array) {
  std::string text;
  for (py::ssize_t i = 0; i < array.ndim(); ++i) text += fmt::format("{}{}", i > 0 ? ", " : "", array.shape(i));
  return fmt::format("({}{})", text, array.ndim() == 1 ? "," : "");
}

py::array table_of(const py::handle& given, const std::string& what, py::ssize_t columns) {
  if (!py::isinstance<py::array>(given)) refuse(fmt::format("{}: expected a NumPy array, found {}", what, std::string(py::str(py::type::of(given).attr("__name__")))));
  py::array array = py::reinterpret_borrow<py::array>(given);
  if (array.ndim() != 2 || array.shape(1) != columns)
    refuse(fmt::format("{}: expected the shape (n, {}), found {}", what, columns, shape_of(array)), "one row per point or triangle");
  return array;
}

[[noreturn]] void refuse_type(const py::array& array, const std::string& what, const char* wanted, const char* hint) {
  refuse(fmt::format("{}: expected {}, found {}", what, wanted, std::string(py::str(array.dtype()))), hint);
}

template <class T>
std::vector<Vec3> read_points(const py::array& array, const std::string& what) {
  const Rows<T> rows(array);
  const T* p = rows.data();
  std::vector<Vec3> points(static_cast<std::size_t>(rows.shape(0)));
  for (std::size_t i = 0; i < points.size(); ++i, p += 3) {
    points[i] = {static_cast<double>(p[0]), static_cast<double>(p[1]), static_cast<double>(p[2])};
    if (!std::isfinite(p[0]) || !std::isfinite(p[1]) || !std::isfinite(p[2]))
      refuse(fmt::format("{}: row {} is not finite: ({}, {}, {})", what, i, p[0], p[1], p[2]), "leave out such points, and the faces that use them");
  }
  return points;
}

template <class T>
std::vector<Facet> read_facets(const py::array& array, std::size_t points) {
  const Rows<T> rows(array);
  const T* p = rows.data();
  std::vector<Facet> facets(static_cast<std::size_t>(rows.shape(0)));
  for (std::size_t i = 0; i < facets.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k, ++p) {
      if (std::cmp_less(*p, 0) || std::cmp_greater_equal(*p, points))
        refuse(fmt::format("faces: row {} has the index {}, and there are {} vertices", i, *p, points), "indices count from 0");
      facets[i][k] = static_cast<std::uint32_t>(*p);
    }
  return facets;
}

std::vector<Facet> facets_of(const py::handle& given, std::size_t points) {
  const py::array array = table_of(given, "faces", 3);
  if (array.shape(0) == 0) refuse("faces: no rows", "there is nothing to work on");
  if (std::cmp_greater(array.shape(0), std::numeric_limits<std::uint32_t>::max() - 1)) refuse("faces: more rows than 32 bits can count");
  if (py::isinstance<py::array_t<std::uint32_t>>(array)) return read_facets<std::uint32_t>(array, points);
  if (py::isinstance<py::array_t<std::int32_t>>(array)) return read_facets<std::int32_t>(array, points);
  if (py::isinstance<py::array_t<std::int64_t>>(array)) return read_facets<std::int64_t>(array, points);
  if (py::isinstance<py::array_t<std::uint64_t>>(array)) return read_facets<std::uint64_t>(array, points);
  refuse_type(array, "faces", "int32, int64, uint32 or uint64", "faces.astype('uint32') converts");
}

std::vector<Color> colors_of(const py::handle& given, std::size_t facets) {
  if (given.is_none()) return {};
  const py::array array = table_of(given, "colors", 4);
  if (!py::isinstance<py::array_t<std::uint8_t>>(array)) refuse_type(array, "colors", "uint8", "red, green, blue and alpha from 0 to 255");
  if (std::cmp_not_equal(array.shape(0), facets)) refuse(fmt::format("colors: expected one row per face, {}, found {}", facets, array.shape(0)));
  const Rows<std::uint8_t> rows(array);
  std::vector<Color> colors(facets);
  for (std::size_t f = 0; f < facets; ++f) {
    const std::uint8_t* c = rows.data() + 4 * f;
    colors[f] = color_of(c[0], c[1], c[2], c[3]);
  }
  return colors;
}

std::vector<FacetGroup> groups_of(const py::handle& given, std::size_t facets) {
  std::vector<FacetGroup> groups;
  std::size_t next = 0;
  for (const py::handle& item : given) {
    const py::tuple group = py::reinterpret_borrow<py::object>(item);
    const auto first = group[1].cast<std::int64_t>(), count = group[2].cast<std::int64_t>();
    if (std::cmp_not_equal(first, next) || count < 0 || std::cmp_greater(count, facets - next))
      refuse(fmt::format("groups: '{}' begins at face {} and has {}; expected a run that begins at {}, of {} faces", group[0].cast<std::string>(), first, count, next, facets),
             "groups are runs of faces, in order, that together hold all");
    groups.push_back({group[0].cast<std::string>(), static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(count)});
    next += static_cast<std::size_t>(count);
  }
  if (!groups.empty() && next != facets) refuse(fmt::format("groups: they hold {} of {} faces", next, facets), "groups together hold all faces");
  return groups;
}

// An array of `columns` T a row on the vector's own memory.
template <class T, class Row>
py::array lay_on(std::vector<Row>&& rows, py::ssize_t columns) {
  auto* held = new std::vector<Row>(std::move(rows));
  const py::capsule owner(held, [](void* p) { delete static_cast<std::vector<Row>*>(p); });
  std::vector<py::ssize_t> shape{static_cast<py::ssize_t>(held->size())};
  if (columns > 1) shape.push_back(columns);
  return py::array_t<T>(shape, reinterpret_cast<const T*>(held->data()), owner);
}

}  // namespace

std::vector<Vec3> points_of(const py::handle& given, const std::string& what) {
  const py::array array = table_of(given, what, 3);
  if (std::cmp_greater(array.shape(0), std::numeric_limits<std::uint32_t>::max() - 1)) refuse(what + ": more rows than 32 bits can count");
  if (py::isinstance<py::array_t<double>>(array)) return read_points<double>(array, what);
  if (py::isinstance<py::array_t<float>>(array)) return read_points<float>(array, what);
  refuse_type(array, what, "float32 or float64", "astype(float) converts");
}

TriangleSoup soup_of(const py::tuple& surface) {
  TriangleSoup soup;
  soup.points = points_of(surface[0], "vertices");
  soup.facets = facets_of(surface[1], soup.points.size());
  soup.groups = groups_of(surface[2], soup.facets.size());
  soup.colors = colors_of(surface[3], soup.facets.size());
  return soup;
}

py::str text_of(const std::string& bytes, const char* how) {
  return py::reinterpret_steal<py::str>(PyUnicode_DecodeUTF8(bytes.data(), static_cast<py::ssize_t>(bytes.size()), how));
}

std::optional<ModelUnit> unit_of(const py::tuple& surface) {
  if (surface[4].is_none()) return std::nullopt;
  const std::string given = py::str(surface[4]);
  const std::optional<ModelUnit> unit = model_unit(given);
  if (!unit) refuse(fmt::format("unit '{}': expected 'mm', 'cm', 'm', 'in', 'um' or 'ft', or None", given));
  return unit;
}

py::dict arrays_of(TriangleSoup&& soup) {
  py::dict result;
  py::list groups;
  for (const FacetGroup& g : soup.groups) groups.append(py::make_tuple(text_of(g.name), g.first_facet, g.facet_count));
  result["vertices"] = lay_on<double>(std::move(soup.points), 3);
  result["faces"] = lay_on<std::uint32_t>(std::move(soup.facets), 3);
  result["groups"] = groups;
  result["colors"] = soup.colors.empty() ? py::object(py::none()) : lay_on<std::uint8_t>(std::move(soup.colors), 4);
  return result;
}

py::array array_of(std::vector<double>&& values) { return lay_on<double>(std::move(values), 1); }

}  // namespace burnish
