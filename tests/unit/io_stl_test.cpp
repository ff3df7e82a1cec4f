// STL as it is met in the wild: every kind of malformed file gets the facets it holds or a clear error.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>

#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using test::binary_stl;
using test::contains;
using test::read_error;
using test::read_text;
using test::tetrahedron;
using test::Triangle;
using test::triangles_of;

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

// One facet; `c` stands where the first coordinate of its second vertex is.
std::string facet(const std::string& c = "1") {
  return "  facet normal 0 0 1\n    outer loop\n      vertex 0 0 0\n      vertex " + c +
         " 0 0\n      vertex 0 1 0\n    endloop\n  endfacet\n";
}

std::string solid(const std::string& facets, const std::string& name = "part") {
  return "solid " + name + "\n" + facets + "endsolid " + name + "\n";
}

std::string with_line_ends(std::string text, const std::string& line_end) {
  std::string out;
  for (const char c : text) {
    if (c == '\n')
      out += line_end;
    else
      out += c;
  }
  return out;
}

std::size_t facets_of(const std::string& bytes, bool salvage = false) {
  return read_text(bytes, "test.stl", salvage).soup.facets.size();
}

TEST(BinaryStl, HoldsItsFacetsExactly) {
  const MeshFile file = read_text(binary_stl(tetrahedron()));
  EXPECT_EQ(file.format, MeshFormat::stl_binary);
  EXPECT_EQ(file.header, "test");
  EXPECT_EQ(triangles_of(file.soup), tetrahedron());
  EXPECT_EQ(file.soup.points.size(), 12u);
  EXPECT_TRUE(file.warnings.empty());
}

TEST(BinaryStl, HeaderMayBeginWithSolid) {
  for (const char* header :
       {"solid", "solid part", "SOLID facet normal", "solid \xff\xfe"}) {
    const MeshFile file = read_text(binary_stl(tetrahedron(), 4, header));
    EXPECT_EQ(file.format, MeshFormat::stl_binary) << header;
    EXPECT_EQ(file.header, header);
    EXPECT_EQ(file.soup.facets.size(), 4u);
  }
}

TEST(BinaryStl, SolidHeaderIsNoTextEvenWhenTheCountLies) {
  EXPECT_TRUE(contains(read_error(binary_stl(tetrahedron(), 9, "solid part")), {"truncated at byte 284"}));
}

TEST(BinaryStl, TruncatedNamesPlacePromiseAndHolding) {
  const std::string bytes = binary_stl(tetrahedron(), 12000);
  EXPECT_EQ(read_error(bytes, "pump.stl"),
            "pump.stl: truncated at byte 284: header promises 12000 triangles, file holds 4 | "
            "re-export the file, or pass --salvage to use what is there");
  const MeshFile salvaged = read_text(bytes, "pump.stl", true);
  EXPECT_EQ(triangles_of(salvaged.soup), tetrahedron());
  EXPECT_EQ(salvaged.warnings.size(), 1u);
}

TEST(BinaryStl, TruncatedWithinAFacetSalvagesTheWholeOnes) {
  std::string bytes = binary_stl(tetrahedron());
  bytes.resize(bytes.size() - 1);
  EXPECT_TRUE(contains(read_error(bytes), {"promises 4 triangles, file holds 3"}));
  EXPECT_EQ(facets_of(bytes, true), 3u);
}

TEST(BinaryStl, HugeCountsAllocateNothing) {
  for (const std::uint32_t count : {0xffffffffu, 0x80000000u, 0x51eb851fu})
    EXPECT_EQ(facets_of(binary_stl(tetrahedron(), count), true), 4u);
}

TEST(BinaryStl, CountTooSmallForWholeFacetsReadsAllAndSaysSo) {
  for (const std::uint32_t count : {0u, 1u, 3u}) {
    const MeshFile file = read_text(binary_stl(tetrahedron(), count));
    EXPECT_EQ(file.soup.facets.size(), 4u) << count;
    ASSERT_EQ(file.warnings.size(), 1u);
    EXPECT_TRUE(contains(file.warnings[0], {"file holds 4"}));
  }
}

TEST(BinaryStl, TrailerThatIsNoFacetIsIgnored) {
  for (const std::string& trailer : {std::string("abc"), std::string(50, '\x7e'), std::string(50, '\xff')}) {
    const MeshFile file = read_text(binary_stl(tetrahedron()) + trailer);
    EXPECT_EQ(file.soup.facets.size(), 4u);
    ASSERT_EQ(file.warnings.size(), 1u);
    EXPECT_TRUE(contains(file.warnings[0], {"behind the last"}));
  }
}

