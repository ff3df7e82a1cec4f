// Reading and writing triangle files: STL (binary and ASCII), OBJ, PLY, OFF and 3MF.
//
// Reading is one pass over a memory map. Coordinates stay exact: binary float32 is widened, text is
// read with from_chars to the nearest double. Stored normals are never looked at: orientation is the
// order of a facet's vertices. Polygons of OBJ, PLY and OFF are cut into fans.
//
// Names and colours are kept where the format has them (docs/formats.md):
//
//                 groups                                  colours of facets
//   binary STL    -                                       attributes: Magics, VisCAM; 5 bits a channel
//   ASCII STL     solids                                  -
//   OBJ           g, o (written: g)                       -
//   PLY           property group, its names in comments   properties red, green, blue, alpha of face
//   OFF           -                                       behind the indices
//   3MF           objects (instances of meshes)           base materials, colour groups
//
// Attributes of a binary STL that look like no convention give no colours: many programs leave junk there.
//
// What is broken is an error; what is merely odd is read, with a warning:
//
//   in the file                                     by default            with salvage
//   ----------------------------------------------  --------------------  ---------------------------
//   binary STL: count larger than the file          error                 the facets that are there
//   binary STL: count too small, the rest is whole  all facets, warning   the same
//     facets in the range of the promised ones
//   binary STL: other bytes behind the facets       ignored, warning      the same
//   ASCII STL: words that mean nothing, normals     ignored, warning      the same
//     that are no numbers, line ends of any kind
//   ASCII STL: file ends without `endsolid`         warning               the same
//   ASCII STL: facet of more than three vertices    fan, warning          the same
//   facet of fewer; file that ends within a facet   error (STL)           the facet is left out
//   polygon of one or two corners (not STL)         left out, warning     the same
//   coordinate that is nan, infinite or no number   error                 its facets are left out
//   decimal commas                                  error                 read (STL), or left out
//   index of a point that does not exist            error                 the facet is left out
//   fewer rows than the header promises (PLY, OFF)  error                 the rows that are there
//
// Counts of a header are never believed before the bytes are seen, so none makes the reader allocate.
#pragma once

#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/model_unit.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

enum class MeshFormat { stl_binary, stl_ascii, obj, ply_binary, ply_ascii, off, threemf };

// The name of a format in messages and reports, e.g. "binary STL".
std::string_view name(MeshFormat format);

struct MeshReadOptions {
  // Take what a broken file holds and say so in `warnings`, instead of refusing it.
  bool salvage = false;
};

struct MeshFile {
  TriangleSoup soup;   // STL: three points of its own per facet; others: points as in the file
  MeshFormat format = MeshFormat::stl_binary;
  // Binary STL: the text of its 80 bytes, up to the first NUL or COLOR=, without blanks at its end. Otherwise empty.
  std::string header;
  // What coordinates are in, if the file says so: 3MF only.
  std::optional<ModelUnit> unit;
  // What was tolerated or dropped, one sentence each, without the file's name.
  std::vector<std::string> warnings;
};

// Reads the file at `path`, or standard input to its end if `path` is "-". The format is found from the
// content first and the name second. Solids and groups without facets are left out; of a PLY whose groups are
// no runs of faces, all are, with a warning.
// Throws Error{unreadable_input} that names file, place (byte, or line counted over LF, CR and CRLF),
// expected and found. A file without a single facet is an error too: there is nothing to work on.
// Throws Error{interrupted} if a signal wakes it while it waits for standard input.
// Memory: 84 bytes per facet of an STL (88 with colours), plus the mapping, which belongs to the system's file cache.
// Cost: about 0.03 to 0.06 us per facet of a binary STL, 2 ns per byte of an ASCII one.
// 3MF: every item of the build, its components and transforms applied, points computed in double precision; one group for each
// instance of a mesh. Left out with a warning: what is no object of type `model`, textures, colours that change within a facet.
// Archives that inflate to more than 200 times their size (or 64 MiB, if that is more), or to more than 8 GiB, are refused, and so are instances of more than 2^26 facets.
MeshFile read_mesh(const std::string& path, const MeshReadOptions& options = {});

// The same for bytes already in memory (standard input, tests, fuzzing). `label` stands for the path in
// messages; its suffix is the format's second opinion.
MeshFile read_mesh(std::span<const std::byte> bytes, const std::string& label,
                   const MeshReadOptions& options = {});

// The format a path's suffix asks for when writing (.stl: binary STL, .stla: ASCII STL, .ply: binary PLY,
// .obj, .off, .3mf).
// Throws Error{usage} for an unknown suffix, naming the known ones, and for .3mf in a build without lib3mf.
MeshFormat format_for_writing(const std::string& path);

struct MeshWriteOptions {
  MeshFormat format = MeshFormat::stl_binary;
  bool double_precision = true;  // PLY only: double coordinates; STL is float32 by definition
  // Binary STL: first 79 bytes of the header, after "STL " if it would begin with "solid", which readers
  // take for text, and before the COLOR= of a soup with colours. ASCII STL: the solid's name, unless the soup
  // has groups: each becomes a solid.
  std::string header = "burnish";
  ModelUnit unit = ModelUnit::millimetre;  // 3MF only
};

// Writes to the open file descriptor `fd` and leaves it open; it need not be able to seek. Text has as
// many digits as it takes to read the same double back, for coordinates rounded to float32 too: readers
// of either precision see one and the same point. STL normals are computed from the rounded vertices;
// a facet without area gets a zero normal. Groups and colours are written where the format holds them; of names,
// ends of lines become blanks. Of a 3MF, facets of which two corners round to the same point are left out: the format has none.
// Throws Error{unwritable_output}, naming `label`, when the system refuses bytes (disk full; closed pipe,
// if the program ignores SIGPIPE) and when a coordinate is beyond the range of the format's float32.
void write_mesh(int fd, const std::string& label, const TriangleSoup& soup,
                const MeshWriteOptions& options);

// True if writing in this format rounds coordinates to float32.
bool stores_float32(MeshFormat format);

}  // namespace burnish
