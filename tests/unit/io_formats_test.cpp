// OBJ, PLY and OFF, and what comes back when a soup is written and read in any format.
#include <fcntl.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <random>

#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using test::contains;
using test::read_error;
using test::read_text;
using test::Triangle;
using test::triangles_of;
using test::written;

constexpr std::array kFormats{MeshFormat::stl_binary, MeshFormat::stl_ascii, MeshFormat::obj,
                              MeshFormat::ply_binary, MeshFormat::ply_ascii, MeshFormat::off};

// A finite number of any size that float32 holds, exactly or not.
double random_coordinate(std::mt19937_64& random, bool as_float) {
  for (;;) {
    if (as_float) {
      const float f = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      if (std::isfinite(f)) return f;
    } else {
      const double d = std::bit_cast<double>(random());
      if (std::isfinite(d)) return d;
    }
  }
}

TriangleSoup random_soup(std::uint64_t seed, bool as_float) {
  std::mt19937_64 random(seed);
  TriangleSoup soup;
  soup.points.resize(3 + random() % 200);
  for (Vec3& p : soup.points)
    for (int axis = 0; axis < 3; ++axis) p[axis] = random_coordinate(random, as_float);
  const auto corner = [&] { return static_cast<std::uint32_t>(random() % soup.points.size()); };
  soup.facets.resize(1 + random() % 300);
  for (Facet& facet : soup.facets) facet = {corner(), corner(), corner()};
  if (random() % 2) {
    const auto first = static_cast<std::uint32_t>(soup.facets.size() / 2),
               all = static_cast<std::uint32_t>(soup.facets.size());
    soup.groups = {{"b \xff", first, all - first}};
    if (first > 0) soup.groups.insert(soup.groups.begin(), {"a name", 0, first});
  }
  return soup;
}

std::vector<std::string> group_names(const TriangleSoup& soup) {
  std::vector<std::string> names;
  for (const FacetGroup& g : soup.groups) names.push_back(g.name + ":" + std::to_string(g.first_facet));
  return names;
}

TEST(RoundTrip, EveryFormatGivesBackTheSameBits) {
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    for (const MeshFormat format : kFormats) {
      SCOPED_TRACE(testing::Message() << name(format) << ", seed " << seed);
      const TriangleSoup soup = random_soup(seed, stores_float32(format));
      const MeshFile file = read_text(written(soup, {.format = format}), "test.tmp");
      EXPECT_EQ(file.format, format);
      EXPECT_EQ(triangles_of(file.soup), triangles_of(soup));
      EXPECT_TRUE(file.warnings.empty());
      if (!soup.groups.empty() && format != MeshFormat::stl_binary && format != MeshFormat::off) {
        EXPECT_EQ(group_names(file.soup), group_names(soup));
      }
      if (!stores_float32(format)) {
        EXPECT_EQ(file.soup.points, soup.points);
        EXPECT_EQ(file.soup.facets, soup.facets);
      }
    }
  }
}

TEST(RoundTrip, SinglePrecisionPly) {
  const TriangleSoup soup = random_soup(5, true);
  for (const MeshFormat format : {MeshFormat::ply_ascii, MeshFormat::ply_binary})
    EXPECT_EQ(read_text(written(soup, {.format = format, .double_precision = false}), "a.ply").soup.points,
              soup.points);
}

TEST(Writing, BinaryStlHasNormalsOfTheRoundedFacets) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {2, 0, 0}, {0, 3, 0}};
  soup.facets = {{0, 1, 2}, {0, 2, 1}, {0, 0, 1}};
  const std::string bytes = written(soup, {.header = "solid part"});
  ASSERT_EQ(bytes.size(), 84u + 3 * 50);
  EXPECT_EQ(bytes.substr(0, 14), "STL solid part");
  for (std::size_t f = 0; f < 3; ++f) {
    std::array<float, 3> normal{};
    std::memcpy(normal.data(), bytes.data() + 84 + 50 * f, sizeof normal);
    const float z = f == 0 ? 1.0f : f == 1 ? -1.0f : 0.0f;
    EXPECT_EQ(normal, (std::array<float, 3>{0, 0, z}));
    EXPECT_FALSE(std::signbit(normal[0]));
    EXPECT_EQ(bytes.substr(84 + 50 * f + 48, 2), std::string(2, '\0'));
  }
}

