// OpenFOAM's own checkMesh on random meshes: it prints what mesh_quality measured, to all of its digits, and fails as many checks.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <regex>

#include "burnish/volume/mesh_quality.h"
#include "support/foam_files.h"
#include "support/folder.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

using test::cubic_grid;
using test::Folder;

// Debian's programs do not know their own place.
constexpr const char* kEnvironment = "WM_PROJECT_DIR=${WM_PROJECT_DIR:-/usr/share/openfoam} ";

bool has_check_mesh() { return std::system("command -v checkMesh > /dev/null 2>&1") == 0; }

void write_dictionary(const Folder& folder, const std::string& name, const std::string& text) {
  std::ofstream(folder.path("case/system/" + name)) << "FoamFile { version 2.0; format ascii; class dictionary; object " << name << "; }\n" << text;
}

// What checkMesh says of a mesh.
std::string checked(const PolyhedralMesh& mesh, const std::string& options) {
  Folder folder;
  test::PolyMeshWriter(folder.path("case/constant/polyMesh"), FoamFormat{true, false, 4, 8}).write(mesh);
  std::filesystem::create_directories(folder.path("case/system"));
  write_dictionary(folder, "controlDict", "startFrom startTime; startTime 0; stopAt endTime; endTime 1; deltaT 1; writeControl timeStep; writeInterval 1;\n");
  write_dictionary(folder, "fvSchemes", "gradSchemes {} divSchemes {} laplacianSchemes {}\n");
  write_dictionary(folder, "fvSolution", "");
  const std::string command = kEnvironment + ("checkMesh -constant -case " + folder.path("case") + " " + options + " > " + folder.path("said") + " 2>&1");
  if (std::system(command.c_str()) != 0) return "checkMesh failed\n" + folder.bytes("said");
  return folder.bytes("said");
}

// The number after `before` (a regular expression), or `otherwise`.
double number(const std::string& said, const std::string& before, double otherwise) {
  std::smatch match;
  return std::regex_search(said, match, std::regex(before + "([-+0-9.e]*[0-9])")) ? std::stod(match[1]) : otherwise;
}

double printed(double value) { return std::stod(fmt::format("{:.6g}", value)); }

// checkMesh prints six digits; the last may be rounded the other way where sums are added up in another order. What is nothing but rounding is below 1e-12.
void expect_printed(const std::string& said, const std::string& before, double ours, double otherwise = std::nan("")) {
  const double theirs = number(said, before, otherwise);
  EXPECT_NEAR(theirs, printed(ours), 1.01e-5 * std::fabs(theirs) + 1e-12) << before;
}

void expect_statistics_of_faces_between_cells(const std::string& said, const MeshQuality& q) {
  expect_printed(said, "non-orthogonality Max: ", q.check("non-orthogonality").worst);
  expect_printed(said, "non-orthogonality Max: \\S+ average: ", q.check("non-orthogonality").mean);
  expect_printed(said, "interpolation weight : minimum: ", q.check("weight").worst);
  expect_printed(said, "interpolation weight : minimum: \\S+ average: ", q.check("weight").mean);
  expect_printed(said, "volume ratio : minimum: ", q.check("volume ratio").worst);
  expect_printed(said, "volume ratio : minimum: \\S+ average: ", q.check("volume ratio").mean);
}

void expect_statistics_of_volumes(const std::string& said, const MeshQuality& q) {
  const MeshCheck& check = q.check("cell volume");
  if (check.worst < 0) return expect_printed(said, "Minimum negative volume: ", check.worst);
  expect_printed(said, "Min volume = ", check.worst);
  expect_printed(said, "Max volume = ", check.best);
  expect_printed(said, "Total volume = ", q.volume);
}

void expect_same_statistics(const std::string& said, const MeshQuality& q) {
  if (q.internal_faces > 0) expect_statistics_of_faces_between_cells(said, q);
  expect_statistics_of_volumes(said, q);
  expect_printed(said, "Max skewness = ", std::max(q.check("skewness").worst, q.check("boundary skewness").worst));
  expect_printed(said, "[Aa]spect ratio(?: =|:) ", q.check("aspect ratio").worst);
  expect_printed(said, "Minimum face area = ", q.check("face area").worst);
  expect_printed(said, "Maximum face area = ", q.check("face area").best);
  expect_printed(said, "Min/max edge length = ", q.check("edge length").worst);
  expect_printed(said, "wellposedness\\) : minimum: ", q.check("determinant").worst);
  expect_printed(said, "wellposedness\\) : minimum: \\S+ average: ", q.check("determinant").mean);
  if (q.check("flatness").measured == 0) return;
  expect_printed(said, "butterfly\\) : min = ", q.check("flatness").worst);
  expect_printed(said, "butterfly\\) : min = \\S+\\s+average = ", q.check("flatness").mean);
}

