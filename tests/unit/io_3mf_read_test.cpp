// 3MF of others: transforms, components, types, colours, units; and archives made to do harm.
#include <gtest/gtest.h>

#include <cstddef>
#include <string>
#include <vector>

#include "support/mesh_bytes.h"
#include "support/shapes.h"
#include "support/zip_bytes.h"

namespace burnish {
namespace {

using namespace test;

std::string model(const std::string& resources, const std::string& items, const std::string& unit = "millimeter") {
  return R"(<?xml version="1.0" encoding="UTF-8"?><model unit=")" + unit +
         R"(" xml:lang="en-US" xmlns="http://schemas.microsoft.com/3dmanufacturing/core/2015/02" xmlns:m="http://schemas.microsoft.com/3dmanufacturing/material/2015/02">)" +
         "<resources>" + resources + "</resources><build>" + items + "</build></model>";
}
std::string archive(const std::string& resources, const std::string& items, const std::string& unit = "millimeter") {
  return zip_of(parts_of_3mf(model(resources, items, unit)));
}

// The corner of the unit cube at the origin. `more`: attributes of the object; `of_facets`: of every triangle.
std::string corner(int id, const std::string& more = "", const std::string& of_facets = "") {
  std::string facets;
  for (const char* t : {R"(v1="0" v2="2" v3="1")", R"(v1="0" v2="1" v3="3")", R"(v1="0" v2="3" v3="2")", R"(v1="1" v2="2" v3="3")"})
    facets += std::string("<triangle ") + t + " " + of_facets + "/>";
  return "<object id=\"" + std::to_string(id) + "\" " + (more.find("type=") == more.npos ? "type=\"model\" " : "") + more +
         R"(><mesh><vertices><vertex x="0" y="0" z="0"/><vertex x="1" y="0" z="0"/><vertex x="0" y="1" z="0"/><vertex x="0" y="0" z="1"/></vertices><triangles>)" + facets +
         "</triangles></mesh></object>";
}
std::string components(int id, const std::string& list) { return "<object id=\"" + std::to_string(id) + "\" type=\"model\"><components>" + list + "</components></object>"; }
std::string component(int id, const std::string& transform = "") {
  return "<component objectid=\"" + std::to_string(id) + "\"" + (transform.empty() ? "" : " transform=\"" + transform + "\"") + "/>";
}
std::string item(int id, const std::string& transform = "") { return "<item objectid=\"" + std::to_string(id) + "\"" + (transform.empty() ? "" : " transform=\"" + transform + "\"") + "/>"; }

double volume(const TriangleSoup& soup) {
  double sum = 0;
  for (std::size_t f = 0; f < soup.facets.size(); ++f) sum += dot(soup.corner(f, 0), cross(soup.corner(f, 1), soup.corner(f, 2))) / 6;
  return sum;
}

// Rows of the matrix are what x, y and z become: p -> p M, and then the shift.
TEST(ThreeMfRead, ItemsArePlacedByTheirTransforms) {
  const TriangleSoup soup = read_text(archive(corner(1), item(1) + item(1, "0 2 0 -3 0 0 0 0 4 10 20 30")), "a.3mf").soup;
  ASSERT_EQ(soup.facets.size(), 8u);
  ASSERT_EQ(soup.points.size(), 8u);
  EXPECT_EQ(soup.points[4], (Vec3{10, 20, 30}));
  EXPECT_EQ(soup.points[5], (Vec3{10, 22, 30}));
  EXPECT_EQ(soup.points[6], (Vec3{7, 20, 30}));
  EXPECT_EQ(soup.points[7], (Vec3{10, 20, 34}));
  EXPECT_NEAR(volume(soup), (1 + 24.0) / 6, 1e-12);
}