TEST(Writing, CoordinatesBeyondFloatAreRefusedWhereFloatIsStored) {
  TriangleSoup soup;
  soup.points = {{0, 0, 0}, {1e39, 0, 0}, {0, 1, 0}};
  soup.facets = {{0, 1, 2}};
  for (const MeshFormat format : kFormats) {
    try {
      written(soup, {.format = format});
      EXPECT_FALSE(stores_float32(format));
    } catch (const Error& error) {
      EXPECT_TRUE(stores_float32(format));
      EXPECT_EQ(error.code(), ErrorCode::unwritable_output);
      EXPECT_TRUE(contains(error.what(), {"beyond the range of float32"}));
    }
  }
}

TEST(Writing, FullDiskIsAnErrorThatNamesLabelAndReason) {
  const int fd = ::open("/dev/full", O_WRONLY);
  if (fd < 0) GTEST_SKIP() << "no /dev/full";
  try {
    write_mesh(fd, "out.stl", random_soup(1, true), {});
    ADD_FAILURE();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::unwritable_output);
    EXPECT_TRUE(contains(error.what(), {"out.stl: ", "No space left"}));
  }
  ::close(fd);
}

TEST(Writing, NewlinesInNamesBreakNothing) {
  TriangleSoup soup = random_soup(3, true);
  soup.groups = {{"a\nfacet", 0, static_cast<std::uint32_t>(soup.facets.size())}};
  for (const MeshFormat format : {MeshFormat::stl_ascii, MeshFormat::obj, MeshFormat::ply_binary})
    EXPECT_EQ(read_text(written(soup, {.format = format}), "a").soup.groups.at(0).name, "a facet");
}

TEST(Writing, TheSuffixAsksForAFormat) {
  EXPECT_EQ(format_for_writing("a.stl"), MeshFormat::stl_binary);
  EXPECT_EQ(format_for_writing("a.STLA"), MeshFormat::stl_ascii);
  EXPECT_EQ(format_for_writing("a.b/c.PLY"), MeshFormat::ply_binary);
  EXPECT_EQ(format_for_writing("c.obj"), MeshFormat::obj);
  EXPECT_EQ(format_for_writing("c.off"), MeshFormat::off);
  for (const char* path : {"a", "a.step", "a.stl/b", ""})
    EXPECT_THROW(format_for_writing(path), Error) << path;
}

constexpr const char* kObjPoints = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\n";

TEST(Obj, CornersOfAllForms) {
  const std::vector<Facet> expected{{0, 1, 2}};
  for (const char* face : {"f 1 2 3", "f 1/1 2/5 3/7", "f 1/1/1 2/2/2 3/3/3", "f 1//1 2//2 3//3",
                           "f -4 -3 -2", "f 1 \\\n 2 \\\r\n 3", "f 1 2 3 # remark", "  f\t1 2 3  "})
    EXPECT_EQ(read_text(std::string(kObjPoints) + face + "\n", "a.obj").soup.facets, expected) << face;
}

TEST(Obj, PolygonsAreFansAndGroupsAreKept) {
  const MeshFile file = read_text(std::string("f 1 2 3\nmtllib x\n") + kObjPoints +
                                      "g first one\nf 1 2 3 4\no empty\ng last\nusemtl m\nf 1 2 4",
                                  "a.obj");
  EXPECT_EQ(file.soup.facets, (std::vector<Facet>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}, {0, 1, 3}}));
  EXPECT_EQ(group_names(file.soup), (std::vector<std::string>{":0", "first one:1", "last:3"}));
}

TEST(Obj, ExtraNumbersBehindAPointAreColoursOrWeights) {
  EXPECT_EQ(read_text("v 0 0 0 1\nv 1 0 0 0.5 0.5 0.5\nv 0 1 0\nf 1 2 3", "a.obj").soup.points[1],
            (Vec3{1, 0, 0}));
}

