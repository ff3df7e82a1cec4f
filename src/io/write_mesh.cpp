// The writers of all formats, over one buffered descriptor.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/error.h"
#include "burnish/io/mesh_io.h"
#include "fd_writer.h"
#include "text_scanner.h"

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
    std::array<char, 80> header{};
    const std::string text = stl_header();
    std::copy_n(text.data(), std::min<std::size_t>(text.size(), 79), header.data());
    out_.put({header.data(), header.size()});
    out_.put_raw(static_cast<std::uint32_t>(soup_.facets.size()));
    for (std::size_t f = 0; f < soup_.facets.size(); ++f) {
      const auto corners = rounded_corners(f);
      out_.put_raw(normal(corners));
      out_.put_raw(corners);
      out_.put_raw(std::uint16_t{0});
    }
  }

  // Readers take a header that begins with "solid" for an ASCII file.
  std::string stl_header() const {
    TextScanner words(options_.header);
    const std::string_view first = words.peek();
    return fold_keyword(first.substr(0, 5)) == fold_keyword("solid") ? "STL " + options_.header
                                                                     : options_.header;
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
    if (soup_.groups.empty()) return put_facets("f", 1, 0, soup_.facets.size());
    for (const FacetGroup& g : soup_.groups) {
      put_named("g", g.name);
      put_facets("f", 1, g.first_facet, g.first_facet + g.facet_count);
    }
  }

  void put_facets(std::string_view before, std::size_t base, std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      out_.put(before);
      for (const std::uint32_t v : soup_.facets[f]) {
        out_.put(" ");
        out_.put(v + base);
      }
      out_.put("\n");
    }
  }

  void write_off() {
    out_.put(fmt::format("OFF\n{} {} 0\n", soup_.points.size(), soup_.facets.size()));
    put_points();
    put_facets("3", 0, 0, soup_.facets.size());
  }

  void write_ply(bool binary) {
    const std::string_view type = options_.double_precision ? "double" : "float";
    out_.put(fmt::format("ply\nformat {} 1.0\ncomment burnish\nelement vertex {}\n",
                         binary ? "binary_little_endian" : "ascii", soup_.points.size()));
    for (const char axis : {'x', 'y', 'z'}) out_.put(fmt::format("property {} {}\n", type, axis));
    out_.put(fmt::format("element face {}\nproperty list uchar {} vertex_indices\nend_header\n",
                         soup_.facets.size(), soup_.points.size() >> 31 ? "uint" : "int"));
    if (binary) return write_ply_binary();
    put_points();
    put_facets("3", 0, 0, soup_.facets.size());
  }

  void write_ply_binary() {
    for (const Vec3& p : soup_.points) {
      if (options_.double_precision)
        out_.put_raw(p);
      else
        out_.put_raw(rounded(p));
    }
    for (const Facet& facet : soup_.facets) {
      out_.put_raw(std::uint8_t{3});
      out_.put_raw(facet);
    }
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
