#include "burnish/io/marked_cells.h"

#include <fmt/format.h>

#include <cassert>

#include "burnish/core/error.h"
#include "fd_writer.h"
#include "suffix.h"

namespace burnish {
namespace {

// VTK's XML: the arrays are announced with their offsets, then follow one after another.
class VtpWriter {
 public:
  VtpWriter(FdWriter& out, const MarkedCells& cells) : out_(out), cells_(cells) {}

  void write() {
    put_head();
    put_arrays();
    out_.put("\n  </AppendedData>\n</VTKFile>\n");
  }

 private:
  void put_head() {
    out_.put(
        "<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\" version=\"1.0\" byte_order=\"LittleEndian\" "
        "header_type=\"UInt64\">\n  <PolyData>\n");
    put_kind_names();
    out_.put(
        fmt::format("    <Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"{}\" "
                    "NumberOfStrips=\"0\" NumberOfPolys=\"{}\">\n",
                    cells_.points.size(), cells_.verts.size(), cells_.lines.size(), cells_.polys.size()));
    out_.put("      <CellData>\n");
    announce("Int32", "kind", 1, 4 * cells_.marks.size());
    announce("Int64", cells_.mark_name, 1, 8 * cells_.marks.size());
    announce("UInt8", "rgb", 3, 3 * cells_.marks.size());
    out_.put("      </CellData>\n      <Points>\n");
    announce("Float64", "Points", 3, 24 * cells_.points.size());
    out_.put("      </Points>\n");
    announce_cells("Verts", 1, cells_.verts.size());
    announce_cells("Lines", 2, cells_.lines.size());
    announce_cells("Polys", 3, cells_.polys.size());
    out_.put("    </Piece>\n  </PolyData>\n  <AppendedData encoding=\"raw\">\n   _");
  }

  // VTK writes text arrays as the codes of their characters, each text ended by a zero.
  void put_kind_names() {
    out_.put(
        fmt::format("    <FieldData>\n      <DataArray type=\"String\" Name=\"kind_names\" "
                    "NumberOfTuples=\"{}\" format=\"ascii\">\n",
                    cells_.kinds.size()));
    for (const MarkedKind& kind : cells_.kinds) {
      out_.put("       ");
      for (const char c : kind.name) out_.put(fmt::format(" {}", static_cast<unsigned char>(c)));
      out_.put(" 0\n");
    }
    out_.put("      </DataArray>\n    </FieldData>\n");
  }

  void announce(std::string_view type, std::string_view name, int components, std::size_t bytes) {
    out_.put(
        fmt::format("        <DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" "
                    "format=\"appended\" offset=\"{}\"/>\n",
                    type, name, components, offset_));
    offset_ += sizeof(std::uint64_t) + bytes;
  }

  void announce_cells(std::string_view element, std::size_t corners, std::size_t count) {
    out_.put(fmt::format("      <{}>\n", element));
    announce("Int64", "connectivity", 1, 8 * corners * count);
    announce("Int64", "offsets", 1, 8 * count);
    out_.put(fmt::format("      </{}>\n", element));
  }

  void put_arrays() {
    const std::size_t cells = cells_.marks.size();
    put_size(4 * cells);
    for (const CellMark& m : cells_.marks) out_.put_raw(static_cast<std::int32_t>(m.kind));
    put_size(8 * cells);
    for (const CellMark& m : cells_.marks) out_.put_raw(static_cast<std::int64_t>(m.mark));
    put_size(3 * cells);
    for (const CellMark& m : cells_.marks) out_.put_raw(cells_.kinds[m.kind].color);
    put_size(24 * cells_.points.size());
    for (const Vec3& p : cells_.points) out_.put_raw(p);
    put_cells(1, cells_.verts.size(), [&](std::size_t c, std::size_t) { return cells_.verts[c]; });
    put_cells(2, cells_.lines.size(), [&](std::size_t c, std::size_t i) { return cells_.lines[c][i]; });
    put_cells(3, cells_.polys.size(), [&](std::size_t c, std::size_t i) { return cells_.polys[c][i]; });
  }

