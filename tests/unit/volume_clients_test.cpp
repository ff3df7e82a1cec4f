// Volume meshes as other people's programs read them: OpenFOAM, gmsh, VTK. Skipped where these are not installed.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <map>
#include <sstream>
#include <tuple>

#include "burnish/io/volume_files.h"
#include "support/elements.h"
#include "support/folder.h"
#include "support/programs.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

using test::Folder;
using test::has_program;
using test::mixed_cells;
using test::Ran;
using test::run_foam;
using test::run_program;

#define NEEDS(program) \
  if (!has_program(program)) GTEST_SKIP() << program << " is not installed"

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

// The number behind `label`, past blanks and colons; -1 if there is none.
double number_behind(const std::string& text, const std::string& label) {
  const std::size_t at = text.find(label);
  if (at == text.npos) return -1;
  return std::strtod(text.c_str() + text.find_first_not_of(" :=", at + label.size()), nullptr);
}

void expect_shapes(const std::string& said, int polyhedra) {
  const std::pair<const char*, int> expected[] = {{"    hexahedra:", 2}, {"    prisms:", 2}, {"    pyramids:", 5}, {"    tetrahedra:", 2}, {"    polyhedra:", polyhedra}};
  for (const auto& [shape, count] : expected) EXPECT_EQ(number_behind(said, shape), count) << shape;
  EXPECT_NEAR(number_behind(said, "Total volume = "), 4 + polyhedra, 1e-9);
}

TEST(OpenFoam, ChecksTheMeshInEveryFormat) {
  NEEDS("checkMesh");
  for (const FoamFormat& format : {FoamFormat{false, false, 4, 8}, {false, true, 4, 8}, {true, false, 4, 8}, {true, true, 4, 8}, {true, false, 8, 8}})
    for (const int polyhedra : {0, 1}) {
      const Folder folder;
      write_volume_mesh(folder.path("case"), mixed_cells(polyhedra == 1), {.foam = format});
      const Ran ran = run_foam("checkMesh", folder.path("case"), "-allTopology");
      EXPECT_TRUE(contains(ran.output, "Mesh OK.")) << ran.output;
      EXPECT_TRUE(contains(ran.output, "Number of regions: 1 (OK)."));
      expect_shapes(ran.output, polyhedra);
    }
}

TEST(OpenFoam, HasNoComplaintAboutHexahedra) {
  NEEDS("checkMesh");
  const Folder folder;
  write_volume_mesh(folder.path("case"), test::hexahedral_volume({{-1, 0, 0}, {1.0 / 3, 1, 0.1}, 6, 5, 4}));
  const Ran ran = run_foam("checkMesh", folder.path("case"), "-allTopology -allGeometry");
  EXPECT_TRUE(contains(ran.output, "Mesh OK.")) << ran.output;
  EXPECT_EQ(number_behind(ran.output, "    hexahedra:"), 120);
}

void replace_in(const std::string& path, const std::string& part, const std::string& by) {
  std::ifstream in(path);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  ASSERT_NE(text.find(part), text.npos) << part;
  text.replace(text.find(part), part.size(), by);
  std::ofstream(path) << text;
}

void limit_to(const std::string& control, int steps) { replace_in(control, "endTime         500", "endTime " + std::to_string(steps)); }

// The first and the last initial residual of a field.
std::pair<double, double> residuals(const std::string& said, const std::string& field) {
  const std::string label = "Solving for " + field + ", Initial residual =";
  const std::size_t last = said.rfind(label);
  return {number_behind(said, label), last == said.npos ? -1 : number_behind(said.substr(last), label)};
}

void expect_to_run(const VolumeMesh& mesh, const FoamFormat& format = {.binary = true}) {
  const Folder folder;
  write_volume_mesh(folder.path("case"), mesh, {.foam = format});
  limit_to(folder.path("case/system/controlDict"), 50);
  const Ran steady = run_foam("simpleFoam", folder.path("case"));
  EXPECT_EQ(steady.status, 0) << steady.output;
  for (const char* field : {"Ux", "p"}) {
    const auto [first, last] = residuals(steady.output, field);
    EXPECT_GT(first, 0) << field;
    EXPECT_LT(last, 0.1 * first) << field;
  }
  const Ran potential = run_foam("potentialFoam", folder.path("case"));
  EXPECT_EQ(potential.status, 0) << potential.output;
  EXPECT_LT(number_behind(potential.output, "Continuity error ="), 1e-6);
}

TEST(OpenFoam, SolvesFlowThroughTheCase) {
  NEEDS("simpleFoam");
  expect_to_run(test::hexahedral_volume({{0, 0, 0}, {3, 1, 1}, 12, 6, 6}));
  expect_to_run(mixed_cells(true), {.binary = false});
  // Enough cells for multigrid.
  expect_to_run(test::hexahedral_volume({{0, 0, 0}, {3, 1, 1}, 40, 16, 16}));
}

