#include "burnish/volume/flow_mesh.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <string>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/volume/mesh_quality.h"
#include "support/creased_shapes.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

Vec3 turned(const Vec3& p) {
  const double c = std::cos(0.5), s = std::sin(0.5), d = std::cos(0.3), t = std::sin(0.3);
  const Vec3 q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
  return {q.x, d * q.y - t * q.z, t * q.y + d * q.z};
}

FlowMeshOptions inside(double cell) {
  FlowMeshOptions options;
  options.cell = cell;
  return options;
}
FlowMeshOptions outside(const TriangleSoup& solid, double cell, double margin) {
  FlowMeshOptions options = inside(cell);
  options.side = MeshSide::outside;
  const Box3 box = bounding_box(solid);
  options.domain = {box.lower - Vec3{margin, margin, margin}, box.upper + Vec3{margin, margin, margin}};
  return options;
}

double volume(const VolumeMesh& mesh) {
  double sum = 0;
  for (const double v : cell_geometry(mesh.mesh, cell_faces(mesh.mesh)).volume) sum += v;
  return sum;
}

// Each edge of the boundary is run as often one way as the other, and the volumes of all cells are what the boundary encloses.
void expect_closed(const VolumeMesh& volume_mesh) {
  const PolyhedralMesh& mesh = volume_mesh.mesh;
  std::map<std::pair<std::uint32_t, std::uint32_t>, int> runs;
  double enclosed = 0;
  for (std::size_t f = mesh.internal_faces(); f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    const Vec3 middle = face_middle(mesh, f);
    for (std::size_t i = 0; i < face.size(); ++i) {
      const std::uint32_t a = face[i], b = face[(i + 1) % face.size()];
      runs[{std::min(a, b), std::max(a, b)}] += a < b ? 1 : -1;
      enclosed += dot(middle - mesh.points[0], cross(mesh.points[a] - mesh.points[0], mesh.points[b] - mesh.points[0])) / 6;
    }
  }
  EXPECT_TRUE(std::all_of(runs.begin(), runs.end(), [](const auto& r) { return r.second == 0; }));
  EXPECT_NEAR(volume(volume_mesh), enclosed, 1e-9 * std::abs(enclosed));
}

void expect_sound(const FlowMesh& made, std::uint32_t regions, bool polyhedral = false) {
  const MeshQuality q = mesh_quality(made.mesh);
  EXPECT_TRUE(polyhedral ? q.plain_ok : q.ok);
  for (const MeshCheck& c : q.checks) EXPECT_TRUE(c.passed || (polyhedral && c.all_geometry)) << c.name << " " << c.worst << " at " << c.failing;
  EXPECT_EQ(q.regions, regions);
  EXPECT_LE(q.check("non-orthogonality").worst, 65);
  EXPECT_LE(q.check("skewness").worst, 1);
  expect_closed(made.mesh);
}

struct NamedSolid {
  std::string name;
  TriangleSoup soup;
  std::uint32_t bodies = 1;
  double cell = 0.1;
};

std::vector<NamedSolid> solids() {
  std::vector<NamedSolid> all;
  all.push_back({"ball", icosphere(4), 1, 0.15});
  all.push_back({"torus", torus(48, 24), 1, 0.08});
  all.push_back({"cube along the lattice", cube(), 1, 0.09});
  all.push_back({"turned cube", mapped(cube(), turned), 1, 0.09});
  all.push_back({"cone", cone(40), 1, 0.12});
  all.push_back({"bracket", bracket(6), 1, 0.15});
  all.push_back({"two balls", merged(icosphere(3), moved(icosphere(3), {2.6, 0, 0})), 2, 0.15});
  all.push_back({"ball with a cavity", merged(icosphere(3), flipped(scaled(icosphere(3), 0.5))), 1, 0.12});
  all.push_back({"far away", moved(icosphere(3), {1e6, -2e6, 3e6}), 1, 0.15});
  all.push_back({"tiny", scaled(icosphere(3), 1e-6), 1, 1.5e-7});
  return all;
}

TEST(FlowMesh, InsidePassesTheFullCheck) {
  for (const NamedSolid& s : solids()) {
    SCOPED_TRACE(s.name);
    const FlowMesh made = flow_mesh(s.soup, {}, {}, inside(s.cell));
    expect_sound(made, s.bodies);
    EXPECT_NEAR(volume(made.mesh), signed_volume(s.soup), 0.03 * signed_volume(s.soup));
  }
}

