// VtpStream: the frame of VTK's XML PolyData, shared by all that writes .vtp files.
//
// Arrays are first announced, each with its place among the raw bytes at the end of the file, and then put in the same
// order, each behind its size in bytes.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/vec.h"
#include "fd_writer.h"

namespace burnish {

class VtpStream {
 public:
  explicit VtpStream(FdWriter& out) : out_(out) {}

  void open() {
    out_.put(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n  <PolyData>\n");
  }
  // Text arrays are the codes of their characters, each text ended by a zero.
  void put_field_texts(std::string_view name, const std::vector<std::string>& texts) {
    out_.put(
        fmt::format("    <FieldData>\n      <DataArray type=\"String\" Name=\"{}\" "
                    "NumberOfTuples=\"{}\" format=\"ascii\">\n",
                    name, texts.size()));
    for (const std::string& text : texts) {
      out_.put("       ");
      for (const char c : text) out_.put(fmt::format(" {}", static_cast<unsigned char>(c)));
      out_.put(" 0\n");
    }
    out_.put("      </DataArray>\n    </FieldData>\n");
  }
  void open_piece(std::size_t points, std::size_t verts, std::size_t lines, std::size_t polys) {
    out_.put(
        fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
                    "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
                    points, verts, lines, polys));
  }
  void open_element(std::string_view element) { out_.put(fmt::format("      <{}>\n", element)); }
  void close_element(std::string_view element) { out_.put(fmt::format("      </{}>\n", element)); }
  void announce(std::string_view type, std::string_view name, int components, std::size_t bytes) {
    out_.put(
        fmt::format("        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
                    "format=\"appended\" offset=\"{}\"/>\n",
                    type, name, components, offset_));
    offset_ += sizeof(std::uint64_t) + bytes;
  }
  void announce_points(std::size_t count) {
    open_element("Points");
    announce("Float64", "Points", 3, sizeof(Vec3) * count);
    close_element("Points");
  }
  // `element`: Verts, Lines or Polys.
  void announce_cells(std::string_view element, std::size_t corners, std::size_t count) {
    open_element(element);
    announce("Int64", "connectivity", 1, 8 * corners * count);
    announce("Int64", "offsets", 1, 8 * count);
    close_element(element);
  }
  void begin_data() { out_.put("    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _"); }

  void put_size(std::size_t bytes) { out_.put_raw(static_cast<std::uint64_t>(bytes)); }
  void put_points(const std::vector<Vec3>& points) {
    put_size(sizeof(Vec3) * points.size());
    for (const Vec3& p : points) out_.put_raw(p);
  }
  // `point(c, i)`: corner i of cell c.
  template <class Point>
  void put_cells(std::size_t corners, std::size_t count, Point&& point) {
    put_size(8 * corners * count);
    for (std::size_t c = 0; c < count; ++c)
      for (std::size_t i = 0; i < corners; ++i) out_.put_raw(static_cast<std::int64_t>(point(c, i)));
    put_size(8 * count);
    for (std::size_t c = 1; c <= count; ++c) out_.put_raw(static_cast<std::int64_t>(corners * c));
  }
  void close() { out_.put("\n  </AppendedData>\n</VTKFile>\n"); }

 private:
  FdWriter& out_;
  std::size_t offset_ = 0;
};

}  // namespace burnish
