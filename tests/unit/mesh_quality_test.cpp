// What checkMesh measures, on meshes for which it is known.
#include "burnish/volume/mesh_quality.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <numeric>
#include <stdexcept>

#include "burnish/core/parallel.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

using test::CellLoops;
using test::cubic_grid;
using test::Grid;
using test::mesh_of_cells;

constexpr double kDegree = 3.14159265358979323846 / 180;

// One cell of that shape, by its corners.
VolumeMesh one_cell(CellShape shape, const std::vector<Vec3>& corners) {
  CellLoops loops;
  for (const auto& f : faces_of_shape(shape)) {
    loops.emplace_back();
    for (const int corner : f)
      if (corner >= 0) loops.back().push_back(static_cast<std::uint32_t>(corner));
  }
  VolumeMesh mesh{.mesh = mesh_of_cells(corners, {loops}), .shape = {shape}, .first = {0, corners.size()}, .corners = {}};
  mesh.corners.resize(corners.size());
  std::iota(mesh.corners.begin(), mesh.corners.end(), 0u);
  return mesh;
}

const std::vector<Vec3> kCube{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}};

template <class Move>
PolyhedralMesh moved(PolyhedralMesh mesh, Move&& move) {
  for (Vec3& p : mesh.points) p = move(p);
  return mesh;
}

std::vector<std::string> failed_checks(const MeshQuality& quality) {
  std::vector<std::string> names;
  for (const MeshCheck& check : quality.checks)
    if (!check.passed) names.push_back(check.name);
  return names;
}

using Names = std::vector<std::string>;

TEST(MeshQuality, OfCubesIsPerfect) {
  const MeshQuality q = mesh_quality(test::hexahedra(cubic_grid({0, 0, 0}, {3, 3, 3}, 3)));
  EXPECT_TRUE(q.ok);
  EXPECT_TRUE(q.plain_ok);
  EXPECT_EQ(q.cells, 27u);
  EXPECT_EQ(q.points, 64u);
  EXPECT_EQ(q.internal_faces, 54u);
  EXPECT_EQ(q.faces, 108u);
  EXPECT_EQ(q.regions, 1u);
  EXPECT_DOUBLE_EQ(q.volume, 27);
  EXPECT_EQ(q.check("non-orthogonality").worst, 0);
  EXPECT_NEAR(q.check("skewness").worst, 0, 1e-15);
  EXPECT_NEAR(q.check("boundary skewness").worst, 0, 1e-15);
  EXPECT_DOUBLE_EQ(q.check("weight").worst, 0.5);
  EXPECT_DOUBLE_EQ(q.check("volume ratio").worst, 1);
  EXPECT_DOUBLE_EQ(q.check("aspect ratio").worst, 1);
  EXPECT_DOUBLE_EQ(q.check("flatness").worst, 1);
  EXPECT_DOUBLE_EQ(q.check("face area").worst, 1);
  EXPECT_DOUBLE_EQ(q.check("face pyramids").worst, 1.0 / 6);
  EXPECT_DOUBLE_EQ(q.check("edge length").worst, 1);
  for (const MeshCheck& check : q.checks) EXPECT_EQ(check.failing, 0u) << check.name;
}

// A cell with n internal faces on each axis has det(diag(n)) / 8.
TEST(MeshQuality, DeterminantsOfCubesCountTheirInternalFaces) {
  const MeshQuality q = mesh_quality(test::hexahedra(cubic_grid({0, 0, 0}, {3, 3, 3}, 3)));
  EXPECT_DOUBLE_EQ(q.check("determinant").worst, 1.0 / 8);
  EXPECT_DOUBLE_EQ(q.check("determinant").best, 1);
  EXPECT_NEAR(q.check("determinant").mean, (8 * 0.125 + 12 * 0.25 + 6 * 0.5 + 1) / 27, 1e-15);
}

TEST(MeshQuality, AspectRatioOfABoxIsThatOfItsAreas) {
  const MeshQuality q = mesh_quality(test::hexahedra(Grid{{0, 0, 0}, {1, 4, 2}, 1, 2, 2}));  // cells 1 x 2 x 1: areas 2, 1, 2, doubled
  EXPECT_NEAR(q.check("aspect ratio").worst, 2, 1e-14);
}