TEST(FlowMesh, OutsideIsWhatIsLeftOfTheDomain) {
  for (const NamedSolid& s : solids()) {
    SCOPED_TRACE(s.name);
    const FlowMeshOptions options = outside(s.soup, s.cell, 7.3 * s.cell);
    const FlowMesh made = flow_mesh(s.soup, {}, {}, options);
    expect_sound(made, s.name == "ball with a cavity" ? 2 : 1);
    const Vec3 e = options.domain.extent();
    EXPECT_NEAR(volume(made.mesh), e.x * e.y * e.z - signed_volume(s.soup), 0.03 * signed_volume(s.soup));
  }
}

TEST(FlowMesh, PolyhedraPassThePlainCheckWithFewerCells) {
  for (const NamedSolid& s : solids()) {
    SCOPED_TRACE(s.name);
    FlowMeshOptions options = outside(s.soup, s.cell, 12 * s.cell);
    const std::size_t conforming = flow_mesh(s.soup, {}, {}, options).mesh.cells();
    options.flavour = MeshFlavour::polyhedral;
    const FlowMesh made = flow_mesh(s.soup, {}, {}, options);
    expect_sound(made, s.name == "ball with a cavity" ? 2 : 1, true);
    EXPECT_LT(made.mesh.cells(), conforming);
  }
}

TEST(FlowMesh, VolumeConvergesWithTheSquareOfTheCell) {
  const TriangleSoup ball = icosphere(6);
  const auto error = [&](double cell) {
    FlowMeshOptions options = inside(cell);
    options.flat_levels = 0;  // else the finer mesh would have larger cells here and there
    return std::abs(volume(flow_mesh(ball, {}, {}, options).mesh) - signed_volume(ball)) / signed_volume(ball);
  };
  const double coarse = error(0.2), fine = error(0.1);
  EXPECT_LT(coarse, 0.02);
  EXPECT_GT(std::log2(coarse / fine), 1.6) << coarse << " " << fine;
}

TEST(FlowMesh, WallsLieOnTheSurface) {
  const TriangleSoup ball = icosphere(5);
  const FlowMesh made = flow_mesh(ball, {}, {}, inside(0.1));
  const TriangleIndex index(ball);
  const PolyhedralMesh& mesh = made.mesh.mesh;
  std::size_t off = 0, all = 0;
  for (std::size_t f = mesh.internal_faces(); f < mesh.faces(); ++f)
    for (const std::uint32_t p : mesh.face(f)) ++all, off += index.closest(mesh.points[p]).squared_distance > 1e-18;
  EXPECT_LT(static_cast<double>(off), 0.02 * static_cast<double>(all)) << made.moved_back;
}

TEST(FlowMesh, EdgesOfASolidAreEdgesOfTheMesh) {
  const TriangleSoup box = mapped(cube(), turned);
  const FlowMesh made = flow_mesh(box, {}, {}, inside(0.07));
  EXPECT_GT(made.crease_points, 50u);
  EXPECT_NEAR(volume(made.mesh), signed_volume(box), 3e-3 * signed_volume(box));
}

// However the solid lies in the lattice: nearly all corners; of some the cells would be too flat.
TEST(FlowMesh, CornersOfASolidArePointsOfTheMesh) {
  int corners = 0, kept = 0;
  for (int i = 0; i < 12; ++i) {
    const double angle = 0.26 * i;
    const TriangleSoup box = mapped(cube(), [&](const Vec3& p) { return turned({std::cos(angle) * p.x - std::sin(angle) * p.z, p.y, std::sin(angle) * p.x + std::cos(angle) * p.z}) + Vec3{0.013 * i, 0.007 * i, 0.003 * i}; });
    const FlowMesh made = flow_mesh(box, {}, {}, inside(0.09 * bounding_box(box).longest_side()));
    const PolyhedralMesh& mesh = made.mesh.mesh;
    for (const Vec3& corner : box.points) {
      double nearest = 1;
      for (std::size_t f = mesh.internal_faces(); f < mesh.faces(); ++f)
        for (const std::uint32_t p : mesh.face(f)) nearest = std::min(nearest, norm(mesh.points[p] - corner));
      ++corners, kept += nearest < 1e-9;
    }
  }
  EXPECT_GE(kept, corners * 9 / 10) << kept << " of " << corners;
}

