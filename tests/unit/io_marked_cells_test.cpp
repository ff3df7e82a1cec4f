#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <cstring>

#include "burnish/core/error.h"
#include "burnish/io/marked_cells.h"
#include "support/folder.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using namespace test;

MarkedCells one_of_each() {
  MarkedCells cells;
  cells.mark_name = "defect";
  cells.kinds = {{"first", {1, 2, 3}}, {"second", {4, 5, 6}}};
  cells.points = {{0, 0, 0}, {1, 0, 0}, {0, 0.1, 0}, {7, 8, 9}};
  cells.verts = {3};
  cells.lines = {{0, 1}};
  cells.polys = {{0, 1, 2}};
  cells.marks = {{0, 11}, {1, 12}, {0, 13}};
  return cells;
}

std::string written(const MarkedCells& cells, MarkedFormat format) {
  const Folder folder;
  const int fd = ::open(folder.path("out").c_str(), O_WRONLY | O_CREAT, 0644);
  write_marked_cells(fd, "out", cells, format);
  ::close(fd);
  return folder.bytes("out");
}

template <class T>
T raw_at(const std::string& bytes, std::size_t at) {
  T value;
  std::memcpy(&value, bytes.data() + at, sizeof value);
  return value;
}

TEST(MarkedCells, FormatsBySuffix) {
  EXPECT_EQ(marked_format_for_writing("a/b.vtp"), MarkedFormat::vtp);
  EXPECT_EQ(marked_format_for_writing("B.PLY"), MarkedFormat::ply);
  for (const char* path : {"a.stl", "a", "a.vtp/b", "-", ".vtp.gz"}) {
    try {
      marked_format_for_writing(path);
      ADD_FAILURE() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      EXPECT_TRUE(contains(error.hint(), {".vtp", ".ply"}));
    }
  }
}

TEST(MarkedCells, VtpAnnouncesItsArraysWhereTheyAre) {
  const std::string bytes = written(one_of_each(), MarkedFormat::vtp);
  EXPECT_TRUE(contains(bytes, {"NumberOfPoints=\"4\" NumberOfVerts=\"1\" NumberOfLines=\"1\"",
                               "NumberOfPolys=\"1\"", " 102 105 114 115 116 0\n"}));
  const std::size_t data = bytes.find("   _") + 4;
  std::size_t announced = 0, end = 0;
  for (std::size_t at = bytes.find("offset=\""); at != bytes.npos; at = bytes.find("offset=\"", at + 1)) {
    const std::size_t offset = std::stoul(bytes.substr(at + 8));
    EXPECT_EQ(offset, end);
    end = offset + 8 + raw_at<std::uint64_t>(bytes, data + offset);
    ++announced;
  }
  EXPECT_EQ(announced, 10u);  // kind, defect, rgb, points, and two arrays for each of three sorts of cells
  EXPECT_EQ(bytes.substr(data + end), "\n  </AppendedData>\n</VTKFile>\n");
  EXPECT_EQ(raw_at<std::int32_t>(bytes, data + 8 + 4), 1);             // the line's kind
  EXPECT_EQ(raw_at<std::int64_t>(bytes, data + 8 + 12 + 8 + 16), 13);  // the triangle's mark
}

TEST(MarkedCells, PlyIsReadAsItsTriangles) {
  const MarkedCells cells = one_of_each();
  const std::string bytes = written(cells, MarkedFormat::ply);
  EXPECT_TRUE(contains(bytes, {"comment kind 1 second\n", "element edge 1\n", "property int defect\n"}));
  const std::size_t body = bytes.find("end_header\n") + 11;
  EXPECT_EQ(bytes.size() - body, 4u * (24 + 3) + (1 + 12 + 3 + 8) + (8 + 3 + 8));
  EXPECT_EQ(bytes[body + 3 * 27 + 24], 1);  // the vert's colour
  EXPECT_EQ(raw_at<std::uint32_t>(bytes, bytes.size() - 4), 12u);
  const MeshFile read = read_text(bytes, "x.ply");
  EXPECT_EQ(read.soup.points, cells.points);
  EXPECT_EQ(read.soup.facets, cells.polys);
}

TEST(MarkedCells, NothingIsWrittenToo) {
  MarkedCells none;
  EXPECT_TRUE(contains(written(none, MarkedFormat::vtp), {"NumberOfPoints=\"0\"", "</VTKFile>"}));
  EXPECT_TRUE(contains(written(none, MarkedFormat::ply), {"element vertex 0\n", "end_header\n"}));
}

}  // namespace
}  // namespace burnish
