// The writers of all formats, over one buffered descriptor.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

#include "burnish/core/error.h"
#include "burnish/io/mesh_io.h"
#include "fd_writer.h"
#include "stl_colors.h"
#include "text_scanner.h"
#include "threemf.h"

namespace burnish {
namespace {

struct FloatPoint {
  float x, y, z;
};

Vec3 wide(const FloatPoint& p) { return {p.x, p.y, p.z}; }

class MeshWriter {
 public:
  MeshWriter(int fd, const std::string& label, const TriangleSoup& soup, const MeshWriteOptions& options)
      : out_(fd, label), label_(label), soup_(soup), options_(options) {}

  void write() {
    switch (options_.format) {
      case MeshFormat::stl_binary:
        write_stl_binary();
        break;
      case MeshFormat::stl_ascii:
        write_stl_ascii();
        break;
      case MeshFormat::obj:
        write_obj();
        break;
      case MeshFormat::ply_binary:
        write_ply(true);
        break;
      case MeshFormat::ply_ascii:
        write_ply(false);
        break;
      case MeshFormat::off:
        write_off();
        break;
      case MeshFormat::threemf:
        write_3mf(out_, label_, soup_, options_);
        break;
    }
    out_.flush();
  }

 private:
  FloatPoint rounded(const Vec3& p) const {
    const FloatPoint r{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
    if (std::isfinite(r.x) && std::isfinite(r.y) && std::isfinite(r.z)) return r;
    throw Error(
        ErrorCode::unwritable_output,
        fmt::format("{}: the point ({}, {}, {}) is beyond the range of float32", label_, p.x, p.y, p.z),
        "write OBJ, PLY or OFF, which hold doubles, or scale the model");
  }

  std::array<FloatPoint, 3> rounded_corners(std::size_t f) const {
    return {rounded(soup_.corner(f, 0)), rounded(soup_.corner(f, 1)), rounded(soup_.corner(f, 2))};
  }

  // Unit normal of the rounded facet; zero for a facet that has none.
  static FloatPoint normal(const std::array<FloatPoint, 3>& c) {
    const Vec3 n = cross(wide(c[1]) - wide(c[0]), wide(c[2]) - wide(c[0]));
    const double length = norm(n);
    if (!(length > 0)) return {0, 0, 0};
    // Adding zero turns -0 into 0.
    return {static_cast<float>(n.x / length) + 0.0f, static_cast<float>(n.y / length) + 0.0f,
            static_cast<float>(n.z / length) + 0.0f};
  }

  void write_stl_binary() {
    const ColorAttributes attribute(soup_.colors);
    std::string header = stl_header(attribute.header_suffix());
    header.resize(80, '\0');
    out_.put(header);
    out_.put_raw(static_cast<std::uint32_t>(soup_.facets.size()));
    for (std::size_t f = 0; f < soup_.facets.size(); ++f) {
      const auto corners = rounded_corners(f);
      out_.put_raw(normal(corners));
      out_.put_raw(corners);
      out_.put_raw(soup_.colors.empty() ? std::uint16_t{0} : attribute(soup_.colors[f]));
    }
  }

  // Readers take a header that begins with "solid" for an ASCII file.
  std::string stl_header(const std::string& suffix) const {
    std::string text = stl_header_text(options_.header);
    TextScanner words(text);
    const std::string_view first = words.peek();
    if (fold_keyword(first.substr(0, 5)) == fold_keyword("solid")) text = "STL " + text;
    if (!text.empty() && !suffix.empty()) text += ' ';
    text.resize(std::min(text.size(), 79 - suffix.size()));
    return text + suffix;
  }

  void write_stl_ascii() {
    if (soup_.groups.empty()) return write_solid(options_.header, 0, soup_.facets.size());
    for (const FacetGroup& g : soup_.groups)
      write_solid(g.name, g.first_facet, g.first_facet + g.facet_count);
  }

  void write_solid(const std::string& name, std::size_t begin, std::size_t end) {
    put_named("solid", name);
    for (std::size_t f = begin; f < end; ++f) write_ascii_facet(rounded_corners(f));
    put_named("endsolid", name);
  }

  void write_ascii_facet(const std::array<FloatPoint, 3>& corners) {
    out_.put("facet normal");
    put_coordinates(normal(corners));
    out_.put("\nouter loop\n");
    for (const FloatPoint& p : corners) {
      out_.put("vertex");
      // With the digits of a double: readers in single and in double precision then see the same point.
      put_coordinates(wide(p));
      out_.put("\n");
    }
    out_.put("endloop\nendfacet\n");
  }

  // A keyword and a name on one line, whatever the name.
  void put_named(std::string_view keyword, std::string name) {
    std::replace_if(name.begin(), name.end(), is_line_end, ' ');
    out_.put(keyword);
    if (!name.empty()) out_.put(" ");
    out_.put(name);
    out_.put("\n");
  }

  template <class Point>
  void put_coordinates(const Point& p) {
    for (const auto c : {p.x, p.y, p.z}) {
      out_.put(" ");
      out_.put(c);
    }
  }

  void write_obj() {
    out_.put("# burnish\n");
    for (const Vec3& p : soup_.points) {
      out_.put("v");
      put_coordinates(p);
      out_.put("\n");
    }
    if (soup_.groups.empty()) return put_obj_facets(0, soup_.facets.size());
    for (const FacetGroup& g : soup_.groups) {
      put_named("g", without_joint(g.name));
      put_obj_facets(g.first_facet, g.first_facet + g.facet_count);
    }
  }

  // A backslash at the end would join the next line to the name.
  static std::string without_joint(const std::string& name) {
    return name.substr(0, name.find_last_not_of("\\ \t\r\n\v\f") + 1);
  }

  void put_obj_facets(std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      put_facet("f", 1, f);
      out_.put("\n");
    }
  }

