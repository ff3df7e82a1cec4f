// Reading and writing triangle files: STL (binary and ASCII), OBJ, PLY and OFF.
//
// Reading is one pass over a memory map. Coordinates stay exact: binary float32 is widened, text is
// read with from_chars to the nearest double. Stored normals are never looked at: orientation is the
// order of a facet's vertices. Polygons of OBJ, PLY and OFF are cut into fans.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

enum class MeshFormat { stl_binary, stl_ascii, obj, ply_binary, ply_ascii, off };

// The name of a format in messages and reports, e.g. "binary STL".
std::string_view name(MeshFormat format);

struct MeshReadOptions {
  // Take what a broken file holds and say so in `warnings`, instead of refusing it.
  bool salvage = false;
};

struct MeshFile {
  TriangleSoup soup;   // STL: three points of its own per facet; others: points as in the file
  MeshFormat format = MeshFormat::stl_binary;
  std::string header;  // binary STL: the 80 bytes up to the first NUL; otherwise empty
  // What was tolerated or dropped, one sentence each, without the file's name.
  std::vector<std::string> warnings;
};

// Reads the file at `path`. The format is found from the content first and the name second.
// Throws Error{unreadable_input} that names file, place (byte or line), expected and found.
// A file without a single facet is an error too: there is nothing to work on.
MeshFile read_mesh(const std::string& path, const MeshReadOptions& options = {});

// The same for bytes already in memory (standard input, tests, fuzzing). `label` stands for the path in
// messages; its suffix is the format's second opinion.
MeshFile read_mesh(std::span<const std::byte> bytes, const std::string& label,
                   const MeshReadOptions& options = {});

// The format a path's suffix asks for when writing (.stl: binary STL, .ply: binary PLY, .obj, .off).
// Throws Error{usage} for an unknown suffix, naming the known ones.
MeshFormat format_for_writing(const std::string& path);

struct MeshWriteOptions {
  MeshFormat format = MeshFormat::stl_binary;
  bool double_precision = true;  // PLY only: double coordinates; STL is float32 by definition
  std::string header = "burnish";  // binary STL: first 79 bytes of the header; ASCII STL: solid's name
};

// Writes to the open file descriptor `fd` and leaves it open. Text has as many digits as it takes to
// read the same double back (float for ASCII STL). STL normals are computed from the rounded vertices.
// Throws Error{unwritable_output}, naming `label`, when the system refuses bytes (disk full, closed pipe).
void write_mesh(int fd, const std::string& label, const TriangleSoup& soup,
                const MeshWriteOptions& options);

// True if writing in this format rounds coordinates to float32.
bool stores_float32(MeshFormat format);

}  // namespace burnish