void expect_same_counts(const std::string& said, const MeshQuality& q) {
  const auto failing = [&](const char* name) { return static_cast<double>(q.check(name).failing); };
  EXPECT_EQ(number(said, "severely non-orthogonal .*faces: ", 0) + number(said, "non-orthogonality errors: ", 0), failing("non-orthogonality"));
  EXPECT_EQ(number(said, "Max skewness = \\S+, ", 0), failing("skewness") + failing("boundary skewness"));
  EXPECT_EQ(number(said, "Number of negative volume cells: ", 0), failing("cell volume"));
  EXPECT_EQ(number(said, "Writing (?=\\d+ faces with incorrect orientation)", 0), failing("face pyramids"));
  EXPECT_EQ(number(said, "Writing (?=\\d+ faces with low quality)", 0), failing("face tetrahedra"));
  EXPECT_EQ(number(said, "There are (?=\\d+ faces with concave angles)", 0), failing("concave faces"));
  expect_printed(said, "Max concave angle = ", q.check("concave faces").worst, 0);
  EXPECT_EQ(number(said, "There are (?=\\d+ faces with ratio)", 0), failing("flatness"));
  EXPECT_EQ(number(said, "small determinant .*cells: ", 0), failing("determinant"));
  EXPECT_EQ(number(said, "Concave cells .*cells: ", 0), failing("concave cells"));
  EXPECT_EQ(number(said, "small interpolation weight .*faces: ", 0), failing("weight"));
  EXPECT_EQ(number(said, "small volume ratio .*faces: ", 0), failing("volume ratio"));
  EXPECT_EQ(number(said, "Open cells found, number of cells: ", 0), failing("zip-up"));
  EXPECT_EQ(number(said, "Number of regions: ", 0), q.regions);
}

// What "Mesh OK" and "Failed N mesh checks" say; -1: neither.
double failed(const std::string& said) { return said.find("Mesh OK") != said.npos ? 0 : number(said, "Failed (?=\\d+ mesh)", -1); }

void expect_the_same(const PolyhedralMesh& mesh) {
  const MeshQuality q = mesh_quality(mesh);
  const std::string said = checked(mesh, "-allTopology -allGeometry");
  expect_same_statistics(said, q);
  expect_same_counts(said, q);
  EXPECT_EQ(failed(said), q.failed) << said;
  EXPECT_EQ(failed(checked(mesh, "")), q.plain_failed);
}

class CheckMesh : public testing::Test {
 protected:
  void SetUp() override {
    if (!has_check_mesh()) GTEST_SKIP() << "no checkMesh (OpenFOAM)";
  }
};

TEST_F(CheckMesh, SaysTheSameOfWarpedHexahedra) {
  const auto grid = cubic_grid({-1, 0, 2}, {1, 2, 4}, 9);
  for (const double by : {0.0, 0.2, 0.45, 0.75}) {
    SCOPED_TRACE(fmt::format("moved by {}, seed 7", by));
    expect_the_same(test::jittered(test::hexahedra(grid), grid, by, 7));
  }
}

TEST_F(CheckMesh, SaysTheSameOfTetrahedra) {
  const auto grid = cubic_grid({0, 0, 0}, {1, 1, 1}, 7);
  for (const double by : {0.0, 0.15, 0.4}) {
    SCOPED_TRACE(fmt::format("moved by {}, seed 3", by));
    expect_the_same(test::jittered(test::kuhn_tetrahedra(grid), grid, by, 3));
  }
}

TEST_F(CheckMesh, SaysTheSameOfLevelJumpsAndPolyhedra) {
  expect_the_same(test::two_levels(cubic_grid({0, 0, 0}, {3, 3, 3}, 6), [](const Vec3& p) { return p.x + 0.5 * p.y < 1.6; }));
  for (const double by : {0.1, 0.4}) expect_the_same(test::dual_polyhedra(cubic_grid({0, 0, 0}, {1, 1, 1}, 6), by, 5));
}

TEST_F(CheckMesh, FailsTheSameTopology) {
  const auto grid = cubic_grid({0, 0, 0}, {1, 1, 1}, 3);
  PolyhedralMesh order = test::hexahedra(grid);  // the first two faces of cell 0, exchanged
  for (std::uint64_t i = 0; i < 4; ++i) std::swap(order.face_points[i], order.face_points[i + 4]);
  std::swap(order.neighbour[0], order.neighbour[1]);
  expect_the_same(order);
  PolyhedralMesh unused = test::hexahedra(grid);
  unused.points.push_back({0.5, 0.5, 0.5});
  expect_the_same(unused);
}

// A coarse face beside two fine ones, and one of the coarse cell's other faces lacks the point between them.
TEST_F(CheckMesh, FailsTheSameOpenEdges) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0, 1}};
  expect_the_same(test::mesh_of_cells(points, {{{0, 3, 2, 1}, {4, 8, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}}}));
}

}  // namespace
}  // namespace burnish