TEST(BinaryStl, CoordinatesThatAreNotFinite) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    std::vector<Triangle> triangles = tetrahedron();
    triangles[2][1].y = bad;
    EXPECT_TRUE(
        contains(read_error(binary_stl(triangles)), {"byte 184: facet 2 has a coordinate that is not"}));
    const MeshFile file = read_text(binary_stl(triangles), "test.stl", true);
    EXPECT_EQ(file.soup.facets.size(), 3u);
    EXPECT_TRUE(contains(file.warnings.at(0), {"left out 1 facet"}));
  }
}

TEST(BinaryStl, TooShortForAFacet) {
  EXPECT_TRUE(contains(read_error(""), {"is empty (0 bytes)"}));
  EXPECT_TRUE(contains(read_error(binary_stl({})), {"holds no facets"}));
  for (const std::size_t size : {1u, 20u, 83u})
    EXPECT_TRUE(contains(read_error(std::string(size, '\x01')), {"at least 84 bytes"}));
  for (const std::size_t size : {84u, 100u, 133u}) {
    std::string bytes = binary_stl(tetrahedron());
    bytes.resize(size);
    EXPECT_TRUE(contains(read_error(bytes), {"promises 4 triangles, file holds 0"})) << size;
    EXPECT_FALSE(read_error(bytes, "test.stl", true).empty());
  }
}

TEST(BinaryStl, LargeCoordinatesKeepTheirBits) {
  const float step = 0.5f, origin = 4.8e6f;
  const Triangle t{Vec3{origin, 0, 0}, Vec3{origin + step, 0, 0}, Vec3{origin, step, 1e-38f}};
  EXPECT_EQ(triangles_of(read_text(binary_stl({t})).soup).at(0), t);
}

TEST(AsciiStl, AnyLineEnds) {
  const std::string text = solid(facet() + facet());
  for (const char* line_end : {"\n", "\r", "\r\n", " ", "\n\n", "\t\n"}) {
    const MeshFile file = read_text(with_line_ends(text, line_end));
    EXPECT_EQ(file.format, MeshFormat::stl_ascii);
    EXPECT_EQ(file.soup.facets.size(), 2u);
    EXPECT_TRUE(file.warnings.empty());
  }
}

TEST(AsciiStl, LinesAreCountedForAnyLineEnd) {
  const std::string text = solid(facet() + facet("x"));
  for (const char* line_end : {"\n", "\r", "\r\n"})
    EXPECT_TRUE(contains(read_error(with_line_ends(text, line_end)), {"test.stl: line 12: x of a vertex"}));
}

TEST(AsciiStl, KeywordsInAnyCase) {
  std::string upper = solid(facet());
  std::transform(upper.begin(), upper.end(), upper.begin(),
                 [](char c) { return static_cast<char>(std::toupper(c)); });
  EXPECT_EQ(facets_of(upper), 1u);
  EXPECT_EQ(
      facets_of("Solid a\nFacet Normal 0 0 1\nOuter Loop\nVertex 0 0 0\nvErtex 1 0 0\nVERTEX 0 1 0\nEndLoop\n"
                "EndFacet\nEndSolid\n"),
      1u);
  EXPECT_EQ(
      facets_of(
          "solid\nfacet normal 0 0 1 outer loop vertex 0 0 0 vertex 1 0 0 vertex 0 1 0 end loop end facet\n"
          "end solid"),
      1u);
}

TEST(AsciiStl, SolidsBecomeGroupsWithTheirBytesForNames) {
  const std::vector<std::string> names{"plain", "two words", "\xe6\x9c\x88\xe4\xba\xae", "bad \xff\xfe utf-8",
                                       ""};
  std::string text;
  for (const std::string& name : names) text += solid(facet(), name);
  const MeshFile file = read_text(text);
  ASSERT_EQ(file.soup.groups.size(), names.size());
  for (std::uint32_t i = 0; i < names.size(); ++i) {
    EXPECT_EQ(file.soup.groups[i].name, names[i]);
    EXPECT_EQ(file.soup.groups[i].first_facet, i);
    EXPECT_EQ(file.soup.groups[i].facet_count, 1u);
  }
  EXPECT_TRUE(file.warnings.empty());
}

