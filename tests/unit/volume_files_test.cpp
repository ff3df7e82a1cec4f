// Volume meshes as files: read back to what was written, nothing of another mesh left, and nothing half-written.
#include "burnish/io/volume_files.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <sstream>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "support/elements.h"
#include "support/folder.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;
using test::Folder;
using test::mixed_cells;

const FoamFormat kFormats[] = {{false, false, 4, 8}, {false, true, 4, 8}, {true, false, 4, 8}, {true, false, 8, 8}, {true, true, 4, 8}, {true, true, 8, 8}, {true, false, 4, 4}};

// Coordinates with as many digits as there are.
VolumeMesh with_long_digits(VolumeMesh mesh) {
  for (Vec3& p : mesh.mesh.points) p = {p.x / 3 - 0.1, p.y * 0.7 + 1e-9, p.z * 1.1 + 1000.0 / 7};
  return mesh;
}
constexpr double kScale = 0.7 * 1.1 / 3;  // of volumes

std::string message_of(const std::function<void()>& run, ErrorCode code) {
  try {
    run();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), code) << error.what();
    return std::string(error.what()) + " | " + error.hint();
  }
  ADD_FAILURE() << "no error";
  return {};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

void put(const std::string& path, const std::string& text) {
  fs::create_directories(fs::path(path).parent_path());
  std::ofstream(path, std::ios::binary) << text;
}

std::set<std::string> names_in(const std::string& folder) {
  std::set<std::string> names;
  for (const auto& entry : fs::directory_iterator(folder)) names.insert(entry.path().filename().string());
  return names;
}

// Everything in a folder, by its relative path.
std::map<std::string, std::string> contents(const std::string& folder) {
  std::map<std::string, std::string> all;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    std::ifstream in(entry.path(), std::ios::binary);
    all[fs::relative(entry.path(), folder).string()] = entry.is_directory() ? "folder" : std::string(std::istreambuf_iterator<char>(in), {});
  }
  return all;
}

void expect_equal(const PolyhedralMesh& a, const PolyhedralMesh& b, bool in_float) {
  EXPECT_EQ(a.cells, b.cells);
  EXPECT_EQ(a.face_start, b.face_start);
  EXPECT_EQ(a.face_points, b.face_points);
  EXPECT_EQ(a.owner, b.owner);
  EXPECT_EQ(a.neighbour, b.neighbour);
  ASSERT_EQ(a.points.size(), b.points.size());
  for (std::size_t p = 0; p < a.points.size(); ++p)
    for (int axis = 0; axis < 3; ++axis) EXPECT_EQ(a.points[p][axis], in_float ? static_cast<double>(static_cast<float>(b.points[p][axis])) : b.points[p][axis]);
  ASSERT_EQ(a.patches.size(), b.patches.size());
  for (std::size_t i = 0; i < a.patches.size(); ++i) {
    EXPECT_EQ(a.patches[i].name, b.patches[i].name);
    EXPECT_EQ(a.patches[i].type, b.patches[i].type);
    EXPECT_EQ(a.patches[i].first_face, b.patches[i].first_face);
    EXPECT_EQ(a.patches[i].faces, b.patches[i].faces);
  }
}

TEST(VolumeFiles, PathsSayTheFormat) {
  const Folder folder;
  EXPECT_EQ(volume_format("a.vtu"), VolumeFormat::vtu);
  EXPECT_EQ(volume_format("b/a.MSH"), VolumeFormat::msh);
  EXPECT_EQ(volume_format("a.b.su2"), VolumeFormat::su2);
  EXPECT_EQ(volume_format("cases/wing"), VolumeFormat::foam_case);
  EXPECT_EQ(volume_format("cases.old/wing"), VolumeFormat::foam_case);
  EXPECT_EQ(volume_format("wing.v2/"), VolumeFormat::foam_case);
  EXPECT_EQ(volume_format("."), VolumeFormat::foam_case);
  fs::create_directory(folder.path("wing.v2"));
  EXPECT_EQ(volume_format(folder.path("wing.v2")), VolumeFormat::foam_case);
  const std::string message = message_of([] { volume_format("a.stl"); }, ErrorCode::usage);
  for (const char* name : {".vtu", ".msh", ".su2", "OpenFOAM"}) EXPECT_TRUE(contains(message, name)) << message;
}

