// Names and colours: what files have of them is read, and survives being written.
#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "burnish/surface/weld.h"
#include "support/mesh_bytes.h"

namespace burnish {
namespace {

using test::binary_stl;
using test::contains;
using test::read_text;
using test::tetrahedron;
using test::triangles_of;
using test::written;

constexpr Color kRed = color_of(255, 0, 0), kGreen = color_of(0, 255, 0), kBlue = color_of(0, 0, 255);

std::vector<Color> stl_colors(const std::vector<std::uint16_t>& attributes,
                              const std::string& header = "part") {
  return read_text(binary_stl(tetrahedron(), 4, header, attributes)).soup.colors;
}

// A soup of one facet per colour, in runs named `names` of two facets each.
TriangleSoup named_soup(const std::vector<std::string>& names, const std::vector<Color>& colors = {}) {
  TriangleSoup soup;
  soup.colors = colors;
  const std::size_t facets = names.empty() ? colors.size() : 2 * names.size();
  for (std::uint32_t f = 0; f < facets; ++f) {
    for (const Vec3& p : {Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}})
      soup.points.push_back(p + Vec3{0, 0, double(f)});
    soup.facets.push_back({3 * f, 3 * f + 1, 3 * f + 2});
  }
  for (std::uint32_t g = 0; g < names.size(); ++g) soup.groups.push_back({names[g], 2 * g, 2});
  return soup;
}

TriangleSoup back(const TriangleSoup& soup, MeshFormat format) {
  const MeshFile file = read_text(written(soup, {.format = format}), "test.tmp");
  EXPECT_EQ(triangles_of(file.soup), triangles_of(soup));
  EXPECT_TRUE(file.warnings.empty());
  return file.soup;
}

TEST(Names, SurviveInEveryFormatThatHasGroups) {
  const std::vector<std::string> names{
      "inlet",    "a name with  blanks",   "\xe9\x98\x80\xe4\xbd\x93", "\xff\xfe\x80", "", "inlet",
      "endsolid", "group 3 element face 1"};
  for (const MeshFormat format :
       {MeshFormat::stl_ascii, MeshFormat::obj, MeshFormat::ply_binary, MeshFormat::ply_ascii}) {
    SCOPED_TRACE(name(format));
    const TriangleSoup soup = back(named_soup(names), format);
    ASSERT_EQ(soup.groups.size(), names.size());
    for (std::size_t g = 0; g < names.size(); ++g) {
      EXPECT_EQ(soup.groups[g].name, names[g]);
      EXPECT_EQ(soup.groups[g].first_facet, 2 * g);
      EXPECT_EQ(soup.groups[g].facet_count, 2u);
    }
  }
}

TEST(Names, ABackslashAtTheEndJoinsNoLinesOfAnObj) {
  EXPECT_EQ(back(named_soup({"C:\\parts\\", "\\ \\"}), MeshFormat::obj).groups.at(0).name, "C:\\parts");
}

TEST(Colors, PlyAndOffKeepAllBits) {
  const std::vector<Color> colors{kRed, kNoColor, color_of(1, 2, 3, 4), color_of(254, 127, 128)};
  for (const MeshFormat format : {MeshFormat::ply_binary, MeshFormat::ply_ascii, MeshFormat::off})
    EXPECT_EQ(back(named_soup({}, colors), format).colors, colors) << name(format);
  const TriangleSoup both = back(named_soup({"a", "b"}, colors), MeshFormat::ply_binary);
  EXPECT_EQ(both.colors, colors);
  EXPECT_EQ(both.groups.size(), 2u);
}

TEST(Colors, MagicsReadsHeaderAndFacets) {
  const std::string header = std::string("STLB COLOR=\x10\x20\x30\x40", 15) + ",MATERIAL=";
  EXPECT_EQ(stl_colors({0x8000, 0x001f, 0x03e0, 0x7c00}, header),
            (std::vector<Color>{color_of(16, 32, 48, 64), kRed, kGreen, kBlue}));
  EXPECT_EQ(stl_colors({0xffff, 0, 0, 0x4e73}, header),
            (std::vector<Color>{color_of(16, 32, 48, 64), color_of(0, 0, 0), color_of(0, 0, 0),
                                color_of(156, 156, 156)}));
  EXPECT_EQ(read_text(binary_stl(tetrahedron(), 4, header)).header, "STLB");
}

TEST(Colors, MagicsWithAttributesLeftUnsetIsTheHeadersColour) {
  EXPECT_EQ(stl_colors({0}, "COLOR=\xff\x20\x30\xff"), std::vector<Color>(4, color_of(255, 32, 48)));
  EXPECT_TRUE(stl_colors({0}, std::string("COLOR=\x10\x20\x30\x00", 10)).empty());
  EXPECT_TRUE(stl_colors({0}, std::string(71, 'x') + "COLOR=\x10\x20\x30").empty());  // one byte too late
}

TEST(Colors, ViscamHasTheOtherOrderAndUncolouredFacets) {
  EXPECT_EQ(stl_colors({0x801f, 0, 0x83e0, 0xfc00}), (std::vector<Color>{kBlue, kNoColor, kGreen, kRed}));
  EXPECT_EQ(stl_colors({0xfc00}), std::vector<Color>(4, kRed));
}

TEST(Colors, JunkInAttributesIsNone) {
  for (const int fill : {0x0000, 0x2020, 0xffff, 0xcdcd, 0x7fff, 0x0001})
    EXPECT_TRUE(stl_colors({static_cast<std::uint16_t>(fill)}).empty()) << fill;
  EXPECT_TRUE(stl_colors({0, 1, 2, 3}).empty());                      // numbers of faces
  EXPECT_TRUE(stl_colors({0x801f, 0x83e0, 0xfc00, 0x2020}).empty());  // VisCAM's, but for one
  std::mt19937 random(7);
  for (int i = 0; i < 100; ++i) {
    std::vector<std::uint16_t> attributes(4);
    for (std::uint16_t& a : attributes) a = static_cast<std::uint16_t>(random());
    attributes[i % 4] = static_cast<std::uint16_t>(1 + random() % 0x7fff);
    EXPECT_TRUE(stl_colors(attributes).empty());
  }
}

TEST(Colors, BinaryStlRoundsToFiveBitsButForTheMostFrequent) {
  const Color most = color_of(1, 2, 3, 128);
  const std::vector<Color> colors{kRed, most, color_of(100, 101, 102), most, color_of(255, 254, 8)};
  const std::vector<Color> read = back(named_soup({}, colors), MeshFormat::stl_binary).colors;
  ASSERT_EQ(read.size(), colors.size());
  EXPECT_EQ(read[0], kRed);
  EXPECT_EQ(read[1], most);
  EXPECT_EQ(read[3], most);
  for (const std::size_t f : {2, 4}) {
    EXPECT_EQ(channel(read[f], 3), 255u);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(static_cast<int>(channel(read[f], i)), static_cast<int>(channel(colors[f], i)), 5);
  }
  // What was rounded once stays.
  EXPECT_EQ(back(named_soup({}, read), MeshFormat::stl_binary).colors, read);
}

TEST(Colors, BinaryStlLeavesFacetsWithout) {
  const std::vector<Color> colors{kRed, kNoColor, kBlue, kNoColor, color_of(0, 0, 0)};
  const TriangleSoup soup = named_soup({}, colors);
  EXPECT_EQ(back(soup, MeshFormat::stl_binary).colors, colors);
  EXPECT_EQ(written(soup, {}).find("COLOR="), std::string::npos);
  EXPECT_TRUE(back(named_soup({}, {kNoColor, kNoColor}), MeshFormat::stl_binary).colors.empty());
}

TEST(Colors, HeadersAreTextThenColour) {
  const TriangleSoup red = named_soup({}, {kRed, kRed});
  const std::string bytes = written(red, {.header = "solid " + std::string(200, 'x')});
  EXPECT_EQ(bytes.substr(0, 10), "STL solid ");
  EXPECT_EQ(bytes.substr(69, 10), "COLOR=\xff" + std::string("\0\0\xff", 3));
  EXPECT_EQ(read_text(bytes).header, "STL solid " + std::string(58, 'x') + "x");
  EXPECT_EQ(read_text(written(red, {})).header, "burnish");
  // A header that only speaks of colours gives none.
  EXPECT_TRUE(read_text(written(named_soup({"a"}), {.header = "a COLOR=abcd"})).soup.colors.empty());
}

TEST(Colors, SalvageKeepsThemWithTheirFacets) {
  std::vector<test::Triangle> triangles = tetrahedron();
  triangles[1][0].x = std::numeric_limits<double>::infinity();
  const std::string bytes = binary_stl(triangles, 4, "test", {0x801f, 0x83e0, 0, 0xfc00});
  EXPECT_EQ(read_text(bytes, "a.stl", true).soup.colors, (std::vector<Color>{kBlue, kNoColor, kRed}));
  const std::string off =
      "OFF\n4 3 0\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n3 0 1 2 255 0 0\n3 0 1 9 0 255 0\n3 0 1 3 0 0 255\n";
  EXPECT_EQ(read_text(off, "a.off", true).soup.colors, (std::vector<Color>{kRed, kBlue}));
}

TEST(Colors, OffFacesInWholeNumbersAndFractions) {
  const std::string points = "4 5 0\n0 0 0\n1 0 0\n0 1 0\n1 1 0\n";
  const MeshFile file = read_text("OFF\n" + points +
                                      "3 0 1 2\n4 0 1 3 2 255 0 0 # red\n3 0 1 2 0.0 0.5 1.0 1.0\n3 0 1 2 7\n"
                                      "3 0 1 2 1e300 -4 1.0\n",
                                  "a.off");
  EXPECT_EQ(file.soup.colors, (std::vector<Color>{kNoColor, kRed, kRed, color_of(0, 128, 255), kNoColor,
                                                  color_of(255, 0, 255)}));
}

const std::string kPlyHead =
    "element vertex 3\nproperty float x\nproperty float y\nproperty float z\nelement face 3\n"
    "property list uchar int vertex_indices\n";
const std::string kPlyPoints = "end_header\n0 0 0\n1 0 0\n0 1 0\n";

TEST(Colors, PlyWithoutAlphaIsOpaqueAndOddNumbersAreClamped) {
  const MeshFile file = read_text("ply\nformat ascii 1.0\n" + kPlyHead +
                                      "property uchar red\nproperty uchar green\nproperty uchar blue\n" +
                                      kPlyPoints + "3 0 1 2 255 0 0\n3 0 1 2 0 300 -7\n3 0 1 2 0 0 255\n",
                                  "a.ply");
  EXPECT_EQ(file.soup.colors, (std::vector<Color>{kRed, kGreen, kBlue}));
}

MeshFile grouped_ply(const std::string& comments, const std::string& numbers) {
  std::string text = "ply\nformat ascii 1.0\n" + comments + kPlyHead + "property int group\n" + kPlyPoints;
  for (const char number : numbers) text += std::string("3 0 1 2 ") + number + "\n";
  return read_text(text, "a.ply");
}

TEST(Names, PlyGroupsAreRunsOfFaces) {
  const MeshFile file = grouped_ply("comment group 4 b c\ncomment group x\n", "411");
  ASSERT_EQ(file.soup.groups.size(), 2u);
  EXPECT_EQ(file.soup.groups[0].name, "b c");
  EXPECT_EQ(file.soup.groups[1].name, "");
  EXPECT_EQ(file.soup.groups[1].facet_count, 2u);
  EXPECT_TRUE(grouped_ply("", "411").soup.groups.empty());  // somebody else's property
  const MeshFile scattered = grouped_ply("comment group 4 b\n", "414");
  EXPECT_TRUE(scattered.soup.groups.empty());
  ASSERT_EQ(scattered.warnings.size(), 1u);
  EXPECT_TRUE(contains(scattered.warnings[0], {"do not follow each other"}));
}

TEST(Colors, WeldingAndDroppingCarryThem) {
  TriangleSoup soup = named_soup({"a", "b"}, {kRed, kGreen, kBlue, kNoColor});
  soup.facets[1] = {3, 4, 3};
  const TriangleSoup welded = weld(soup);
  EXPECT_EQ(welded.colors, soup.colors);
  EXPECT_EQ(weld(TriangleSoup(soup)).colors, soup.colors);
  EXPECT_EQ(drop_degenerate_and_duplicate_facets(welded).soup.colors,
            (std::vector<Color>{kRed, kBlue, kNoColor}));
}

}  // namespace
}  // namespace burnish
