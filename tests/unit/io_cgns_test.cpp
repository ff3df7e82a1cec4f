// CGNS files, read back by the CGNS library.
#include <cgnslib.h>
#include <gtest/gtest.h>

#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <string>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/io/volume_files.h"
#include "support/folder.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

using test::Folder;
using test::mixed_cells;

class Reader {
 public:
  explicit Reader(const std::string& path) { EXPECT_EQ(cg_open(path.c_str(), CG_MODE_READ, &file_), CG_OK) << cg_get_error(); }
  ~Reader() { cg_close(file_); }
  Reader(const Reader&) = delete;
  Reader& operator=(const Reader&) = delete;

  std::array<cgsize_t, 3> size() const {
    std::array<char, 33> name{};
    std::array<cgsize_t, 3> size{};
    EXPECT_EQ(cg_zone_read(file_, 1, 1, name.data(), size.data()), CG_OK);
    return size;
  }
  std::vector<double> along(const char* axis) const {
    cgsize_t first = 1, last = size()[0];
    std::vector<double> values(static_cast<std::size_t>(last));
    EXPECT_EQ(cg_coord_read(file_, 1, 1, axis, RealDouble, &first, &last, values.data()), CG_OK);
    return values;
  }
  struct Section {
    ElementType_t type = ElementTypeNull;
    cgsize_t first = 0, last = 0;
    std::vector<cgsize_t> corners;
  };
  std::map<std::string, Section> sections() const {
    int count = 0;
    cg_nsections(file_, 1, 1, &count);
    std::map<std::string, Section> all;
    for (int i = 1; i <= count; ++i) {
      std::array<char, 33> name{};
      Section s;
      int boundary = 0, parent = 0;
      cgsize_t data = 0;
      EXPECT_EQ(cg_section_read(file_, 1, 1, i, name.data(), &s.type, &s.first, &s.last, &boundary, &parent), CG_OK);
      cg_ElementDataSize(file_, 1, 1, i, &data);
      s.corners.resize(static_cast<std::size_t>(data));
      EXPECT_EQ(cg_elements_read(file_, 1, 1, i, s.corners.data(), nullptr), CG_OK);
      all[name.data()] = s;
    }
    return all;
  }
  // Of each condition: its first and last element.
  std::map<std::string, std::array<cgsize_t, 2>> conditions() const {
    int count = 0;
    cg_nbocos(file_, 1, 1, &count);
    std::map<std::string, std::array<cgsize_t, 2>> all;
    for (int i = 1; i <= count; ++i) {
      std::array<char, 33> name{};
      BCType_t type{};
      PointSetType_t set{};
      cgsize_t points = 0, normals = 0;
      int normal = 0, sets = 0;
      DataType_t data{};
      EXPECT_EQ(cg_boco_info(file_, 1, 1, i, name.data(), &type, &set, &points, &normal, &normals, &data, &sets), CG_OK);
      EXPECT_EQ(type, FamilySpecified);
      EXPECT_EQ(set, PointRange);
      cg_boco_read(file_, 1, 1, i, all[name.data()].data(), nullptr);
    }
    return all;
  }

 private:
  int file_ = 0;
};

VolumeMesh with_patches(VolumeMesh mesh) {
  PolyhedralMesh& m = mesh.mesh;
  const std::uint32_t first = static_cast<std::uint32_t>(m.internal_faces()), faces = static_cast<std::uint32_t>(m.faces()) - first;
  m.patches = {{std::string(40, 'a') + "1", "wall", first, 3}, {std::string(40, 'a') + "2", "patch", first + 3, faces - 3}};
  return mesh;
}

TEST(Cgns, HasTheMesh) {
  const Folder folder;
  const VolumeMesh mesh = with_patches(mixed_cells(false));
  write_volume_mesh(folder.path("m.cgns"), mesh);
  const Reader file(folder.path("m.cgns"));
  EXPECT_EQ(file.size(), (std::array<cgsize_t, 3>{static_cast<cgsize_t>(mesh.mesh.points.size()), static_cast<cgsize_t>(mesh.cells()), 0}));
  const std::vector<double> x = file.along("CoordinateX"), z = file.along("CoordinateZ");
  for (std::size_t p = 0; p < x.size(); ++p) EXPECT_TRUE(x[p] == mesh.mesh.points[p].x && z[p] == mesh.mesh.points[p].z);
  auto sections = file.sections();
  EXPECT_EQ(sections["Tetrahedra"].type, TETRA_4);
  EXPECT_EQ(sections["Prisms"].type, PENTA_6);
  EXPECT_EQ(sections["Pyramids"].last - sections["Pyramids"].first + 1, 5);
  EXPECT_EQ(sections["Hexahedra"].corners.size(), 16u);
}

