// The judge's own view of an STL file: points that are equal are one, facets are triples of them.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace judge {

using Point = std::array<double, 3>;
using Facet = std::array<std::uint32_t, 3>;

// A file as it was read. Coordinates are single precision, as STL has them, also those of ASCII files:
// the nearest float of the text. Points with equal coordinates are one (-0 and +0 are equal).
struct Mesh {
  std::vector<Point> points;  // each used by a facet
  std::vector<Facet> facets;  // in the order of the file; may repeat a point or another facet
  std::size_t left_out = 0;   // facets without three finite corners
  std::string error;          // why the file cannot be read at all; then there are no facets
};

// Reads binary or ASCII STL by a reader that shares nothing with the program's. It takes what it can:
// any line ends and letter case, several solids, missing keywords, facets of more than three corners (as
// fans), decimal commas, trailing bytes, and counts that lie (then the file's size decides). What is no STL
// comes back without facets, and what cannot be opened with an `error`.
Mesh read_stl(const std::string& path);

}  // namespace judge