TEST(FoamCase, IsReadBackBitForBitInEveryFormat) {
  for (const bool with_polyhedron : {false, true})
    for (const FoamFormat& format : kFormats) {
      const Folder folder;
      const VolumeMesh mesh = with_long_digits(mixed_cells(with_polyhedron));
      write_volume_mesh(folder.path("case"), mesh, {.foam = format});
      const FoamMesh read = read_foam_mesh(folder.path("case"));
      expect_equal(read.mesh, mesh.mesh, format.scalar_bytes == 4);
      EXPECT_EQ(read.format.binary, format.binary);
      EXPECT_EQ(read.format.compressed, format.compressed);
      EXPECT_EQ(read.format.label_bytes, format.label_bytes);
    }
}

TEST(FoamCase, HasNoFacesInsideOfOneCell) {
  const Folder folder;
  VolumeMesh mesh = test::hexahedral_volume({{0, 0, 0}, {1, 1, 1}, 1, 1, 1});
  for (const bool binary : {false, true}) {
    write_volume_mesh(folder.path("case"), mesh, {.foam{.binary = binary}});
    expect_equal(read_foam_mesh(folder.path("case")).mesh, mesh.mesh, false);
  }
}

TEST(FoamCase, HeadersSayWhatOpenFoamLooksFor) {
  const Folder folder;
  const VolumeMesh mesh = mixed_cells(true);
  write_foam_case(folder.path("case"), mesh);
  const std::string owner = folder.bytes("case/constant/polyMesh/owner"), boundary = folder.bytes("case/constant/polyMesh/boundary");
  EXPECT_TRUE(contains(owner, "arch        \"LSB;label=32;scalar=64\";"));
  EXPECT_TRUE(contains(owner, "note        \"nPoints:" + std::to_string(mesh.mesh.points.size()) + "  nCells:12  nFaces:" + std::to_string(mesh.mesh.faces()) +
                                  "  nInternalFaces:" + std::to_string(mesh.mesh.internal_faces()) + "\";"));
  EXPECT_TRUE(contains(folder.bytes("case/constant/polyMesh/faces"), "class       faceCompactList;"));
  EXPECT_TRUE(contains(boundary, "floor\n    {\n        type            wall;\n        inGroups        1(wall);"));
  EXPECT_TRUE(contains(boundary, "xMin\n    {\n        type            patch;\n        nFaces"));
}

TEST(FoamCase, NamesOfPatchesBecomeWords) {
  const Folder folder;
  VolumeMesh mesh = mixed_cells(false);
  const char* names[] = {"a b", "a;b", "2nd \"part\"", ""};
  for (std::size_t i = 0; i < 4; ++i) mesh.mesh.patches[i].name = names[i];
  write_foam_case(folder.path("case"), mesh);
  std::vector<std::string> read;
  for (const MeshPatch& p : read_foam_mesh(folder.path("case")).mesh.patches) read.push_back(p.name);
  EXPECT_EQ(read, (std::vector<std::string>{"a_b", "a_b_2", "_2nd__part_", "_"}));
}

TEST(FoamCase, GetsFilesOnlyWhereItHasNone) {
  const Folder folder;
  put(folder.path("case/0/U"), "mine");
  write_foam_case(folder.path("case"), mixed_cells(false));
  EXPECT_EQ(folder.bytes("case/0/U"), "mine");
  for (const char* name : {"0/p", "constant/transportProperties", "constant/turbulenceProperties", "system/controlDict", "system/fvSchemes", "system/fvSolution"})
    EXPECT_TRUE(folder.has(std::string("case/") + name)) << name;
  EXPECT_EQ(start_time_folder(folder.path("case")), "0");
  // A case of somebody's own gets a mesh and nothing else.
  put(folder.path("own/system/controlDict"), "FoamFile {} application interFoam;");
  write_foam_case(folder.path("own"), mixed_cells(false));
  EXPECT_EQ(names_in(folder.path("own")), (std::set<std::string>{"constant", "system"}));
  EXPECT_EQ(names_in(folder.path("own/system")), (std::set<std::string>{"controlDict"}));
  EXPECT_EQ(names_in(folder.path("own/constant")), (std::set<std::string>{"polyMesh"}));
}

