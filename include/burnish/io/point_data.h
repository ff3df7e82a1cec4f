// PointData: a surface with numbers at its points, or at its facets, and the files a viewer opens to show them.
//
//   .vtp  VTK's XML PolyData, float64: one point data array for each of the arrays. ParaView colours by any of them.
//   .ply  binary little endian PLY, float64: one vertex property for each number of the arrays, and a colour by the first of them. MeshLab
//         shows the colours, and takes the property "quality" as that. Comments tell the range of the colours. No number is written as 0.
//
// Colours run from blue (most negative) by grey (zero) to red (most positive), over the same range on both sides of zero.
#pragma once

#include <string>
#include <vector>

#include "burnish/io/marked_cells.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct PointArray {
  std::string name;            // without white space, e.g. "deviation"
  std::vector<double> values;  // `components` a point; not a number where there is none
  int components = 1;          // or 3: a vector, in a .ply as name_x, name_y, name_z ("normal": nx, ny, nz)
};

struct PointData {
  const TriangleSoup& surface;     // its points, also unused ones, and facets; names and colours are left out
  std::vector<PointArray> arrays{};  // at least one, but of a .vtp with facet arrays; the first, of one component, gives the colours
  std::vector<std::string> comments{};  // of a .ply, a line each
  double color_range = 0;               // of a .ply: where colours end; 0: at the largest value
  std::vector<PointArray> facet_arrays{};  // numbers at facets, as cell data; of a .vtp only
};

// The colour of `value` on a scale from -range to range; values beyond have the ends' colours. Grey for a range of 0.
Color diverging_color(double value, double range);

// Writes to the open file descriptor `fd` and leaves it open; it need not be able to seek.
// Throws Error{unwritable_output}, naming `label`, when the system refuses bytes.
// Cost: 24 bytes a point and 8 for each of its numbers; 32 bytes of a .vtp a facet, 13 of a .ply.
void write_point_data(int fd, const std::string& label, const PointData& data, MarkedFormat format);

}  // namespace burnish