TEST(FlowMesh, PatchesFollowTheFacets) {
  const TriangleSoup box = cube();
  std::vector<std::uint32_t> patch(box.facets.size());
  const std::array<std::string, 3> names{"x", "y", "z"};
  for (std::size_t f = 0; f < patch.size(); ++f) {
    const Vec3 n = facet_normal_2a(box, f);
    patch[f] = std::abs(n.x) > 0.5 ? 0 : std::abs(n.y) > 0.5 ? 1 : 2;
  }
  const FlowMesh made = flow_mesh(box, patch, {names.begin(), names.end()}, inside(0.08));
  ASSERT_EQ(made.mesh.mesh.patches.size(), 3u);
  for (std::size_t i = 0; i < 3; ++i) {
    const MeshPatch& p = made.mesh.mesh.patches[i];
    EXPECT_EQ(p.name, names[i]);
    EXPECT_EQ(p.type, "wall");
    Vec3 sum;
    for (std::size_t f = p.first_face; f < p.first_face + p.faces; ++f) {
      const auto face = made.mesh.mesh.face(f);
      Vec3 n;
      for (std::size_t k = 2; k < face.size(); ++k)
        n += cross(made.mesh.mesh.points[face[k - 1]] - made.mesh.mesh.points[face[0]], made.mesh.mesh.points[face[k]] - made.mesh.mesh.points[face[0]]) * 0.5;
      sum += Vec3{std::abs(n.x), std::abs(n.y), std::abs(n.z)};
    }
    const double side = std::sqrt(area(box) / 6);
    EXPECT_NEAR(sum[static_cast<int>(i)], 2 * side * side, 0.05 * side * side);
  }
}

TEST(FlowMesh, SidesOfTheDomainAreExact) {
  const TriangleSoup ball = icosphere(3);
  FlowMeshOptions options = inside(0.2);
  options.side = MeshSide::outside;
  options.domain = {{-3.123, -2.5, -2.77}, {5.01, 2.9, 3.3}};
  const FlowMesh made = flow_mesh(ball, {}, {"ball"}, options);
  Box3 box;
  for (const Vec3& p : made.mesh.mesh.points) box.extend(p);
  EXPECT_EQ(box.lower, options.domain.lower);
  EXPECT_EQ(box.upper, options.domain.upper);
  const std::array<std::string, 7> names{"ball", "xMin", "xMax", "yMin", "yMax", "zMin", "zMax"};
  ASSERT_EQ(made.mesh.mesh.patches.size(), 7u);
  for (std::size_t i = 0; i < 7; ++i) EXPECT_EQ(made.mesh.mesh.patches[i].name, names[i]);
  for (std::size_t i = 1; i < 7; ++i) {
    const MeshPatch& p = made.mesh.mesh.patches[i];
    const int axis = static_cast<int>(i - 1) / 2;
    EXPECT_GT(p.faces, 0u);
    for (std::size_t f = p.first_face; f < p.first_face + p.faces; ++f)
      for (const std::uint32_t v : made.mesh.mesh.face(f)) EXPECT_EQ(made.mesh.mesh.points[v][axis], i % 2 == 1 ? options.domain.lower[axis] : options.domain.upper[axis]);
  }
  expect_sound(made, 1);
}

TEST(FlowMesh, CellsOfSeveralSizesMeetAtTheSurface) {
  const TriangleSoup ball = icosphere(5);
  for (const double factor : {0.5, 0.25})
    for (const bool around : {false, true}) {
      FlowMeshOptions options = around ? outside(ball, 0.24, 2) : inside(0.24);
      options.refinements = {{{{0.1, -0.6, -0.7}, {1.4, 0.5, 0.3}}, 0.24 * factor}};
      const FlowMesh made = flow_mesh(ball, {}, {}, options);
      expect_sound(made, 1);
      const CellGeometry g = cell_geometry(made.mesh.mesh, cell_faces(made.mesh.mesh));
      for (std::size_t c = 0; c < made.mesh.cells(); ++c) {
        const Box3& b = g.box[c];
        if (g.middle[c].x < 0.2 || g.middle[c].x > 1.3 || std::abs(g.middle[c].y + 0.05) > 0.45 || std::abs(g.middle[c].z + 0.2) > 0.4) continue;
        EXPECT_LE(b.extent().x, 0.24 * factor * 1.8);  // tetrahedra span two cells, and corners may have moved
      }
    }
}

TriangleSoup roughened(TriangleSoup soup, double by, unsigned seed) {
  std::mt19937 engine(seed);
  for (Vec3& p : soup.points)
    for (int a = 0; a < 3; ++a) p[a] += by * (2 * static_cast<double>(engine()) / 4294967296.0 - 1);
  return soup;
}

// A rough surface has ends of creases everywhere, which several nodes of several sizes are near to.
TEST(FlowMesh, CellsOfSeveralSizesMeetAtCreases) {
  const TriangleSoup rough = roughened(icosphere(4), 0.03, 7);
  FlowMeshOptions options = outside(rough, 0.09, 0.6);
  options.refinements = {{{{0, 0, 0}, {1.1, 1.1, 1.1}}, 0.09 * 0.35}};
  const FlowMesh made = flow_mesh(rough, {}, {}, options);
  EXPECT_GT(made.crease_points, 100u);
  expect_sound(made, 1);
}

