// 3MF: what is written comes back, and hostile archives are refused.
#include <gtest/gtest.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <random>

#include "support/mesh_bytes.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

MeshWriteOptions as_3mf(ModelUnit unit = ModelUnit::millimetre) {
  MeshWriteOptions options;
  options.format = MeshFormat::threemf;
  options.unit = unit;
  return options;
}

TEST(ThreeMf, UnitsHaveTheirNamesAndLengths) {
  EXPECT_EQ(model_unit("in"), ModelUnit::inch);
  EXPECT_EQ(name(ModelUnit::micrometre), "um");
  EXPECT_FALSE(model_unit("Meter"));
  EXPECT_EQ(converted(1, ModelUnit::foot, ModelUnit::metre), 0.3048);
  EXPECT_DOUBLE_EQ(converted(12, ModelUnit::inch, ModelUnit::foot), 1);
}

TEST(ThreeMf, GivesBackEveryBitOfFloatsAndTheUnit) {
  std::mt19937_64 random(7);
  for (int round = 0; round < 30; ++round) {
    TriangleSoup soup;
    while (soup.points.size() < 60) {
      Vec3 p;
      for (int a = 0; a < 3; ++a) p[a] = std::bit_cast<float>(static_cast<std::uint32_t>(random()));
      if (is_finite(p) && std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}) < 1e9) soup.points.push_back(p);
    }
    for (std::uint32_t i = 0; i < 58; ++i) soup.facets.push_back({i, i + 1, i + 2});
    const auto unit = static_cast<ModelUnit>(round % 6);
    const MeshFile file = read_text(written(soup, as_3mf(unit)), "test.3mf");
    EXPECT_EQ(file.format, MeshFormat::threemf);
    EXPECT_EQ(file.unit, unit);
    EXPECT_EQ(triangles_of(file.soup), triangles_of(soup));
    EXPECT_TRUE(file.warnings.empty()) << file.warnings.front();
  }
}

TEST(ThreeMf, IsTheSameBytesEveryTimeAndFoundByContent) {
  const std::string bytes = written(icosphere(3), as_3mf());
  EXPECT_EQ(bytes, written(icosphere(3), as_3mf()));
  const MeshFile file = read_text(bytes, "standard input");
  const auto as_float = [](const Vec3& p) { return Vec3{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)}; };
  EXPECT_EQ(triangles_of(file.soup), triangles_of(mapped(icosphere(3), as_float)));
  EXPECT_EQ(read_text(bytes, "a.stl").warnings, std::vector<std::string>{"read as 3MF, in spite of the name's suffix"});
}

TEST(ThreeMf, JoinsPointsAndLeavesOutFacetsThatRoundToNothing) {
  TriangleSoup soup = unwelded(cube());
  soup.points.insert(soup.points.end(), {{0, 0, 0}, {1e-60, 0, 0}, {0, 1, 0}});
  soup.facets.push_back({36, 37, 38});
  const MeshFile file = read_text(written(soup, as_3mf()), "test.3mf");
  EXPECT_EQ(file.soup.points.size(), 8u);
  EXPECT_EQ(triangles_of(file.soup), triangles_of(unwelded(cube())));
}

TEST(ThreeMf, ClosedGroupsBecomeObjectsAndOpenOnesDoNot) {
  TriangleSoup soup = merged(cube(), moved(cube(), {3, 0, 0}));
  soup.groups = {{"a & \"b\" <c>", 0, 12}, {"M\xc3\xbcll \xff", 12, 12}};
  const MeshFile two = read_text(written(soup, as_3mf()), "test.3mf");
  ASSERT_EQ(two.soup.groups.size(), 2u);
  EXPECT_EQ(two.soup.groups[0].name, "a & \"b\" <c>");
  EXPECT_EQ(two.soup.groups[1].name, "M\xc3\xbcll \xef\xbf\xbd");
  EXPECT_EQ(two.soup.groups[1].first_facet, 12u);
  EXPECT_EQ(triangles_of(two.soup), triangles_of(soup));
  soup.groups = {{"a", 0, 6}, {"b", 6, 18}};
  const MeshFile one = read_text(written(soup, as_3mf()), "test.3mf");
  EXPECT_TRUE(one.soup.groups.empty());
  EXPECT_EQ(triangles_of(one.soup), triangles_of(soup));
}

TEST(ThreeMf, KeepsColours) {
  TriangleSoup soup = cube();
  soup.colors.assign(12, kNoColor);
  soup.colors[3] = color_of(255, 10, 0);
  soup.colors[7] = color_of(1, 2, 3, 128);
  EXPECT_EQ(read_text(written(soup, as_3mf()), "test.3mf").soup.colors, soup.colors);
}

TEST(ThreeMf, RefusesWhatReadersDoNotTake) {
  for (const auto& [soup, text] : {std::pair{scaled(cube(), 2e9), "beyond the 1e9"}, std::pair{scaled(cube(), 1e-60), "no facet is left"}}) {
    try {
      written(soup, as_3mf());
      ADD_FAILURE() << text;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::unwritable_output);
      EXPECT_TRUE(contains(error.what(), {"test: ", text}));
    }
  }
}

TEST(ThreeMf, BrokenArchivesAreErrorsThatNameTheFile) {
  const std::string good = written(icosphere(1), as_3mf());
  EXPECT_TRUE(contains(read_error(good.substr(0, good.size() / 2), "cut.3mf"), {"cut.3mf: is a ZIP archive without its directory", "cut off"}));
  EXPECT_TRUE(contains(read_error("3D model", "text.3mf"), {"text.3mf: expected a ZIP archive, as every 3MF is, found "}));
  std::string other = good;
  for (std::size_t at; (at = other.find(".model")) != other.npos;) other.replace(at, 6, ".xhtml");
  EXPECT_TRUE(contains(read_error(other, "a.zip"), {"a.zip: is a ZIP archive, and no 3MF"}));
  for (std::size_t i = 0; i < good.size(); i += 3) {  // one byte turned over: an error, or a surface
    std::string bad = good;
    bad[i] = static_cast<char>(bad[i] ^ 0x55);
    const std::string error = read_error(bad, "bad.3mf");
    EXPECT_TRUE(error.empty() || error.starts_with("bad.3mf: ")) << i << ": " << error;
  }
}

}  // namespace
}  // namespace burnish
