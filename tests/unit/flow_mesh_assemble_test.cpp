// From cells to faces: every shape on every other one, over every pair of faces and in every turn, with exact volumes; and all that a lattice of several sizes makes.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <random>
#include <set>
#include <string>
#include <vector>

#include "assemble.h"
#include "burnish/core/error.h"
#include "burnish/volume/flow_mesh.h"
#include "burnish/volume/mesh_quality.h"
#include "numbering.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

using Loop = std::vector<std::uint32_t>;

// A cell with its points 0, 1, ...
struct Piece {
  std::string name;
  CellShape shape;
  std::uint32_t points;
  std::vector<Loop> faces;  // normals outwards
};

Piece piece_of(std::string name, CellShape shape, std::uint32_t points) {
  Piece p{std::move(name), shape, points, {}};
  for (const std::array<int, 4>& f : faces_of_shape(shape)) {
    Loop loop;
    for (const int i : f)
      if (i >= 0) loop.push_back(static_cast<std::uint32_t>(i));
    p.faces.push_back(loop);
  }
  return p;
}

std::vector<Piece> pieces() {
  std::vector<Piece> all{piece_of("tetrahedron", CellShape::tetrahedron, 4), piece_of("pyramid", CellShape::pyramid, 5), piece_of("wedge", CellShape::wedge, 6),
                         piece_of("hexahedron", CellShape::hexahedron, 8)};
  Piece cube = all.back();
  cube.name = "cube as a polyhedron", cube.shape = CellShape::polyhedron;
  all.push_back(cube);
  // The upper face in four, as beside finer cells: points 8 to 11 in the middle of its edges, 12 in its own.
  Piece split{"cube beside finer ones", CellShape::polyhedron, 13, {}};
  for (const Loop& f : cube.faces) {
    Loop with_middles;
    for (std::size_t i = 0; i < 4; ++i) {
      const std::uint32_t a = f[i], b = f[(i + 1) % 4];
      with_middles.push_back(a);
      if (a >= 4 && b >= 4) with_middles.push_back(8 + ((a + 1) % 4 == b % 4 ? a - 4 : b - 4));
    }
    if (with_middles.size() < 8) {
      split.faces.push_back(with_middles);
      continue;
    }
    for (std::size_t i = 0; i < 8; i += 2) split.faces.push_back({with_middles[i], with_middles[i + 1], 12, with_middles[(i + 7) % 8]});
  }
  all.push_back(split);
  // A pyramid over a square with divided sides.
  Piece fan{"pyramid over eight points", CellShape::polyhedron, 9, {{7, 6, 5, 4, 3, 2, 1, 0}}};
  for (std::uint32_t i = 0; i < 8; ++i) fan.faces.push_back({i, (i + 1) % 8, 8});
  all.push_back(fan);
  return all;
}

void append(const Piece& p, const std::vector<std::uint32_t>& number, CellList& cells) {
  cells.shape.push_back(p.shape);
  if (p.shape == CellShape::polyhedron) {
    cells.corners.push_back(static_cast<std::uint32_t>(p.faces.size()));
    for (const Loop& f : p.faces) {
      cells.corners.push_back(static_cast<std::uint32_t>(f.size()));
      for (const std::uint32_t i : f) cells.corners.push_back(number[i]);
    }
  } else {
    for (std::uint32_t i = 0; i < p.points; ++i) cells.corners.push_back(number[i]);
  }
  cells.first.push_back(cells.corners.size());
}

// An integer for integer points, odd in the loop's direction and the same wherever it begins: of n points, 6 n times the volume of the cone over it from the origin, mean of the triangulations
// by fans.
template <class Points>
long long cone(const Loop& loop, const Points& at) {
  long long sum = 0;
  const std::size_t n = loop.size();
  for (std::size_t s = 0; s < n; ++s)
    for (std::size_t i = 1; i + 1 < n; ++i) {
      const Vec3 a = at(loop[s]), b = at(loop[(s + i) % n]), c = at(loop[(s + i + 1) % n]);
      sum += static_cast<long long>(dot(a, cross(b, c)));
    }
  return sum * (840 / static_cast<long long>(n));
}

// 6 * 840 volumes of each cell, by its own faces in `cells`.
long long volume_of(const Piece& p, const std::vector<std::uint32_t>& number, const std::vector<Vec3>& points) {
  long long sum = 0;
  for (const Loop& f : p.faces) sum += cone(f, [&](std::uint32_t i) { return points[number[i]]; });
  return sum;
}