// A ball with spikes as wide as cells: around points at their tips all cells are flat, wherever these go.
TEST(FlowMesh, WhatCannotBeMendedIsLeftOut) {
  TriangleSoup ball = icosphere(4);
  std::mt19937 engine(1);
  for (Vec3& p : ball.points) {
    if (engine() % 4 != 0) {
      engine();
      continue;
    }
    for (int a = 0; a < 3; ++a) p[a] += 0.1 * (2 * static_cast<double>(engine()) / 4294967296.0 - 1);
  }
  const FlowMesh made = flow_mesh(ball, {}, {}, inside(0.08));
  expect_sound(made, 1);
  EXPECT_TRUE(std::any_of(made.notes.begin(), made.notes.end(), [](const std::string& note) { return note.find("left out") != std::string::npos; }));
  EXPECT_NEAR(volume(made.mesh), signed_volume(ball), 0.01 * signed_volume(ball));
}

// A body of less than eight cells is kept where a refinement has many.
TEST(FlowMesh, SmallBodiesCountByTheirOwnCells) {
  TriangleSoup both = cube();
  const TriangleSoup small = mapped(cube(), [](const Vec3& p) { return p * 0.15 + Vec3{1.8, 0, 0}; });
  const auto first = static_cast<std::uint32_t>(both.points.size());
  both.points.insert(both.points.end(), small.points.begin(), small.points.end());
  for (const auto& f : small.facets) both.facets.push_back({f[0] + first, f[1] + first, f[2] + first});
  FlowMeshOptions options = inside(0.2);
  options.refinements = {{{{1.6, -0.2, -0.2}, {2, 0.2, 0.2}}, 0.025}};
  expect_sound(flow_mesh(both, {}, {}, options), 2);
}

TEST(FlowMesh, LargerCellsWhereItIsFlat) {
  const TriangleSoup box = mapped(cube(), turned);
  FlowMeshOptions options = inside(0.025);
  options.flat_levels = 0;
  const std::size_t uniform = flow_mesh(box, {}, {}, options).mesh.cells();
  for (const int levels : {1, 2}) {
    options.flat_levels = levels;
    const FlowMesh made = flow_mesh(box, {}, {}, options);
    expect_sound(made, 1);
    EXPECT_LT(static_cast<double>(made.mesh.cells()), 0.8 * static_cast<double>(uniform));
    EXPECT_NEAR(volume(made.mesh), signed_volume(box), 3e-3 * signed_volume(box));
  }
}

bool same(const VolumeMesh& a, const VolumeMesh& b) {
  return a.mesh.points == b.mesh.points && a.mesh.face_points == b.mesh.face_points && a.mesh.owner == b.mesh.owner && a.mesh.neighbour == b.mesh.neighbour && a.corners == b.corners &&
         a.shape == b.shape;
}

TEST(FlowMesh, SameBitsForAnyNumberOfThreads) {
  const TriangleSoup solid = mapped(cube(), turned);
  const FlowMeshOptions options = outside(solid, 0.06, 0.8);
  VolumeMesh first;
  for (const int threads : {1, 2, 5}) {
    const ThreadLimit limit(threads);
    FlowMesh made = flow_mesh(solid, {}, {}, options);
    if (threads == 1) first = std::move(made.mesh);
    else EXPECT_TRUE(same(first, made.mesh)) << threads;
  }
}

TEST(FlowMesh, ScalesWithTheModelBitForBit) {
  const TriangleSoup solid = torus(48, 24);
  const VolumeMesh once = flow_mesh(solid, {}, {}, inside(0.09)).mesh;
  VolumeMesh large = flow_mesh(scaled(solid, 1024), {}, {}, inside(0.09 * 1024)).mesh;
  for (Vec3& p : large.mesh.points) p = p / 1024;
  EXPECT_TRUE(same(once, large));
}

ErrorCode code_of(const TriangleSoup& solid, const FlowMeshOptions& options) {
  try {
    flow_mesh(solid, {}, {}, options);
  } catch (const Error& e) {
    return e.code();
  }
  ADD_FAILURE() << "no error";
  return ErrorCode::bug;
}

TEST(FlowMesh, SaysWhatCannotBe) {
  const TriangleSoup ball = icosphere(3);
  EXPECT_EQ(code_of(ball, inside(4)), ErrorCode::guarantee_unmet);
  EXPECT_EQ(code_of(ball, outside(ball, 0.1, 0.2)), ErrorCode::usage);  // two cells between ball and sides
  FlowMeshOptions options = inside(0.01);
  options.memory_bytes = 1 << 20;
  EXPECT_EQ(code_of(ball, options), ErrorCode::memory_limit);
  options = inside(0.1);
  options.refinements = {{{{0, 0, 0}, {1, 1, 1}}, 1e-4}};
  EXPECT_EQ(code_of(ball, options), ErrorCode::usage);
}

}  // namespace
}  // namespace burnish