// The largest component of a field of vectors in text.
double largest(const std::string& path) {
  std::ifstream in(path);
  std::string text{std::istreambuf_iterator<char>(in), {}};
  double most = -1;
  std::istringstream list(text.substr(text.find("List<vector>"), text.find("boundaryField") - text.find("List<vector>")));
  std::string word;
  for (list >> word; list >> word;) {
    word.erase(std::remove_if(word.begin(), word.end(), [](char c) { return c == '(' || c == ')'; }), word.end());
    if (!word.empty() && word.find_first_not_of("0123456789.+-e") == word.npos && word.find('.') != word.npos) most = std::max(most, std::abs(std::strtod(word.c_str(), nullptr)));
  }
  return most;
}

// Nothing drives it: it comes to rest.
TEST(OpenFoam, SolvesFlowBetweenWallsAlone) {
  NEEDS("simpleFoam");
  VolumeMesh mesh = test::hexahedral_volume({{0, 0, 0}, {1, 1, 1}, 8, 8, 8});
  mesh.mesh.patches = {{"skin", "wall", mesh.mesh.patches[0].first_face, static_cast<std::uint32_t>(mesh.mesh.faces() - mesh.mesh.internal_faces())}};
  const Folder folder;
  write_volume_mesh(folder.path("case"), mesh);
  const std::string control = folder.path("case/system/controlDict");
  limit_to(control, 50);
  replace_in(control, "writeInterval   100", "writeInterval 50");
  replace_in(control, "writeFormat     binary", "writeFormat ascii");
  const Ran steady = run_foam("simpleFoam", folder.path("case"));
  EXPECT_EQ(steady.status, 0) << steady.output;
  const double speed = largest(folder.path("case/50/U"));
  EXPECT_GT(speed, 0);
  EXPECT_LT(speed, 1e-3);
  EXPECT_EQ(run_foam("potentialFoam", folder.path("case")).status, 0);
}

// A case keeps its conditions when another mesh is written into it.
TEST(OpenFoam, SolvesFlowOnTheNextMeshOfTheCase) {
  NEEDS("simpleFoam");
  const Folder folder;
  write_volume_mesh(folder.path("case"), test::hexahedral_volume({{0, 0, 0}, {1, 1, 1}, 4, 4, 4}));
  write_volume_mesh(folder.path("case"), mixed_cells(true));
  limit_to(folder.path("case/system/controlDict"), 3);
  const Ran ran = run_foam("simpleFoam", folder.path("case"));
  EXPECT_EQ(ran.status, 0) << ran.output;
}

TEST(Gmsh, HasNoComplaint) {
  NEEDS("gmsh");
  const Folder folder;
  for (const int version : {41, 22}) {
    write_msh(folder.path("a.msh"), mixed_cells(false), {.msh_version = version});
    const Ran ran = run_program("gmsh -check '" + folder.path("a.msh") + "'");
    EXPECT_EQ(ran.status, 0);
    EXPECT_FALSE(contains(ran.output, "Warning") || contains(ran.output, "Error")) << ran.output;
    EXPECT_TRUE(contains(ran.output, "21 nodes") && contains(ran.output, std::to_string(11 + mixed_cells(false).mesh.faces() - mixed_cells(false).mesh.internal_faces()) + " elements")) << ran.output;
  }
}

// What gmsh writes of what it read from one version is what it read from the other.
TEST(Gmsh, ReadsTheSameFromBothVersions) {
  NEEDS("gmsh");
  const Folder folder;
  const VolumeMesh mesh = mixed_cells(false);
  write_msh(folder.path("a.msh"), mesh);
  const Ran ran = run_program("gmsh '" + folder.path("a.msh") + "' -save -format msh22 -o '" + folder.path("b.msh") + "'");
  ASSERT_EQ(ran.status, 0) << ran.output;
  write_msh(folder.path("c.msh"), mesh, {.msh_version = 22});
  const test::ElementMesh read = test::read_msh22(folder.path("b.msh")), own = test::read_msh22(folder.path("c.msh"));
  ASSERT_EQ(read.elements.size(), own.elements.size());
  const auto key = [](const test::Element& e) { return std::tuple(e.type, e.group, e.corners); };
  std::vector<decltype(key(own.elements[0]))> a, b;
  for (const auto& e : read.elements) a.push_back(key(e));
  for (const auto& e : own.elements) b.push_back(key(e));
  std::sort(a.begin(), a.end());
  std::sort(b.begin(), b.end());
  EXPECT_EQ(a, b);
}

TEST(Gmsh, IsConvertedToOpenFoam) {
  NEEDS("gmshToFoam");
  const Folder folder;
  write_volume_mesh(folder.path("case"), test::hexahedral_volume({{0, 0, 0}, {1, 1, 1}, 1, 1, 1}));
  write_msh(folder.path("a.msh"), mixed_cells(false), {.msh_version = 22});
  const Ran ran = run_foam("gmshToFoam", folder.path("case"), "'" + folder.path("a.msh") + "'");
  EXPECT_EQ(ran.status, 0) << ran.output;
  const Ran checked = run_foam("checkMesh", folder.path("case"), "-allTopology");
  EXPECT_TRUE(contains(checked.output, "Mesh OK.")) << checked.output;
  expect_shapes(checked.output, 0);
  std::map<std::string, std::uint32_t> faces;
  for (const MeshPatch& p : read_foam_mesh(folder.path("case")).mesh.patches) faces[p.name] = p.faces;
  for (const MeshPatch& p : mixed_cells(false).mesh.patches) EXPECT_EQ(faces[p.name], p.faces) << p.name;
}