  void put_cells(std::size_t corners, std::size_t count, auto&& point) {
    put_size(8 * corners * count);
    for (std::size_t c = 0; c < count; ++c)
      for (std::size_t i = 0; i < corners; ++i) out_.put_raw(static_cast<std::int64_t>(point(c, i)));
    put_size(8 * count);
    for (std::size_t c = 1; c <= count; ++c) out_.put_raw(static_cast<std::int64_t>(corners * c));
  }

  void put_size(std::size_t bytes) { out_.put_raw(static_cast<std::uint64_t>(bytes)); }

  FdWriter& out_;
  const MarkedCells& cells_;
  std::size_t offset_ = 0;
};

class MarkedPlyWriter {
 public:
  MarkedPlyWriter(FdWriter& out, const MarkedCells& cells) : out_(out), cells_(cells) {}

  void write() {
    put_head();
    const std::vector<std::uint32_t> kinds = kinds_of_points();
    for (std::size_t p = 0; p < cells_.points.size(); ++p) {
      out_.put_raw(cells_.points[p]);
      out_.put_raw(cells_.kinds[kinds[p]].color);
    }
    const std::size_t first_line = cells_.verts.size(), first_poly = first_line + cells_.lines.size();
    for (std::size_t c = 0; c < cells_.polys.size(); ++c) {
      out_.put_raw(std::uint8_t{3});
      out_.put_raw(cells_.polys[c]);
      put_mark(cells_.marks[first_poly + c]);
    }
    for (std::size_t c = 0; c < cells_.lines.size(); ++c) {
      out_.put_raw(cells_.lines[c]);
      put_mark(cells_.marks[first_line + c]);
    }
  }

 private:
  void put_head() {
    constexpr std::string_view kColor = "property uchar red\nproperty uchar green\nproperty uchar blue\n";
    const std::string mark = fmt::format("property int kind\nproperty int {}\n", cells_.mark_name);
    out_.put("ply\nformat binary_little_endian 1.0\ncomment burnish\n");
    for (std::size_t k = 0; k < cells_.kinds.size(); ++k)
      out_.put(fmt::format("comment kind {} {}\n", k, cells_.kinds[k].name));
    out_.put(fmt::format("element vertex {}\nproperty double x\nproperty double y\nproperty double z\n{}",
                         cells_.points.size(), kColor));
    out_.put(fmt::format("element face {}\nproperty list uchar int vertex_indices\n{}{}", cells_.polys.size(),
                         kColor, mark));
    out_.put(fmt::format("element edge {}\nproperty int vertex1\nproperty int vertex2\n{}{}end_header\n",
                         cells_.lines.size(), kColor, mark));
  }

  std::vector<std::uint32_t> kinds_of_points() const {
    std::vector<std::uint32_t> kinds(cells_.points.size(), 0);
    auto mark = cells_.marks.begin();
    for (const std::uint32_t p : cells_.verts) kinds[p] = (mark++)->kind;
    for (const auto& line : cells_.lines) {
      for (const std::uint32_t p : line) kinds[p] = mark->kind;
      ++mark;
    }
    for (const auto& poly : cells_.polys) {
      for (const std::uint32_t p : poly) kinds[p] = mark->kind;
      ++mark;
    }
    return kinds;
  }

  void put_mark(const CellMark& m) {
    out_.put_raw(cells_.kinds[m.kind].color);
    out_.put_raw(m.kind);
    out_.put_raw(m.mark);
  }

  FdWriter& out_;
  const MarkedCells& cells_;
};

}  // namespace

MarkedFormat marked_format_for_writing(const std::string& path) {
  const std::string suffix = suffix_of(path);
  if (suffix == ".vtp") return MarkedFormat::vtp;
  if (suffix == ".ply") return MarkedFormat::ply;
  throw Error(ErrorCode::usage, fmt::format("{}: the suffix does not say which format to write", path),
              "use .vtp (ParaView) or .ply (MeshLab)");
}

void write_marked_cells(int fd, const std::string& label, const MarkedCells& cells, MarkedFormat format) {
  assert(cells.marks.size() == cells.verts.size() + cells.lines.size() + cells.polys.size());
  FdWriter out(fd, label);
  if (format == MarkedFormat::vtp)
    VtpWriter(out, cells).write();
  else
    MarkedPlyWriter(out, cells).write();
  out.flush();
}

}  // namespace burnish