// Owner below neighbour, in upper triangular order, and each cell closed: every edge of it in two of its faces, once each way. The volumes of cells, times 6 * 840.
// Polyhedra on both sides of a divided edge have two faces in common, one for each half of it; others have one.
std::vector<long long> expect_well_formed(const VolumeMesh& volume, MeshFlavour flavour = MeshFlavour::conforming) {
  const PolyhedralMesh& mesh = volume.mesh;
  std::vector<long long> volumes(mesh.cells, 0);
  std::vector<std::map<std::pair<std::uint32_t, std::uint32_t>, int>> edges(mesh.cells);
  std::set<std::uint32_t> used;
  for (std::size_t f = 0; f < mesh.faces(); ++f) {
    const auto face = mesh.face(f);
    const Loop loop(face.begin(), face.end());
    used.insert(loop.begin(), loop.end());
    const auto count = [&](std::uint32_t cell, int sign) {
      volumes[cell] += sign * cone(loop, [&](std::uint32_t p) { return mesh.points[p]; });
      for (std::size_t i = 0; i < loop.size(); ++i) {
        const std::uint32_t a = loop[i], b = loop[(i + 1) % loop.size()];
        ++edges[cell][sign > 0 ? std::pair{a, b} : std::pair{b, a}];
      }
    };
    count(mesh.owner[f], 1);
    if (f >= mesh.internal_faces()) continue;
    count(mesh.neighbour[f], -1);
    EXPECT_LT(mesh.owner[f], mesh.neighbour[f]);
    if (f > 0) {
      const std::pair before(mesh.owner[f - 1], mesh.neighbour[f - 1]), here(mesh.owner[f], mesh.neighbour[f]);
      EXPECT_LE(before, here);
      EXPECT_TRUE(before != here || (flavour == MeshFlavour::polyhedral && volume.shape[here.first] == CellShape::polyhedron && volume.shape[here.second] == CellShape::polyhedron));
    }
  }
  for (const auto& of_cell : edges)
    for (const auto& [edge, times] : of_cell) {
      const auto back = of_cell.find({edge.second, edge.first});
      EXPECT_TRUE(times == 1 && back != of_cell.end() && back->second == 1);
    }
  EXPECT_EQ(used.size(), mesh.points.size());
  return volumes;
}

TEST(FlowMeshAssemble, EveryShapeOnEveryOtherOverEveryPairOfFaces) {
  std::mt19937 engine(3);
  int pairs = 0;
  for (const Piece& a : pieces())
    for (const Piece& b : pieces())
      for (std::size_t fa = 0; fa < a.faces.size(); ++fa)
        for (std::size_t fb = 0; fb < b.faces.size(); ++fb)
          for (std::size_t turn = 0; a.faces[fa].size() == b.faces[fb].size() && turn < a.faces[fa].size(); ++turn) {
            SCOPED_TRACE(a.name + " " + std::to_string(fa) + ", " + b.name + " " + std::to_string(fb) + ", turn " + std::to_string(turn));
            // b's face is run the other way round.
            std::vector<std::uint32_t> of_a(a.points), of_b(b.points, ~0u);
            for (std::uint32_t i = 0; i < a.points; ++i) of_a[i] = i + 1;  // point 0 is of no cell
            const Loop &la = a.faces[fa], &lb = b.faces[fb];
            for (std::size_t i = 0; i < la.size(); ++i) of_b[lb[i]] = of_a[la[(2 * la.size() - i + turn) % la.size()]];
            std::uint32_t next = a.points + 1;
            for (std::uint32_t& n : of_b)
              if (n == ~0u) n = next++;
            std::vector<Vec3> points(next);
            for (Vec3& p : points) p = {double(engine() % 41) - 20, double(engine() % 41) - 20, double(engine() % 41) - 20};
            CellList cells;
            append(a, of_a, cells);
            append(b, of_b, cells);
            std::vector<std::uint32_t> source;
            const VolumeMesh made = assemble(points, cells, &source);
            ASSERT_EQ(made.mesh.internal_faces(), 1u);
            EXPECT_EQ(made.mesh.faces(), a.faces.size() + b.faces.size() - 1);
            EXPECT_EQ(count_half_faces(cells), a.faces.size() + b.faces.size());
            ASSERT_EQ(made.mesh.points.size(), next - 1u);
            for (std::size_t p = 0; p < source.size(); ++p) EXPECT_EQ(made.mesh.points[p], points[source[p]]);
            const std::vector<long long> volumes = expect_well_formed(made);
            EXPECT_EQ(volumes[0], volume_of(a, of_a, points));
            EXPECT_EQ(volumes[1], volume_of(b, of_b, points));
            std::vector<std::uint32_t> part;
            EXPECT_EQ(connected_parts(made.mesh, part), 1u);
            ++pairs;
          }
  EXPECT_GT(pairs, 1500);
}