// Sheared cubes: lines of centres are edges, so the angle at z-faces is the shear's, and that at x-faces too; y-faces stay orthogonal.
TEST(MeshQuality, NonOrthogonalityOfAShearIsItsAngle) {
  for (const double angle : {10.0, 45.0, 69.0, 71.0, 80.0}) {
    const double slope = std::tan(angle * kDegree);
    const MeshQuality q = mesh_quality(moved(test::hexahedra(cubic_grid({0, 0, 0}, {1, 1, 1}, 4)), [&](Vec3 p) { return p.x += slope * p.z, p; }));
    const MeshCheck& check = q.check("non-orthogonality");
    EXPECT_NEAR(check.worst, angle, 1e-9);
    EXPECT_NEAR(check.mean, std::acos((2 * std::cos(angle * kDegree) + 1) / 3) / kDegree, 1e-9);
    EXPECT_EQ(check.failing, angle > 70 ? 2 * check.measured / 3 : 0u);
    EXPECT_TRUE(check.passed);  // 90 degrees is the end, 70 is only told
    EXPECT_NEAR(q.check("skewness").worst, 0, 1e-12);
    EXPECT_NEAR(q.volume, 1, 1e-12);
  }
}

// A cell beside cells of half its size, as if both were cubes: the line between the centres (0, 0, 0) and (3, 1, 1) / 2.
TEST(MeshQuality, AtALevelJumpIsWhatTheGeometrySays) {
  const MeshQuality q = mesh_quality(test::two_levels(cubic_grid({0, 0, 0}, {4, 4, 4}, 4), [](const Vec3& p) { return p.x < 2; }));
  EXPECT_NEAR(q.check("non-orthogonality").worst, std::acos(3 / std::sqrt(11.0)) / kDegree, 1e-9);
  EXPECT_NEAR(q.check("skewness").worst, 1.0 / 3, 1e-12);  // (1, 1) / 6 of (1, 1) / 2
  EXPECT_NEAR(q.check("weight").worst, 1.0 / 3, 1e-12);
  EXPECT_NEAR(q.check("volume ratio").worst, 1.0 / 8, 1e-12);
  EXPECT_EQ(q.check("concave cells").failing, 16u);  // the coarse ones beside fine ones have coplanar faces
  EXPECT_EQ(failed_checks(q), Names{"concave cells"});
  EXPECT_EQ(q.failed, 1);
  EXPECT_FALSE(q.ok);
  EXPECT_TRUE(q.plain_ok);
}

TEST(MeshQuality, MeasuresCurvedQuadranglesAsTrianglesAboutTheirMiddle) {
  const double h = 0.3;
  auto corners = kCube;
  for (std::size_t i = 4; i < 8; ++i) corners[i].z += i % 2 == 0 ? h : -h;
  const MeshQuality q = mesh_quality(one_cell(CellShape::hexahedron, corners));
  EXPECT_NEAR(q.check("flatness").worst, 1 / std::sqrt(1 + 4 * h * h), 1e-12);
  EXPECT_NEAR(q.volume, 1, 1e-12);
  EXPECT_TRUE(q.check("flatness").passed);
}

// A dart: its reflex corner turns by the angle between the edges there.
TEST(MeshQuality, TellsConcaveFaces) {
  const double turn = 2 * std::atan2(0.3, 1.0) / kDegree;
  const std::vector<Vec3> dart{{-1, 0, 0}, {0, 0.3, 0}, {1, 0, 0}, {0, 2, 0}, {-1, 0, 1}, {0, 0.3, 1}, {1, 0, 1}, {0, 2, 1}};
  const MeshQuality q = mesh_quality(one_cell(CellShape::hexahedron, dart));
  const MeshCheck& check = q.check("concave faces");
  EXPECT_EQ(check.failing, 2u);
  EXPECT_NEAR(check.worst, turn, 1e-9);
  EXPECT_TRUE(check.warns && check.passed);
  EXPECT_EQ(q.check("concave cells").failing, 1u);
  EXPECT_FALSE(q.check("concave cells").passed);
}