TEST(AsciiStl, EmptySolidsLeaveNoTrace) {
  const MeshFile file = read_text(solid("", "a") + solid(facet(), "b") + solid("", "c"));
  ASSERT_EQ(file.soup.groups.size(), 1u);
  EXPECT_EQ(file.soup.groups[0].name, "b");
  EXPECT_TRUE(contains(read_error(solid("")), {"holds no facets"}));
  EXPECT_TRUE(contains(read_error("solid"), {"holds no facets"}));
}

TEST(AsciiStl, OddWordsAreIgnoredAndCounted) {
  const MeshFile file = read_text(
      "solid a\nfacet normal +inf -inf weird\nouter loop foo\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\n"
      "endloop bar\nendfacet blah blah\nendsolid what ever\n");
  EXPECT_EQ(file.soup.facets.size(), 1u);
  ASSERT_EQ(file.warnings.size(), 1u);
  EXPECT_EQ(file.warnings[0], "4 words that an STL does not have ignored, the first at line 3");
}

TEST(AsciiStl, FacetsWithoutSolidOrNormal) {
  EXPECT_EQ(facets_of(facet()), 1u);
  EXPECT_EQ(
      facets_of(
          "solid\nfacet\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\nendsolid"),
      1u);
  EXPECT_EQ(facets_of("\xef\xbb\xbf" + solid(facet())), 1u);
}

TEST(AsciiStl, MoreThanThreeVerticesMakeAFan) {
  const MeshFile file = read_text(
      "solid\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 1 1 0\nvertex 0 1 "
      "0\nendloop\n"
      "endfacet\nendsolid\n");
  const std::vector<Triangle> expected{{Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{1, 1, 0}},
                                       {Vec3{0, 0, 0}, Vec3{1, 1, 0}, Vec3{0, 1, 0}}};
  EXPECT_EQ(triangles_of(file.soup), expected);
  EXPECT_TRUE(contains(file.warnings.at(0), {"first at line 2"}));
}

TEST(AsciiStl, FewerThanThreeVertices) {
  const std::string text =
      solid(facet() + "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nendloop\nendfacet\n");
  EXPECT_TRUE(contains(read_error(text), {"line 9: expected a facet of 3 vertices, found 2", "--salvage"}));
  EXPECT_EQ(facets_of(text, true), 1u);
  const std::string none = solid(facet() + "facet normal 0 0 1\nouter loop\nendloop\nendfacet\n" + facet());
  EXPECT_TRUE(contains(read_error(none), {"found 0"}));
  EXPECT_EQ(facets_of(none, true), 2u);
}

TEST(AsciiStl, VerticesThatAreNoFiniteNumbers) {
  for (const char* bad : {"x", "nan", "inf", "-Infinity", "1e999", "1.#QNAN", "1.0.0", "--1", "+-1", "0x10",
                          "1e", "vertex", ""}) {
    const std::string text = solid(facet() + facet(bad));
    EXPECT_TRUE(contains(read_error(text), {"line 1", "expected a ", "--salvage"})) << bad;
    const MeshFile file = read_text(text, "test.stl", true);
    EXPECT_EQ(file.soup.facets.size(), 1u) << bad;
    EXPECT_FALSE(file.warnings.empty());
  }
}

TEST(AsciiStl, DecimalCommas) {
  const std::string text = solid(facet("1,5"));
  EXPECT_TRUE(contains(read_error(text), {"line 5", "'1,5'", "uses decimal commas"}));
  EXPECT_EQ(read_text(text, "test.stl", true).soup.corner(0, 1), (Vec3{1.5, 0, 0}));
  EXPECT_FALSE(contains(read_error(solid(facet("1,000.5"))), {"decimal commas"}));
}

TEST(AsciiStl, FilesThatEndEarly) {
  const std::string text = solid(facet() + facet());
  EXPECT_TRUE(
      contains(read_text(text.substr(0, text.find("endsolid"))).warnings.at(0), {"without 'endsolid'"}));
  const std::size_t second = text.rfind("facet normal");
  for (std::size_t size = second + 12; size < text.rfind("endfacet"); size += 7) {
    EXPECT_FALSE(read_error(text.substr(0, size)).empty()) << size;
    EXPECT_GE(facets_of(text.substr(0, size), true), 1u);
  }
  EXPECT_TRUE(contains(read_error(text.substr(0, text.find("vertex 0 1 0") + 8)), {"truncated"}));
}