class OldCase : public ::testing::Test {
 protected:
  OldCase() {
    write_foam_case(folder_.path("case"), test::hexahedral_volume({{0, 0, 0}, {1, 1, 1}, 3, 2, 2}), {.foam{.compressed = true}});
    for (const char* name : {"constant/polyMesh/cellZones", "constant/polyMesh/sets/bad", "constant/polyMesh/cellLevel.gz", "constant/polyMesh/refinementHistory", "1/polyMesh/points", "1/polyMesh/faces"})
      put(folder_.path(std::string("case/") + name), "of another mesh");
    put(folder_.path("case/constant/polyMesh/blockMeshDict"), "mine");
    put(folder_.path("case/1/U"), "a result");
  }
  Folder folder_;
};

TEST_F(OldCase, IsAnErrorUnlessItIsToBeReplaced) {
  const auto before = contents(folder_.path("case"));
  const std::string message = message_of([&] { write_foam_case(folder_.path("case"), mixed_cells(false), {.overwrite = false}); }, ErrorCode::unwritable_output);
  EXPECT_TRUE(contains(message, "polyMesh/") && contains(message, "--overwrite")) << message;
  EXPECT_EQ(contents(folder_.path("case")), before);
  // Leftovers of a mesh are enough, and so is a mesh in a time folder.
  for (const char* name : {"sets/bad", "cellZones"}) {
    put(folder_.path(std::string("other/constant/polyMesh/") + name), "");
    message_of([&] { write_foam_case(folder_.path("other"), mixed_cells(false), {.overwrite = false}); }, ErrorCode::unwritable_output);
    fs::remove_all(folder_.path("other"));
  }
  put(folder_.path("other/0.5/polyMesh/points"), "");
  message_of([&] { write_foam_case(folder_.path("other"), mixed_cells(false), {.overwrite = false}); }, ErrorCode::unwritable_output);
  fs::remove_all(folder_.path("other"));
  put(folder_.path("other/constant/polyMesh/blockMeshDict"), "mine");
  write_foam_case(folder_.path("other"), mixed_cells(false), {.overwrite = false});
  EXPECT_EQ(folder_.bytes("other/constant/polyMesh/blockMeshDict"), "mine");
}

TEST_F(OldCase, LeavesNothingOfItsMesh) {
  const VolumeMesh mesh = mixed_cells(true);
  write_foam_case(folder_.path("case"), mesh);
  EXPECT_EQ(names_in(folder_.path("case/constant/polyMesh")), (std::set<std::string>{"points", "faces", "owner", "neighbour", "boundary", "blockMeshDict"}));
  EXPECT_EQ(names_in(folder_.path("case/constant")), (std::set<std::string>{"polyMesh", "transportProperties", "turbulenceProperties"}));
  EXPECT_EQ(folder_.bytes("case/constant/polyMesh/blockMeshDict"), "mine");
  EXPECT_EQ(names_in(folder_.path("case/1")), (std::set<std::string>{"U"}));
  expect_equal(read_foam_mesh(folder_.path("case"), "1").mesh, mesh.mesh, false);
}

TEST_F(OldCase, MayBeALinkToAFolder) {
  fs::rename(folder_.path("case/constant/polyMesh"), folder_.path("elsewhere"));
  fs::create_directory_symlink(folder_.path("elsewhere"), folder_.path("case/constant/polyMesh"));
  const VolumeMesh mesh = mixed_cells(true);
  write_foam_case(folder_.path("case"), mesh);
  EXPECT_TRUE(fs::is_symlink(folder_.path("case/constant/polyMesh")));
  EXPECT_EQ(names_in(folder_.path("elsewhere")), (std::set<std::string>{"points", "faces", "owner", "neighbour", "boundary", "blockMeshDict"}));
  expect_equal(read_foam_mesh(folder_.path("case")).mesh, mesh.mesh, false);
}