TEST(Obj, BrokenFacesAndPoints) {
  const std::string good = std::string(kObjPoints) + "f 1 2 3\n";
  for (const char* face :
       {"f 1 2 5", "f 0 1 2", "f -5 1 2", "f 1 2 x", "f 1 2 3.5", "f 1 2 99999999999999999999"}) {
    EXPECT_TRUE(contains(read_error(good + face, "a.obj"), {"a.obj: line 6: ", "--salvage"})) << face;
    const MeshFile file = read_text(good + face, "a.obj", true);
    EXPECT_EQ(file.soup.facets, (std::vector<Facet>{{0, 1, 2}}));
    EXPECT_FALSE(file.warnings.empty());
  }
  for (const char* point : {"v nan 0 0", "v 1 2", "v 1,5 0 0", "v x 0 0", "v 1e999 0 0"}) {
    const std::string text = good + point + "\nf 1 2 5\n";
    EXPECT_TRUE(contains(read_error(text, "a.obj"), {"a.obj: line 6: "})) << point;
    EXPECT_EQ(read_text(text, "a.obj", true).soup.facets.size(), 1u);
  }
  EXPECT_TRUE(contains(read_text(good + "f 1 2\n", "a.obj").warnings.at(0), {"fewer than three corners"}));
  EXPECT_TRUE(contains(read_error(kObjPoints, "a.obj"), {"holds no facets"}));
}

constexpr const char* kPlyHeader =
    "ply\nformat ascii 1.0\ncomment made by a test\nobj_info none\nelement vertex 4\nproperty uchar red\n"
    "property float x\nproperty list uchar float extra\nproperty double y\nproperty int z\nelement edge 1\n"
    "property int a\nelement face 2\nproperty uchar flag\nproperty list uchar uint "
    "vertex_index\nend_header\n";
constexpr const char* kPlyBody =
    "7 0 0 0 0\n7 1 2 9 9 0 0\n7 1 1 9 1 0\n7 0 0 1 0\n5\n1 3 0 1 2\n1 4 0 1 2 3\n";

TEST(Ply, PropertiesInAnyOrderAndOfAnyType) {
  const MeshFile file = read_text(std::string(kPlyHeader) + kPlyBody, "a.ply");
  EXPECT_EQ(file.soup.points, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}}));
  EXPECT_EQ(file.soup.facets, (std::vector<Facet>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}}));
}

template <class T>
void append(std::string& bytes, T value, bool big) {
  std::string raw;
  test::append_raw(raw, value);
  if (big) std::reverse(raw.begin(), raw.end());
  bytes += raw;
}

// Three points and a face, in binary; the header's lines end in `line_end`.
std::string binary_ply(bool big, const std::string& line_end, std::int32_t last_corner = 2) {
  std::string bytes;
  for (const char* line : {"ply", big ? "format binary_big_endian 1.0" : "format binary_little_endian 1.0",
                           "element vertex 3", "property double x", "property float y", "property short z",
                           "element face 1", "property list ushort int vertex_indices", "end_header"})
    bytes += line + line_end;
  for (const Vec3& p : {Vec3{10, 0, 0}, Vec3{1, 0.5, -3}, Vec3{0, 1, 7}}) {
    append(bytes, p.x, big);
    append(bytes, static_cast<float>(p.y), big);
    append(bytes, static_cast<std::int16_t>(p.z), big);
  }
  append(bytes, std::uint16_t{3}, big);
  for (const std::int32_t corner : {0, 1, last_corner}) append(bytes, corner, big);
  return bytes;
}

TEST(Ply, BinaryOfBothByteOrdersAndAllLineEnds) {
  for (const bool big : {false, true})
    for (const char* line_end : {"\n", "\r\n", "\r"}) {
      const MeshFile file = read_text(binary_ply(big, line_end), "a.ply");
      EXPECT_EQ(file.format, MeshFormat::ply_binary);
      EXPECT_EQ(file.soup.points, (std::vector<Vec3>{{10, 0, 0}, {1, 0.5, -3}, {0, 1, 7}}));
      EXPECT_EQ(file.soup.facets, (std::vector<Facet>{{0, 1, 2}}));
    }
}

TEST(Ply, BrokenBodies) {
  const std::string bytes = binary_ply(false, "\n");
  EXPECT_TRUE(contains(read_error(bytes.substr(0, bytes.size() - 1), "a.ply"),
                       {"truncated at byte ", "promises 1 of 'face', file holds 0"}));
  EXPECT_TRUE(contains(read_error(binary_ply(true, "\n", 3), "a.ply"), {"byte ", "refers to point 3"}));
  EXPECT_TRUE(contains(read_error(binary_ply(true, "\n", -1), "a.ply"), {"refers to point -1"}));
  std::string text = std::string(kPlyHeader) + kPlyBody;
  text.resize(text.size() - 3);
  EXPECT_TRUE(contains(read_error(text, "a.ply"), {"promises 2 of 'face', file holds 1"}));
  EXPECT_EQ(read_text(text, "a.ply", true).soup.facets.size(), 1u);
  text = std::string(kPlyHeader) + kPlyBody;
  text.replace(text.find("7 1 1 9"), 7, "7 1 x 9");
  EXPECT_TRUE(contains(read_error(text, "a.ply"), {"line 19: "}));
}