  // Without the line's end.
  void put_facet(std::string_view before, std::size_t base, std::size_t f) {
    out_.put(before);
    for (const std::uint32_t v : soup_.facets[f]) {
      out_.put(" ");
      out_.put(v + base);
    }
  }

  void put_color(Color color) {
    for (int i = 0; i < 4; ++i) {
      out_.put(" ");
      out_.put(std::size_t{channel(color, i)});
    }
  }

  void write_off() {
    out_.put(fmt::format("OFF\n{} {} 0\n", soup_.points.size(), soup_.facets.size()));
    put_points();
    for (std::size_t f = 0; f < soup_.facets.size(); ++f) {
      put_facet("3", 0, f);
      if (!soup_.colors.empty() && soup_.colors[f] != kNoColor) put_color(soup_.colors[f]);
      out_.put("\n");
    }
  }

  void write_ply(bool binary) {
    const std::string_view type = options_.double_precision ? "double" : "float";
    out_.put(fmt::format("ply\nformat {} 1.0\ncomment burnish\n", binary ? "binary_little_endian" : "ascii"));
    for (std::size_t g = 0; g < soup_.groups.size(); ++g)
      put_named(fmt::format("comment group {}", g), soup_.groups[g].name);
    out_.put(fmt::format("element vertex {}\n", soup_.points.size()));
    for (const char axis : {'x', 'y', 'z'}) out_.put(fmt::format("property {} {}\n", type, axis));
    out_.put(fmt::format("element face {}\nproperty list uchar {} vertex_indices\n", soup_.facets.size(),
                         soup_.points.size() >> 31 ? "uint" : "int"));
    if (!soup_.colors.empty())
      for (const char* property : {"red", "green", "blue", "alpha"})
        out_.put(fmt::format("property uchar {}\n", property));
    if (!soup_.groups.empty()) out_.put("property int group\n");
    out_.put("end_header\n");
    if (binary) return write_ply_binary();
    put_points();
    for_each_facet_and_group([&](std::size_t f, std::uint32_t group) {
      put_facet("3", 0, f);
      if (!soup_.colors.empty()) put_color(soup_.colors[f]);
      if (!soup_.groups.empty()) out_.put(" "), out_.put(std::size_t{group});
      out_.put("\n");
    });
  }

  template <class Visit>
  void for_each_facet_and_group(Visit&& visit) const {
    std::uint32_t group = 0;
    const std::vector<FacetGroup>& groups = soup_.groups;
    for (std::size_t f = 0; f < soup_.facets.size(); ++f) {
      while (group + 1 < groups.size() && f >= groups[group + 1].first_facet) ++group;
      visit(f, group);
    }
  }

  void write_ply_binary() {
    for (const Vec3& p : soup_.points) {
      if (options_.double_precision)
        out_.put_raw(p);
      else
        out_.put_raw(rounded(p));
    }
    static_assert(std::endian::native == std::endian::little, "colours are written as they are in memory");
    for_each_facet_and_group([&](std::size_t f, std::uint32_t group) {
      out_.put_raw(std::uint8_t{3});
      out_.put_raw(soup_.facets[f]);
      if (!soup_.colors.empty()) out_.put_raw(soup_.colors[f]);
      if (!soup_.groups.empty()) out_.put_raw(group);
    });
  }

  // One point per line, without a blank in front.
  void put_points() {
    for (const Vec3& point : soup_.points) {
      const bool rounds = options_.format == MeshFormat::ply_ascii && !options_.double_precision;
      const Vec3 p = rounds ? wide(rounded(point)) : point;
      out_.put(p.x);
      for (const double c : {p.y, p.z}) {
        out_.put(" ");
        out_.put(c);
      }
      out_.put("\n");
    }
  }

  FdWriter out_;
  const std::string& label_;
  const TriangleSoup& soup_;
  const MeshWriteOptions& options_;
};

}  // namespace

void write_mesh(int fd, const std::string& label, const TriangleSoup& soup, const MeshWriteOptions& options) {
  MeshWriter(fd, label, soup, options).write();
}

}  // namespace burnish