// Asks to stop at the n-th look.
class StopAt : public Progress {
 public:
  explicit StopAt(int n) : left_(n) {}
  bool cancelled() const override { return left_-- <= 0; }

 private:
  mutable int left_;
};

TEST_F(OldCase, StaysWholeWhenStopped) {
  const auto before = contents(folder_.path("case"));
  for (int n = 0; n < 5; ++n) {
    StopAt stop(n);
    message_of([&] { write_foam_case(folder_.path("case"), mixed_cells(true), {}, stop); }, ErrorCode::interrupted);
    EXPECT_EQ(contents(folder_.path("case")), before) << n;
  }
}

TEST(VolumeFiles, LeaveNothingHalfWritten) {
  const Folder folder;
  const VolumeMesh mesh = mixed_cells(false);
  for (const char* name : {"a.vtu", "a.msh", "a.su2"}) {
    StopAt stop(0);
    message_of([&] { write_volume_mesh(folder.path(name), mesh, {}, stop); }, ErrorCode::interrupted);
    EXPECT_EQ(folder.file_count(), 0) << name;
  }
  for (int n = 0; n < 3; ++n) {
    StopAt stop(n);
    message_of([&] { write_foam_case(folder.path("new/case"), mesh, {}, stop); }, ErrorCode::interrupted);
    EXPECT_FALSE(std::filesystem::exists(folder.path("new"))) << n;
  }
  put(folder.path("a.su2"), "mine");
  message_of([&] { write_volume_mesh(folder.path("a.su2"), mesh, {.overwrite = false}); }, ErrorCode::unwritable_output);
  EXPECT_EQ(folder.bytes("a.su2"), "mine");
}

TEST(VolumeFiles, PolyhedraAreRefusedWhereTheFormatHasNone) {
  const Folder folder;
  for (const char* name : {"a.msh", "a.su2"}) {
    const std::string message = message_of([&] { write_volume_mesh(folder.path(name), mixed_cells(true)); }, ErrorCode::usage);
    EXPECT_TRUE(contains(message, "1 polyhedra") && contains(message, ".vtu")) << message;
  }
  message_of([&] { write_msh(folder.path("a.msh"), mixed_cells(false), {.msh_version = 40}); }, ErrorCode::usage);
  EXPECT_EQ(folder.file_count(), 0);
}

TEST(VolumeFiles, AreTheSameForAnyNumberOfThreads) {
  const VolumeMesh mesh = test::hexahedral_volume({{0, 0, 0}, {1, 1, 1}, 20, 25, 30});
  for (const char* name : {"a.vtu", "a.msh", "a.su2"}) {
    const Folder folder;
    std::string bytes[2];
    for (const int threads : {1, 4}) {
      const ThreadLimit limit(threads);
      write_volume_mesh(folder.path(name), mesh);
      bytes[threads == 4] = folder.bytes(name);
    }
    EXPECT_EQ(bytes[0], bytes[1]) << name;
  }
}

// --- Elements: 11 cells of four shapes, 25 faces on the boundary

const std::map<int, int> kCounts{{4, 2}, {5, 2}, {6, 2}, {7, 5}};