TEST(Ply, BrokenHeaders) {
  const std::string whole = std::string(kPlyHeader) + kPlyBody;
  const auto with = [&](const std::string& from, const std::string& to) {
    std::string text = whole;
    return read_error(text.replace(text.find(from), from.size(), to), "a.ply");
  };
  EXPECT_TRUE(contains(with("ascii", "ebcdic"), {"line 2", "'ebcdic'"}));
  EXPECT_TRUE(contains(with("format ascii 1.0\n", ""), {"no line 'format'"}));
  EXPECT_TRUE(contains(with("vertex 4", "vertex four"), {"line 5", "'four'"}));
  EXPECT_TRUE(contains(with("uchar red", "colour red"), {"line 6", "'colour'"}));
  EXPECT_TRUE(contains(with("element vertex 4\n", ""), {"'element' before 'property'"}));
  EXPECT_TRUE(contains(with("end_header\n", ""), {"expected 'end_header'"}));
}

TEST(Ply, HugeCountsAllocateNothing) {
  std::string text = std::string(kPlyHeader) + kPlyBody;
  text.replace(text.find("face 2"), 6, "face 18446744073709551615");
  EXPECT_TRUE(contains(read_error(text, "a.ply"), {"file holds 2"}));
  EXPECT_EQ(read_text(text, "a.ply", true).soup.facets.size(), 3u);
}

TEST(Off, CountsCommentsAndColours) {
  const std::vector<Facet> expected{{0, 1, 2}, {0, 2, 3}};
  const std::string points = "0 0 0\n1 0 0\n# remark\n1 1 0 # remark\n\n0 1 0\n";
  for (const std::string head :
       {"OFF\n4 1 0\n", "OFF 4 1 0\n", "OFF\n4 1\n", "# first\nOFF # second\n# third\n4 1 5\n", "4 1 0\n"})
    EXPECT_EQ(read_text(head + points + "4 0 1 2 3\n", "a.off").soup.facets, expected) << head;
  EXPECT_EQ(
      read_text(
          "COFF\n4 1 0\n0 0 0 1 1 1 1\n1 0 0 0 0 0 1\n1 1 0 9 9 9 9\n0 1 0 1 1 1 1\n4 0 1 2 3 0.5 0.5 0.5\n",
          "a")
          .soup.facets,
      expected);
  EXPECT_EQ(read_text("NOFF\n4 1 0\n0 0 0 0 0 1\n1 0 0 0 0 1\n1 1 0 0 0 1\n0 1 0 0 0 1\n4 0 1 2 3\n", "a")
                .soup.facets,
            expected);
}

TEST(Off, BrokenFiles) {
  const std::string points = "0 0 0\n1 0 0\n1 1 0\n";
  EXPECT_TRUE(contains(read_error("OFF\n3 2 0\n" + points + "3 0 1 2\n", "a.off"),
                       {"header promises 2 faces, file holds 1"}));
  EXPECT_TRUE(
      contains(read_error("OFF\n9 1 0\n" + points, "a.off"), {"header promises 9 vertices, file holds 3"}));
  EXPECT_TRUE(contains(read_error("OFF\n3 1 0\n" + points + "3 0 1 3\n", "a.off"),
                       {"line 6: a polygon refers to point 3"}));
  EXPECT_TRUE(contains(read_error("OFF\n3 1 0\n0 0 0\n1,5 0 0\n0 0 0\n3 0 1 2\n", "a.off"),
                       {"line 4", "decimal commas"}));
  EXPECT_TRUE(contains(read_error("OFF\nx 1 0\n", "a.off"), {"expected the number of vertices, found 'x'"}));
  EXPECT_TRUE(contains(read_error("OFF BINARY\n", "a.off"), {"binary OFF"}));
  EXPECT_TRUE(contains(read_error("4OFF\n1 1 1\n", "a.off"), {"three coordinates"}));
  EXPECT_EQ(
      read_text("OFF\n3 99999999999 0\n" + points + "3 0 1 2\n3 0 1\n", "a.off", true).soup.facets.size(),
      1u);
}

}  // namespace
}  // namespace burnish