// A cell's volume is positive in the order of corners that the standard gives: the first face's normal into the cell.
TEST(Cgns, CornersAreInTheStandardsOrder) {
  const Folder folder;
  const VolumeMesh mesh = mixed_cells(false);
  write_volume_mesh(folder.path("m.cgns"), mesh);
  for (const auto& [name, s] : Reader(folder.path("m.cgns")).sections()) {
    const std::size_t n = s.type == TETRA_4 ? 4 : s.type == PYRA_5 ? 5 : s.type == PENTA_6 ? 6 : s.type == HEXA_8 ? 8 : 0;
    for (std::size_t i = 0; n > 0 && i < s.corners.size(); i += n) {
      const auto at = [&](std::size_t k) { return mesh.mesh.points[static_cast<std::size_t>(s.corners[i + k]) - 1]; };
      const std::size_t above = n == 4 ? 3 : n == 5 ? 4 : n == 6 ? 3 : 4;
      EXPECT_GT(dot(cross(at(1) - at(0), at(2) - at(0)), at(above) - at(0)), 0) << name;
    }
  }
}

TEST(Cgns, PatchesAreConditionsOnTheirFaces) {
  const Folder folder;
  const VolumeMesh mesh = with_patches(mixed_cells(false));
  write_volume_mesh(folder.path("m.cgns"), mesh);
  const auto conditions = Reader(folder.path("m.cgns")).conditions();
  ASSERT_EQ(conditions.size(), 2u);  // though their names are the same where they are cut
  cgsize_t next = static_cast<cgsize_t>(mesh.cells()) + 1;
  for (const char* name : {"aaaaaaaaaaaaaaaaaaaaaaaaaaa", "aaaaaaaaaaaaaaaaaaaaaaaaa_2"}) {
    ASSERT_TRUE(conditions.contains(name)) << conditions.begin()->first;
    EXPECT_EQ(conditions.at(name)[0], next);
    next = conditions.at(name)[1] + 1;
  }
  EXPECT_EQ(next, static_cast<cgsize_t>(mesh.cells() + mesh.mesh.faces() - mesh.mesh.internal_faces()) + 1);
}

// Families are beside the zone, sections beside what else a zone has.
TEST(Cgns, PatchesDoNotTakeNamesOfOtherNodes) {
  const Folder folder;
  for (const char* name : {"Zone", "Base", "ZoneBC", "ZoneType", "GridCoordinates", "Tetrahedra", "Hexahedra", "FamilyName"}) {
    VolumeMesh mesh = with_patches(mixed_cells(false));
    mesh.mesh.patches[0].name = name, mesh.mesh.patches[1].name = std::string(name) + "_Tri";
    write_volume_mesh(folder.path("m.cgns"), mesh);
    const auto conditions = Reader(folder.path("m.cgns")).conditions();
    ASSERT_EQ(conditions.size(), 2u) << name;
    EXPECT_TRUE(conditions.contains(std::string(name) + "_2") && conditions.contains(std::string(name) + "_Tri")) << conditions.begin()->first;
  }
}

TEST(Cgns, NamesEndWithAWholeCharacter) {
  const Folder folder;
  VolumeMesh mesh = with_patches(mixed_cells(false));
  std::string in_twos = "x", in_threes;
  for (int i = 0; i < 20; ++i) in_twos += "\xc3\xbc", in_threes += "\xe2\x82\xac";
  mesh.mesh.patches[0].name = "x" + in_twos, mesh.mesh.patches[1].name = "yy" + in_threes;
  write_volume_mesh(folder.path("m.cgns"), mesh);
  const auto conditions = Reader(folder.path("m.cgns")).conditions();
  ASSERT_EQ(conditions.size(), 2u);
  EXPECT_TRUE(conditions.contains("x" + in_twos.substr(0, 25)));
  EXPECT_TRUE(conditions.contains("yy" + in_threes.substr(0, 24)));
}

// No folder of the user's is in the way of the file that the library makes, and the one beside a link is not its folder.
TEST(Cgns, IsMadeBesideTheFileThatALinkStandsFor) {
  namespace fs = std::filesystem;
  const Folder folder;
  fs::create_directory(folder.path("m.cgns.cgns"));
  fs::create_directory(folder.path("real"));
  std::ofstream(folder.path("real/m.cgns")) << "old";
  fs::create_symlink("real/m.cgns", folder.path("m.cgns"));
  const VolumeMesh mesh = with_patches(mixed_cells(false));
  fs::permissions(folder.path(""), fs::perms::owner_write, fs::perm_options::remove);
  write_volume_mesh(folder.path("m.cgns"), mesh);
  fs::permissions(folder.path(""), fs::perms::owner_write, fs::perm_options::add);
  EXPECT_TRUE(fs::is_symlink(folder.path("m.cgns")));
  EXPECT_EQ(Reader(folder.path("real/m.cgns")).size()[1], static_cast<cgsize_t>(mesh.cells()));
  EXPECT_EQ(folder.file_count(), 3);
  EXPECT_EQ(std::distance(fs::directory_iterator(folder.path("real")), {}), 1);
}

TEST(Cgns, SaysWhatItHasNoCellsFor) {
  const Folder folder;
  try {
    write_volume_mesh(folder.path("m.cgns"), mixed_cells(true));
    FAIL();
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::usage);
  }
  EXPECT_EQ(folder.file_count(), 0);
}

}  // namespace
}  // namespace burnish
