#include "burnish/io/region_file.h"

#include <fmt/format.h>

#include <array>

#include "mapped_file.h"
#include "source.h"
#include "text_scanner.h"

namespace burnish {
namespace {

constexpr std::string_view kHint = "a region's lines read: box X0 Y0 Z0 X1 Y1 Z1, or: sphere X Y Z R";

// The numbers behind a shape's name, to the end of its line.
template <std::size_t N>
std::array<double, N> numbers(const Source& source, TextScanner& line, std::string_view shape) {
  std::array<double, N> values;
  for (double& value : values)
    if (!line.number(value)) source.fail_at(line.position(), fmt::format("expected {} numbers behind '{}', found {}", N, shape, quoted(line.peek())), kHint);
  if (!line.at_end()) source.fail_at(line.position(), "expected the end of the line, found " + quoted(line.rest_of_line()), kHint);
  return values;
}

void read_shape(const Source& source, TextScanner line, RegionShapes& shapes) {
  if (line.at_end()) return;
  const char* const at = line.position();
  const std::string_view shape = line.word();
  if (shape == "box") {
    const auto v = numbers<6>(source, line, shape);
    Box3 box;
    box.extend(Vec3{v[0], v[1], v[2]});
    box.extend(Vec3{v[3], v[4], v[5]});
    shapes.boxes.push_back(box);
  } else if (shape == "sphere") {
    const auto v = numbers<4>(source, line, shape);
    if (!(v[3] > 0)) source.fail_at(at, fmt::format("expected a radius greater than zero, found {:g}", v[3]), kHint);
    shapes.balls.push_back({{v[0], v[1], v[2]}, v[3]});
  } else {
    source.fail_at(at, "expected 'box' or 'sphere', found " + quoted(shape), kHint);
  }
}

}  // namespace

RegionShapes read_region_shapes(const std::string& path) {
  const MappedFile file(path);
  const Source source{file.bytes(), input_label(path)};
  RegionShapes shapes;
  for (std::string_view rest = source.bytes; !rest.empty();) {
    const std::size_t end = rest.find('\n');
    const std::string_view line = rest.substr(0, end);
    read_shape(source, TextScanner(line.substr(0, line.find('#'))), shapes);
    rest.remove_prefix(end == rest.npos ? rest.size() : end + 1);
  }
  if (shapes.boxes.empty() && shapes.balls.empty()) source.fail("expected boxes or spheres, found none", kHint);
  return shapes;
}

}  // namespace burnish