const char* const kReadByVtk = R"PY(
import sys
from vtkmodules.vtkIOXML import vtkXMLUnstructuredGridReader
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
reader = vtkXMLUnstructuredGridReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput()
sizes = vtkCellSizeFilter()
sizes.SetInputData(grid)
sizes.Update()
volume = sizes.GetOutput().GetCellData().GetArray("Volume")
shape = grid.GetCellData().GetArray("shape")
expected = [(12, 1.0, 3)] * 2 + [(14, 1 / 6, 1)] * 5 + [(10, 1 / 12, 0)] * 2 + [(13, 0.5, 2)] * 2
if sys.argv[2] == "1": expected.append((42, 1.0, 4))
assert grid.GetNumberOfCells() == len(expected), grid.GetNumberOfCells()
assert grid.GetPoints().GetData().GetDataTypeAsString() == "double"
for c, (kind, size, number) in enumerate(expected):
    assert grid.GetCellType(c) == kind, (c, grid.GetCellType(c))
    assert abs(volume.GetTuple1(c) - size) < 1e-12, (c, volume.GetTuple1(c))
    assert shape.GetTuple1(c) == number, (c, shape.GetTuple1(c))
    cell = grid.GetCell(c)
    middle = [sum(cell.GetPoints().GetPoint(i)[a] for i in range(cell.GetNumberOfPoints())) / cell.GetNumberOfPoints() for a in range(3)]
    for f in range(cell.GetNumberOfFaces()):
        p = [cell.GetFace(f).GetPoints().GetPoint(i) for i in range(cell.GetFace(f).GetNumberOfPoints())]
        u, v = [[p[k][a] - p[0][a] for a in range(3)] for k in (1, 2)]
        normal = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]]
        assert sum(normal[a] * (p[0][a] - middle[a]) for a in range(3)) > 0, (c, f)
if sys.argv[2] == "1":
    cell = grid.GetCell(11)
    assert sorted(cell.GetFace(f).GetNumberOfPoints() for f in range(cell.GetNumberOfFaces())) == [3, 3, 4, 4, 4, 4, 4]
assert abs(grid.GetPoint(16)[0] - 2.5) < 1e-15 or sys.argv[2] == "1"
)PY";

TEST(Vtk, ReadsTheSame) {
  if (run_program("/usr/bin/python3 -c 'import vtkmodules.vtkIOXML, vtkmodules.vtkFiltersVerdict'").status != 0) GTEST_SKIP() << "no VTK (scripts/bootstrap picture)";
  const Folder folder;
  for (const bool with_polyhedron : {false, true}) {
    write_volume_mesh(folder.path("a.vtu"), mixed_cells(with_polyhedron));
    const Ran ran = run_program(std::string("/usr/bin/python3 -c '") + kReadByVtk + "' '" + folder.path("a.vtu") + "' " + (with_polyhedron ? "1" : "0"));
    EXPECT_EQ(ran.status, 0) << ran.output;
  }
}

// Prisms have a negative volume there: VTK's reader keeps the standard's order of corners, which is not VTK's.
const char* const kCgnsReadByVtk = R"PY(
import sys
from vtkmodules.vtkIOCGNSReader import vtkCGNSReader
from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter
reader = vtkCGNSReader()
reader.SetFileName(sys.argv[1])
reader.Update()
grid = reader.GetOutput().GetBlock(0).GetBlock(0)
sizes = vtkCellSizeFilter()
sizes.SetInputData(grid)
sizes.Update()
volume = sizes.GetOutput().GetCellData().GetArray("Volume")
expected = [(10, 1 / 12)] * 2 + [(14, 1 / 6)] * 5 + [(13, -0.5)] * 2 + [(12, 1.0)] * 2
assert grid.GetNumberOfCells() == len(expected), grid.GetNumberOfCells()
for c, (kind, size) in enumerate(expected):
    assert grid.GetCellType(c) == kind, (c, grid.GetCellType(c))
    assert abs(volume.GetTuple1(c) - size) < 1e-12, (c, volume.GetTuple1(c))
)PY";

TEST(Vtk, ReadsCgns) {
  if (!has_cgns()) GTEST_SKIP() << "built without CGNS (libcgns-dev)";
  if (run_program("/usr/bin/python3 -c 'import vtkmodules.vtkIOCGNSReader, vtkmodules.vtkFiltersVerdict'").status != 0) GTEST_SKIP() << "no VTK (scripts/bootstrap picture)";
  const Folder folder;
  write_volume_mesh(folder.path("a.cgns"), mixed_cells(false));
  const Ran ran = run_program(std::string("/usr/bin/python3 -c '") + kCgnsReadByVtk + "' '" + folder.path("a.cgns") + "'");
  EXPECT_EQ(ran.status, 0) << ran.output;
}

}  // namespace
}  // namespace burnish