TEST(MeshQuality, DihedralAnglesOfEachShape) {
  const double half = std::sqrt(0.5);
  const MeshQuality regular = mesh_quality(one_cell(CellShape::tetrahedron, {{1, 1, 1}, {-1, 1, -1}, {1, -1, -1}, {-1, -1, 1}}));
  EXPECT_NEAR(regular.least_dihedral, std::acos(1.0 / 3) / kDegree, 1e-9);
  EXPECT_NEAR(regular.greatest_dihedral, std::acos(1.0 / 3) / kDegree, 1e-9);
  EXPECT_NEAR(std::fabs(regular.volume), 8.0 / 3, 1e-12);

  // The body-centred cubic one: an edge of the cube and the centres on both sides.
  const MeshQuality bcc = mesh_quality(one_cell(CellShape::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0.5, 0.5, 0.5}, {0.5, -0.5, 0.5}}));
  EXPECT_NEAR(bcc.least_dihedral, 60, 1e-9);
  EXPECT_NEAR(bcc.greatest_dihedral, 90, 1e-9);

  const MeshQuality cube = mesh_quality(one_cell(CellShape::hexahedron, kCube));
  EXPECT_NEAR(cube.least_dihedral_of_shape[3], 90, 1e-9);
  EXPECT_NEAR(cube.greatest_dihedral_of_shape[3], 90, 1e-9);
  EXPECT_EQ(cube.greatest_dihedral, 0);  // no tetrahedra
  EXPECT_EQ(cube.cells_of_shape[3], 1u);
  EXPECT_DOUBLE_EQ(cube.volume_of_shape[3], 1);
  EXPECT_DOUBLE_EQ(cube.hexahedron_share(), 1);

  // A cube's sixth: 45 degrees at the base, 120 at the other edges.
  const MeshQuality pyramid = mesh_quality(one_cell(CellShape::pyramid, {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 0.5}}));
  EXPECT_NEAR(pyramid.least_dihedral_of_shape[1], 45, 1e-9);
  EXPECT_NEAR(pyramid.greatest_dihedral_of_shape[1], 120, 1e-9);
  EXPECT_NEAR(pyramid.volume_of_shape[1], 1.0 / 6, 1e-12);

  // An upright prism over an equilateral triangle (VTK's order).
  const MeshQuality wedge = mesh_quality(one_cell(CellShape::wedge, {{0, 0, 0}, {half, half * std::sqrt(3.0), 0}, {2 * half, 0, 0}, {0, 0, 1}, {half, half * std::sqrt(3.0), 1}, {2 * half, 0, 1}}));
  EXPECT_NEAR(wedge.least_dihedral_of_shape[2], 60, 1e-9);
  EXPECT_NEAR(wedge.greatest_dihedral_of_shape[2], 90, 1e-9);
}