void expect_mixed_cells(const test::ElementMesh& read, const VolumeMesh& mesh) {
  ASSERT_EQ(read.points.size(), mesh.mesh.points.size());
  for (std::size_t p = 0; p < read.points.size(); ++p)
    for (int a = 0; a < 3; ++a) EXPECT_EQ(read.points[p][a], mesh.mesh.points[p][a]);
  std::map<int, int> counts;
  double volume = 0;
  for (const test::Element& e : read.elements) {
    if (e.group != "fluid") continue;
    ++counts[e.type];
    // Every tetrahedron of it, in the order that gmsh says.
    for (const double v : test::tetrahedra_volumes(read, e)) EXPECT_GT(v, 0) << e.type;
    for (const double v : test::tetrahedra_volumes(read, e)) volume += v;
  }
  EXPECT_EQ(counts, kCounts);
  EXPECT_NEAR(volume, 4 * kScale, 1e-12);
  // Each patch with its faces, normals outwards.
  std::map<std::string, Vec3> areas;
  for (const MeshPatch& patch : mesh.mesh.patches) {
    std::size_t n = 0;
    Vec3 area;
    for (const test::Element& e : read.elements)
      if (e.group == patch.name) ++n, area += test::area_vector(read, e);
    EXPECT_EQ(n, patch.faces) << patch.name;
    areas[patch.name] = area;
  }
  EXPECT_NEAR(areas["floor"].z, -3 * 0.7 / 3, 1e-12);
  EXPECT_NEAR(areas["xMin"].x, -2 * 0.7 * 1.1, 1e-12);
  EXPECT_NEAR(areas["xMax"].x, 0.7 * 1.1, 1e-12);
}

// "wall" is OpenFOAM's group of all walls, "fluid" what the cells of a .msh are called.
TEST(VolumeFiles, PatchesDoNotTakeNamesOfGroups) {
  const Folder folder;
  VolumeMesh mesh = mixed_cells(false);
  mesh.mesh.patches[0].name = "wall", mesh.mesh.patches[0].type = "patch";
  mesh.mesh.patches[3].name = "fluid";
  write_volume_mesh(folder.path("case"), mesh);
  const FoamMesh read = read_foam_mesh(folder.path("case"));
  EXPECT_EQ(read.mesh.patches[0].name, "wall_2");
  EXPECT_EQ(read.mesh.patches[3].name, "fluid");
  for (const int version : {22, 41}) {
    write_msh(folder.path("a.msh"), mesh, {.msh_version = version});
    const std::string bytes = folder.bytes("a.msh"), names = bytes.substr(0, bytes.find("$EndPhysicalNames"));
    EXPECT_TRUE(contains(names, "2 1 \"wall_2\"") && contains(names, "2 4 \"fluid\"") && contains(names, "3 5 \"fluid_2\"")) << names;
  }
}

TEST(VolumeFiles, RequiredToBeWritableLeaveNothing) {
  const Folder folder;
  for (const char* name : {"new/case", "a.vtu", "a.msh"}) require_writable(folder.path(name));
  EXPECT_EQ(folder.file_count(), 0);
  put(folder.path("file"), "mine");
  for (const char* name : {"file/case", "no/a.vtu"}) message_of([&] { require_writable(folder.path(name)); }, ErrorCode::unwritable_output);
  write_volume_mesh(folder.path("case"), mixed_cells(false));
  const auto before = contents(folder.path("case"));
  require_writable(folder.path("case"), {.overwrite = true});
  const std::string message = message_of([&] { require_writable(folder.path("case"), {.overwrite = false}); }, ErrorCode::unwritable_output);
  EXPECT_TRUE(contains(message, "--overwrite")) << message;
  EXPECT_EQ(contents(folder.path("case")), before);
}

TEST(Su2, IsReadBack) {
  const Folder folder;
  const VolumeMesh mesh = with_long_digits(mixed_cells(false));
  write_volume_mesh(folder.path("a.su2"), mesh);
  expect_mixed_cells(test::read_su2(folder.path("a.su2")), mesh);
}

TEST(Msh, Version22IsReadBack) {
  const Folder folder;
  const VolumeMesh mesh = with_long_digits(mixed_cells(false));
  write_msh(folder.path("a.msh"), mesh, {.msh_version = 22});
  expect_mixed_cells(test::read_msh22(folder.path("a.msh")), mesh);
}

TEST(Msh, Version41IsReadBack) {
  const Folder folder;
  const VolumeMesh mesh = with_long_digits(mixed_cells(false));
  write_msh(folder.path("a.msh"), mesh);
  expect_mixed_cells(test::read_msh41(folder.path("a.msh")), mesh);
}

}  // namespace
}  // namespace burnish
