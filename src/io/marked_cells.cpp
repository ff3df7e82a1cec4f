#include "burnish/io/marked_cells.h"

#include <fmt/format.h>

#include <cassert>

#include "burnish/core/error.h"
#include "fd_writer.h"
#include "suffix.h"
#include "vtp_stream.h"

namespace burnish {
namespace {

void write_vtp(FdWriter& out, const MarkedCells& cells) {
  const std::size_t count = cells.marks.size();
  std::vector<std::string> kind_names;
  for (const MarkedKind& kind : cells.kinds) kind_names.push_back(kind.name);
  VtpStream vtp(out);
  vtp.open();
  vtp.put_field_texts("kind_names", kind_names);
  vtp.open_piece(cells.points.size(), cells.verts.size(), cells.lines.size(), cells.polys.size());
  vtp.open_element("CellData");
  vtp.announce("Int32", "kind", 1, 4 * count);
  vtp.announce("Int64", cells.mark_name, 1, 8 * count);
  vtp.announce("UInt8", "rgb", 3, 3 * count);
  vtp.close_element("CellData");
  vtp.announce_points(cells.points.size());
  vtp.announce_cells("Verts", 1, cells.verts.size());
  vtp.announce_cells("Lines", 2, cells.lines.size());
  vtp.announce_cells("Polys", 3, cells.polys.size());
  vtp.begin_data();
  vtp.put_size(4 * count);
  for (const CellMark& m : cells.marks) out.put_raw(static_cast<std::int32_t>(m.kind));
  vtp.put_size(8 * count);
  for (const CellMark& m : cells.marks) out.put_raw(static_cast<std::int64_t>(m.mark));
  vtp.put_size(3 * count);
  for (const CellMark& m : cells.marks) out.put_raw(cells.kinds[m.kind].color);
  vtp.put_points(cells.points);
  vtp.put_cells(1, cells.verts.size(), [&](std::size_t c, std::size_t) { return cells.verts[c]; });
  vtp.put_cells(2, cells.lines.size(), [&](std::size_t c, std::size_t i) { return cells.lines[c][i]; });
  vtp.put_cells(3, cells.polys.size(), [&](std::size_t c, std::size_t i) { return cells.polys[c][i]; });
  vtp.close();
}

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
    write_vtp(out, cells);
  else
    MarkedPlyWriter(out, cells).write();
  out.flush();
}

}  // namespace burnish