TEST(MeshQuality, FacesAtTheBoundaryLeaveACellUnderdetermined) {
  const MeshQuality q = mesh_quality(one_cell(CellShape::tetrahedron, {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(q.check("determinant").worst, 0);
  EXPECT_EQ(failed_checks(q), Names{"determinant"});
  EXPECT_EQ(q.check("non-orthogonality").measured, 0u);
  EXPECT_TRUE(q.plain_ok);
}

TEST(MeshQuality, FindsInvertedCells) {
  auto corners = kCube;
  for (Vec3& p : corners) p.z = -p.z;
  const MeshQuality q = mesh_quality(one_cell(CellShape::hexahedron, corners));
  EXPECT_DOUBLE_EQ(q.check("cell volume").worst, -1);
  EXPECT_DOUBLE_EQ(q.check("face pyramids").worst, -1.0 / 6);
  EXPECT_EQ(q.check("face pyramids").failing, 6u);
  EXPECT_EQ(q.check("face tetrahedra").failing, 6u);
  EXPECT_FALSE(q.plain_ok);
}

TEST(MeshQuality, FindsBrokenTopology) {
  const PolyhedralMesh good = test::hexahedra(cubic_grid({0, 0, 0}, {3, 3, 3}, 3));

  PolyhedralMesh unused = good;
  unused.points.push_back({9, 9, 9});
  EXPECT_EQ(failed_checks(mesh_quality(unused)), Names{"unused points"});

  PolyhedralMesh order = good;  // the first two faces of cell 0, exchanged
  for (std::uint64_t i = 0; i < 4; ++i) std::swap(order.face_points[i], order.face_points[i + 4]);
  std::swap(order.neighbour[0], order.neighbour[1]);
  EXPECT_EQ(failed_checks(mesh_quality(order)), Names{"face order"});
  EXPECT_EQ(mesh_quality(order).plain_failed, 1);

  PolyhedralMesh hole = good;  // the last boundary face is missing
  for (int i = 0; i < 4; ++i) hole.face_points.pop_back();
  hole.face_start.pop_back();
  hole.owner.pop_back();
  const MeshQuality q = mesh_quality(hole);
  EXPECT_EQ(q.check("zip-up").worst, 4);
  EXPECT_NEAR(q.check("boundary openness").worst, 1.0 / 53, 1e-12);
  EXPECT_NEAR(q.check("cell openness").worst, 1, 1e-12);
  EXPECT_EQ(q.check("cell openness").failing, 1u);

  PolyhedralMesh twice = good;
  twice.face_points[twice.face_start[100] + 1] = twice.face_points[twice.face_start[100]];
  EXPECT_EQ(mesh_quality(twice).check("face vertices").failing, 1u);
}

// A coarse face beside two halves: that the point between them is missing in the coarse cell's other faces is nothing geometry could see.
TEST(MeshQuality, FindsHangingPointsThatSomeFacesLack) {
  const std::vector<Vec3> points{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}, {0.5, 0, 1}};
  const CellLoops open{{0, 3, 2, 1}, {4, 8, 5, 6, 7}, {0, 1, 5, 4}, {1, 2, 6, 5}, {2, 3, 7, 6}, {3, 0, 4, 7}};
  CellLoops closed = open;
  closed[2] = {0, 1, 5, 8, 4};
  EXPECT_EQ(mesh_quality(mesh_of_cells(points, {open})).check("zip-up").worst, 3);
  EXPECT_FALSE(mesh_quality(mesh_of_cells(points, {open})).check("zip-up").passed);
  EXPECT_TRUE(mesh_quality(mesh_of_cells(points, {closed})).check("zip-up").passed);
}

TEST(MeshQuality, CountsRegions) {
  const auto cube_at = [](double x, std::vector<Vec3>& points) {
    const auto first = static_cast<std::uint32_t>(points.size());
    for (const Vec3& p : kCube) points.push_back(p + Vec3{x, 0, 0});
    CellLoops loops;
    for (const auto& f : faces_of_shape(CellShape::hexahedron)) {
      loops.emplace_back();
      for (const int corner : f) loops.back().push_back(first + static_cast<std::uint32_t>(corner));
    }
    return loops;
  };
  std::vector<Vec3> points;
  const std::vector<CellLoops> cells{cube_at(0, points), cube_at(2, points)};
  EXPECT_EQ(mesh_quality(mesh_of_cells(points, cells)).regions, 2u);
}

PolyhedralMesh bad_mesh() {
  const Grid grid = cubic_grid({0, 0, 0}, {1, 1, 1}, 12);
  return test::jittered(test::hexahedra(grid), grid, 0.6, 11);  // by more than half a cell: concave, inverted, warped
}

TEST(BadCells, AreThoseThatFailByThemselvesOrByAFace) {
  const PolyhedralMesh mesh = bad_mesh();
  const MeshQuality q = mesh_quality(mesh);
  const auto bad = bad_cells(mesh);
  EXPECT_GE(bad.size(), q.check("concave cells").failing);
  EXPECT_GT(bad.size(), 0u);
  for (std::size_t i = 0; i < bad.size(); ++i) {
    if (i > 0) { EXPECT_LT(bad[i - 1].cell, bad[i].cell); }
    EXPECT_GT(q.check(bad[i].check).failing, 0u) << bad[i].check;
  }
  EXPECT_TRUE(bad_cells(test::hexahedra(cubic_grid({0, 0, 0}, {1, 1, 1}, 3))).empty());
}

TEST(BadCells, OfAListAreThoseOfTheWholeMesh) {
  PolyhedralMesh mesh = bad_mesh();
  const CellFaces faces = cell_faces(mesh);
  for (Vec3& p : mesh.points) p = p * 0.9;  // measured from the points as they are
  const auto whole = bad_cells(mesh);
  std::vector<std::uint32_t> some;
  for (std::uint32_t c = 0; c < mesh.cells; c += 3) some.push_back(c);
  std::vector<BadCell> expected;
  for (const BadCell& b : whole)
    if (b.cell % 3 == 0) expected.push_back(b);
  const auto found = bad_cells_among(mesh, faces, some);
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i) {
    EXPECT_EQ(found[i].cell, expected[i].cell);
    EXPECT_EQ(found[i].check, expected[i].check);
    EXPECT_EQ(found[i].value, expected[i].value);
  }
}

TEST(BadCells, StricterLimitsFindMore) {
  const Grid grid = cubic_grid({0, 0, 0}, {1, 1, 1}, 6);
  const PolyhedralMesh mesh = test::jittered(test::hexahedra(grid), grid, 0.2, 5);
  const double worst = mesh_quality(mesh).check("non-orthogonality").worst;
  MeshQualityLimits limits;
  limits.non_orthogonality = worst - 0.01;
  const auto bad = bad_cells(mesh, limits);
  ASSERT_GE(bad.size(), 2u);  // both cells of the worst face
  for (const BadCell& b : bad) {
    EXPECT_EQ(b.check, "non-orthogonality");
    EXPECT_GT(b.value, worst - 0.01);
  }
}

TEST(MeshQuality, HasTheSameBitsForAnyNumberOfThreads) {
  const PolyhedralMesh mesh = bad_mesh();
  const auto values = [&](int threads) {
    ThreadLimit limit(threads);
    const MeshQuality q = mesh_quality(mesh);
    std::vector<double> all{q.volume};
    for (const MeshCheck& c : q.checks) all.insert(all.end(), {c.worst, c.best, c.mean, static_cast<double>(c.failing)});
    return all;
  };
  EXPECT_EQ(values(1), values(2));
  EXPECT_EQ(values(1), values(7));
}

TEST(MeshQuality, RefusesNamesThatNoCheckHas) { EXPECT_THROW(mesh_quality(bad_mesh()).check("beauty"), std::out_of_range); }

}  // namespace
}  // namespace burnish