TEST(ThreeMfRead, ComponentsArePlacedInsideOut) {
  const std::string resources = corner(1) + components(2, component(1, "2 0 0 0 2 0 0 0 2 1 0 0") + component(1)) + components(3, component(2, "0 1 0 -1 0 0 0 0 1 0 0 5"));
  const TriangleSoup soup = read_text(archive(resources, item(3, "1 0 0 0 1 0 0 0 1 100 0 0")), "a.3mf").soup;
  ASSERT_EQ(soup.points.size(), 8u);
  EXPECT_EQ(soup.points[0], (Vec3{100, 1, 5}));   // 0 0 0 -> 1 0 0 -> 0 1 5
  EXPECT_EQ(soup.points[1], (Vec3{100, 3, 5}));   // 1 0 0 -> 3 0 0 -> 0 3 5
  EXPECT_EQ(soup.points[2], (Vec3{98, 1, 5}));    // 0 1 0 -> 1 2 0 -> -2 1 5
  EXPECT_EQ(soup.points[4], (Vec3{100, 0, 5}));
  EXPECT_NEAR(volume(soup), (8 + 1.0) / 6, 1e-12);
}

TEST(ThreeMfRead, MirroredPartsStayOrientedOutwards) {
  EXPECT_NEAR(volume(read_text(archive(corner(1), item(1, "-1 0 0 0 1 0 0 0 1 0 0 0")), "a.3mf").soup), 1 / 6.0, 1e-12);
  const std::string twice = corner(1) + components(2, component(1, "1 0 0 0 -1 0 0 0 1 0 0 0"));
  EXPECT_NEAR(volume(read_text(archive(twice, item(2, "-1 0 0 0 1 0 0 0 1 0 0 0")), "a.3mf").soup), 1 / 6.0, 1e-12);
}

TEST(ThreeMfRead, OnlyModelsAreTaken) {
  for (const std::string type : {"support", "solidsupport", "surface", "other"}) {
    const MeshFile file = read_text(archive(corner(1) + corner(2, "type=\"" + type + "\""), item(1) + (type == "other" ? "" : item(2))), "a.3mf");
    EXPECT_EQ(file.soup.facets.size(), 4u) << type;
    const std::vector<std::string> told{"objects of type '" + type + "' left out: only 'model' is the part itself"};
    EXPECT_EQ(file.warnings, type == "other" ? std::vector<std::string>{} : told);
  }
  const std::string error = read_error(archive(corner(1, "type=\"support\""), item(1)), "s.3mf");
  EXPECT_TRUE(contains(error, {"s.3mf: "})) << error;
}

TEST(ThreeMfRead, ColoursOfGroupsAndMaterials) {
  const std::string group = R"(<m:colorgroup id="7"><m:color color="#FF8000"/><m:color color="#0000FF"/></m:colorgroup>)";
  const MeshFile whole = read_text(archive(group + corner(1, R"(pid="7" pindex="1")"), item(1)), "a.3mf");
  EXPECT_EQ(whole.soup.colors, std::vector<Color>(4, color_of(0, 0, 255)));
  const MeshFile each = read_text(archive(group + corner(1, "", R"(pid="7" p1="0")") + corner(2), item(1) + item(2)), "a.3mf");
  ASSERT_EQ(each.soup.colors.size(), 8u);
  EXPECT_EQ(each.soup.colors[3], color_of(255, 128, 0));
  EXPECT_EQ(each.soup.colors[4], kNoColor);
  const MeshFile changing = read_text(archive(group + corner(1, "", R"(pid="7" p1="0" p2="1" p3="1")"), item(1)), "a.3mf");
  ASSERT_FALSE(changing.warnings.empty());
  EXPECT_EQ(changing.warnings.back(), "colours that change within a facet: that of its first corner is taken");
  const std::string materials = R"(<basematerials id="5"><base name="red" displaycolor="#FF0000"/></basematerials>)";
  EXPECT_EQ(read_text(archive(materials + corner(1, R"(pid="5" pindex="0")"), item(1)), "a.3mf").soup.colors, std::vector<Color>(4, color_of(255, 0, 0)));
}

