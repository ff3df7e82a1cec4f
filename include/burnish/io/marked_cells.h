// MarkedCells: points, lines and triangles to be looked at, and the files a viewer opens to show them.
//
// Not a mesh: what stands in it is a selection, such as the defects of a model, to be laid over the
// model itself. Two formats:
//
//   .vtp  VTK's XML PolyData, appended raw binary, float64. ParaView, and VTK's vtkXMLPolyDataReader.
//         Cell data: `kind`, the mark, and `rgb`; the kinds' names are the field data `kind_names`.
//   .ply  binary little endian PLY, float64. MeshLab, Blender, vtkPLYReader. Verts are vertices that no
//         face or edge uses; faces, edges and vertices have colours; faces and edges `kind` and the mark.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "burnish/core/vec.h"

namespace burnish {

struct MarkedKind {
  std::string name;                     // without white space, e.g. "open_loop"
  std::array<std::uint8_t, 3> color{};  // red, green, blue
};

struct CellMark {
  std::uint32_t kind = 0;  // index into `kinds`
  std::uint32_t mark = 0;  // whatever the maker means by it, e.g. an index into a report's list
};

struct MarkedCells {
  std::string mark_name = "mark";  // what CellMark::mark is called in the file
  std::vector<MarkedKind> kinds;
  std::vector<Vec3> points;
  std::vector<std::uint32_t> verts;                 // a point each
  std::vector<std::array<std::uint32_t, 2>> lines;  // two points each
  std::vector<std::array<std::uint32_t, 3>> polys;  // triangles
  std::vector<CellMark> marks;  // one a cell: of the verts, then the lines, then the polys
};

enum class MarkedFormat { vtp, ply };

// The format that a path's suffix asks for. Throws Error{usage} for any other one, naming the known ones.
MarkedFormat marked_format_for_writing(const std::string& path);

// Writes to the open file descriptor `fd` and leaves it open; it need not be able to seek. No cells at all
// give a valid file as well. A PLY's vertex has the colour of the last cell that uses it.
// Throws Error{unwritable_output}, naming `label`, when the system refuses bytes.
// Cost: about 50 bytes of a .vtp a cell, 20 of a .ply, and 24 a point.
void write_marked_cells(int fd, const std::string& label, const MarkedCells& cells, MarkedFormat format);

}  // namespace burnish