// Polygons with points in the middle of their sides may have three of them in common, and are two faces all the same.
TEST(FlowMeshAssemble, FacesThatShareThreePointsStayApart) {
  CellList cells;
  const std::vector<Vec3> points{{0, 0, 0}, {2, 0, 0}, {2, 2, 0}, {0, 2, 0}, {1, 0, 0}, {1, 1, 2}, {1, 1, -2}};
  // A pyramid over 0 4 1 2 3 above, a pyramid over 0 1 2 3 below: they do not fit.
  cells.shape.push_back(CellShape::polyhedron);
  cells.corners = {6, 5, 3, 2, 1, 4, 0, 3, 0, 4, 5, 3, 4, 1, 5, 3, 1, 2, 5, 3, 2, 3, 5, 3, 3, 0, 5};
  cells.first.push_back(cells.corners.size());
  cells.add(CellShape::pyramid, {3, 2, 1, 0, 6});
  EXPECT_EQ(assemble(points, cells).mesh.internal_faces(), 0u);
}

TEST(FlowMeshAssemble, AFaceOfThreeCellsIsRefused) {
  CellList cells;
  for (const std::uint32_t apex : {3u, 4u, 5u}) cells.add(CellShape::tetrahedron, {0, 1, 2, apex});
  EXPECT_THROW(assemble(std::vector<Vec3>(6), cells), Error);
}

TEST(FlowMeshAssemble, WhatThirtyTwoBitsDoNotNumberIsRefused) {
  EXPECT_NO_THROW(require_numbers(0xffffffffu, "points"));
  try {
    require_numbers(0x100000000u, "points");
    ADD_FAILURE() << "was not refused";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::memory_limit);
    EXPECT_NE(std::string(e.what()).find("4294967296 points"), std::string::npos) << e.what();
  }
}

// Boxes of finer cells at all places of a small lattice, so that cells of all sizes meet over faces, edges and corners, and with the surface.
TEST(FlowMeshAssemble, WhatALatticeOfSeveralSizesMakes) {
  const TriangleSoup ball = icosphere(2);
  FlowMeshOptions options;
  options.cell = 0.6;
  options.side = MeshSide::outside;
  options.domain = {{-4.4, -4.4, -4.4}, {4.4, 4.4, 4.4}};
  options.coarsest_level = 1;
  options.cells_between_levels = 1;
  std::set<CellShape> shapes;
  for (const MeshFlavour flavour : {MeshFlavour::conforming, MeshFlavour::polyhedral})
    for (const double half : {0.05, 0.7})
      for (int place = 0; place < 27; ++place) {
        const Vec3 at{(place % 3 - 1) * 1.3, (place / 3 % 3 - 1) * 1.3, (place / 9 - 1) * 1.3};
        SCOPED_TRACE(place);
        options.flavour = flavour;
        options.refinements = {{{at - Vec3{half, half, half}, at + Vec3{half, half, half}}, 0.3}};
        const FlowMesh made = flow_mesh(ball, {}, {}, options);
        shapes.insert(made.mesh.shape.begin(), made.mesh.shape.end());
        VolumeMesh mesh = made.mesh;
        // Exact: integers for coordinates.
        for (Vec3& p : mesh.mesh.points) p = {std::round(p.x * 1e3), std::round(p.y * 1e3), std::round(p.z * 1e3)};
        long long sum = 0, enclosed = 0;
        for (const long long v : expect_well_formed(mesh, flavour)) {
          EXPECT_GT(v, 0);
          sum += v;
        }
        for (std::size_t f = mesh.mesh.internal_faces(); f < mesh.mesh.faces(); ++f) {
          const auto face = mesh.mesh.face(f);
          enclosed += cone(Loop(face.begin(), face.end()), [&](std::uint32_t p) { return mesh.mesh.points[p]; });
        }
        EXPECT_EQ(sum, enclosed);
        EXPECT_NEAR(static_cast<double>(sum) / (6 * 840 * 1e9), 8.8 * 8.8 * 8.8 - signed_volume(ball), 0.15 * signed_volume(ball));  // the ball is three cells wide
      }
  EXPECT_EQ(shapes.size(), 5u);
}

}  // namespace
}  // namespace burnish