TEST(ThreeMfRead, Units) {
  const std::vector<std::pair<std::string, ModelUnit>> units{{"micron", ModelUnit::micrometre}, {"millimeter", ModelUnit::millimetre}, {"centimeter", ModelUnit::centimetre},
                                                             {"inch", ModelUnit::inch},        {"foot", ModelUnit::foot},             {"meter", ModelUnit::metre}};
  for (const auto& [text, unit] : units) EXPECT_EQ(read_text(archive(corner(1), item(1), text), "a.3mf").unit, unit) << text;
}

// --- made to do harm --------------------------------------------------------------------------------

TEST(ThreeMfRead, BombsAreRefused) {
  std::vector<ZipFile> files = parts_of_3mf(model(corner(1), item(1)));
  files.push_back({"3D/big.model", std::string(std::size_t{80} << 20, ' ')});
  EXPECT_TRUE(contains(read_error(zip_of(files), "bomb.3mf"), {"bomb.3mf: is a ZIP archive of ", " bytes that unpacks to more than 67108864 bytes"}));
  files.back().more_bytes = 10 - (std::int64_t{80} << 20);  // and says that it is small
  EXPECT_TRUE(contains(read_error(zip_of(files), "bomb.3mf"), {"bomb.3mf: is a ZIP archive of ", "unpacks to more than"}));
  files.back() = {"3D/small.model", "x", std::int64_t{4000000000}};  // or that it is large
  EXPECT_TRUE(contains(read_error(zip_of(files), "liar.3mf"), {"liar.3mf: is a ZIP archive whose file '3D/small.model' unpacks to 1 bytes, where the directory says 4000000001"}));
}

TEST(ThreeMfRead, FalseChecksumsAndMissingPartsAreErrors) {
  std::vector<ZipFile> files = parts_of_3mf(model(corner(1), item(1)));
  files[2].crc_change = 1;
  EXPECT_TRUE(read_error(zip_of(files), "crc.3mf").starts_with("crc.3mf: "));
  files[2].crc_change = 0;
  for (const std::size_t gone : {1u, 2u}) {
    std::vector<ZipFile> rest = files;
    rest.erase(rest.begin() + static_cast<std::ptrdiff_t>(gone));
    EXPECT_TRUE(read_error(zip_of(rest), "part.3mf").starts_with("part.3mf: ")) << gone;
  }
  EXPECT_TRUE(read_error(archive(corner(1), item(2)), "item.3mf").starts_with("item.3mf: "));
}

TEST(ThreeMfRead, EveryCutIsAnError) {
  const std::string whole = archive(corner(1), item(1));
  for (std::size_t size = 0; size < whole.size(); ++size) EXPECT_TRUE(read_error(whole.substr(0, size), "cut.3mf").starts_with("cut.3mf: ")) << size;
}

// Each level places the one before ten times: 10^12 corners of cubes.
TEST(ThreeMfRead, ComponentsDoNotExplode) {
  std::string resources = corner(1);
  for (int level = 2; level <= 13; ++level) {
    std::string ten;
    for (int i = 0; i < 10; ++i) ten += component(level - 1);
    resources += components(level, ten);
  }
  EXPECT_TRUE(contains(read_error(archive(resources, item(13)), "many.3mf"), {"many.3mf: places more than 1000000 objects: components refer to each other too often"}));
}

TEST(ThreeMfRead, ComponentsAreNoDeeperThan64) {
  const auto deep = [](int levels) {
    std::string resources = corner(1);
    for (int level = 2; level <= levels + 1; ++level) resources += components(level, component(level - 1));
    return archive(resources, item(levels + 1));
  };
  EXPECT_EQ(read_text(deep(60), "a.3mf").soup.facets.size(), 4u);
  EXPECT_TRUE(contains(read_error(deep(2000), "deep.3mf"), {"deep.3mf: has components in components more than 64 deep"}));
}

}  // namespace
}  // namespace burnish