TEST(AsciiStl, LongHeaderIsStillText) { EXPECT_EQ(facets_of(solid(facet(), std::string(5000, 'n'))), 1u); }

TEST(AsciiStl, StoredNormalsDecideNothing) {
  const std::string text = solid(facet());
  std::string flipped = text;
  flipped.replace(flipped.find("0 0 1"), 5, "0 0 -1");
  EXPECT_EQ(triangles_of(read_text(text).soup), triangles_of(read_text(flipped).soup));
}

// The fast path for short decimals, and everything around its edges, against the C library.
TEST(AsciiStl, NumbersAreTheNearestDoubles) {
  std::mt19937_64 random(20240607);
  std::vector<std::string> numbers{"0",
                                   "-0",
                                   "+1",
                                   ".5",
                                   "5.",
                                   "1e22",
                                   "1e23",
                                   "1e-22",
                                   "1e-23",
                                   "9007199254740993",
                                   "9007199254740992e22",
                                   "123456789012345678901234567890",
                                   "1e-400",
                                   "-1e-999999999",
                                   "0e999999999",
                                   "4.9e-324",
                                   "2e-324",
                                   "1.7976931348623157e308",
                                   "0.1",
                                   "00001.5000E+003",
                                   "0." + std::string(400, '0') + "1e400",
                                   std::string(30, '1') + "e-30",
                                   "0." + std::string(400, '0') + "1"};
  for (int i = 0; i < 20000; ++i) {
    std::string number = random() % 2 ? "-" : "";
    const std::size_t digits = 1 + random() % 21, point = random() % (digits + 1);
    for (std::size_t d = 0; d < digits; ++d) {
      if (d == point) number += '.';
      number += static_cast<char>('0' + random() % 10);
    }
    if (random() % 2) number += "e" + std::to_string(static_cast<int>(random() % 60) - 30);
    numbers.push_back(number);
  }
  std::string text = "solid\n";
  for (const std::string& number : numbers) text += facet(number);
  const TriangleSoup soup = read_text(text).soup;
  ASSERT_EQ(soup.facets.size(), numbers.size());
  for (std::size_t f = 0; f < numbers.size(); ++f) {
    const double expected = std::strtod(numbers[f].c_str(), nullptr);
    EXPECT_EQ(soup.corner(f, 1).x, expected) << numbers[f] << " (seed 20240607)";
    EXPECT_EQ(std::signbit(soup.corner(f, 1).x), std::signbit(expected)) << numbers[f];
  }
}

TEST(FormatOfAFile, ContentDecidesBeforeTheName) {
  const std::string obj = "# a comment\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n";
  const MeshFile file = read_text(obj, "mislabelled.STL");
  EXPECT_EQ(file.format, MeshFormat::obj);
  EXPECT_EQ(file.warnings.size(), 1u);
  EXPECT_EQ(read_text(binary_stl(tetrahedron()), "a.obj").format, MeshFormat::stl_binary);
  EXPECT_EQ(read_text(solid(facet()), "standard input").format, MeshFormat::stl_ascii);
  EXPECT_TRUE(read_text(solid(facet()), "standard input").warnings.empty());
}

TEST(FormatOfAFile, OtherTextsAndArchivesAreNamed) {
  EXPECT_TRUE(contains(read_error("hello world\n"),
                       {"line 1: expected the beginning of an STL, OBJ, PLY or OFF, found 'hello'"}));
  EXPECT_TRUE(contains(read_error("hello"), {"test.stl: "}));
  EXPECT_TRUE(contains(read_error("PK\x03\x04" + std::string(200, 'x')), {"ZIP"}));
  EXPECT_TRUE(contains(read_error("\x1f\x8b\x08" + std::string(200, '\0')), {"gzip"}));
  EXPECT_TRUE(contains(read_error("<!DOCTYPE html><p>404"), {"web page"}));
  EXPECT_TRUE(contains(read_error(" \n\n"), {"is empty but for blanks"}));
  EXPECT_TRUE(contains(read_error("hello", "a.ply"), {"expected 'ply'"}));
}

TEST(FormatOfAFile, MissingFilesAndFoldersAreErrors) {
  for (const char* path : {"/nonexistent/file.stl", "/"}) {
    try {
      read_mesh(std::string(path));
      FAIL() << path;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unreadable_input);
      EXPECT_TRUE(contains(error.what(), {path}));
    }
  }
}

}  // namespace
}  // namespace burnish
