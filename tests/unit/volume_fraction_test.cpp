#include "burnish/volume/volume_fraction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <random>
#include <string>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/example_shapes.h"
#include "burnish/surface/weld.h"
#include "support/parts.h"
#include "support/shapes.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

using namespace test;

struct Cells {
  explicit Cells(PolyhedralMesh m) : mesh(std::move(m)), faces(cell_faces(mesh)), geometry(cell_geometry(mesh, faces)) {}
  VolumeFractions exact(const TriangleSoup& solid) const { return exact_volume_fractions(mesh, geometry, faces, solid); }
  double volume() const {
    double sum = 0;
    for (const double v : geometry.volume) sum += v;
    return sum;
  }
  PolyhedralMesh mesh;
  CellFaces faces;
  CellGeometry geometry;
};

struct NamedMesh {
  std::string name;
  Cells cells;
};

// All kinds of the box from -1.5 to 1.5, about n cells a side.
std::vector<NamedMesh> all_meshes(int n) {
  const Grid grid = cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, n);
  const auto fine = [](const Vec3& p) { return p.x + 0.3 * p.y > 0.1; };
  std::vector<NamedMesh> meshes;
  meshes.push_back({"hexahedra", Cells(hexahedra(grid))});
  meshes.push_back({"warped hexahedra", Cells(jittered(hexahedra(grid), grid, 0.2, 11))});
  meshes.push_back({"tetrahedra", Cells(kuhn_tetrahedra(grid))});
  meshes.push_back({"two levels", Cells(two_levels(grid, fine))});
  meshes.push_back({"warped two levels", Cells(jittered(two_levels(grid, fine), grid, 0.1, 12))});
  meshes.push_back({"polyhedra", Cells(dual_polyhedra(grid))});
  meshes.push_back({"warped polyhedra", Cells(dual_polyhedra(grid, 0.15, 13))});
  return meshes;
}

void expect_fractions(const VolumeFractions& result) {
  EXPECT_EQ(result.clamped, 0u) << result.worst_clamp;
  for (const double a : result.alpha) {
    ASSERT_GE(a, 0);
    ASSERT_LE(a, 1);
  }
}

void expect_volume(const VolumeFractions& result, double volume, const std::string& name) {
  SCOPED_TRACE(name);
  expect_fractions(result);
  EXPECT_NEAR(result.volume / volume, 1, 1e-12);
}

TriangleSoup box_between(const Vec3& lower, const Vec3& upper) {
  return mapped(cube(), [&](const Vec3& p) {
    const Vec3 e = upper - lower;
    return Vec3{p.x == 0 ? lower.x : p.x == 1 ? upper.x : lower.x + p.x * e.x, p.y == 0 ? lower.y : upper.y, p.z == 0 ? lower.z : upper.z};
  });
}

TEST(VolumeMeshes, FillTheirBox) {
  for (const NamedMesh& m : all_meshes(5)) {
    SCOPED_TRACE(m.name);
    EXPECT_NEAR(m.cells.volume(), 27, 1e-12);
    for (const double v : m.cells.geometry.volume) EXPECT_GT(v, 0);
    for (std::size_t f = 0; f < m.cells.mesh.internal_faces(); ++f) EXPECT_LT(m.cells.mesh.owner[f], m.cells.mesh.neighbour[f]);
  }
  EXPECT_EQ(dual_polyhedra(cubic_grid({}, {1, 1, 1}, 5)).cells, 216u);
}

TEST(ExactFractions, SphereHasItsOwnVolumeOnEveryMesh) {
  const TriangleSoup sphere = moved(icosphere(3), {0.013, -0.021, 0.007});
  for (const NamedMesh& m : all_meshes(7)) expect_volume(m.cells.exact(sphere), signed_volume(sphere), m.name);
}

TEST(ExactFractions, EllipsoidTorusAndKnotHaveTheirOwnVolumes) {
  const TriangleSoup ellipsoid = mapped(icosphere(3), [](const Vec3& p) { return Vec3{1.4 * p.x, 0.7 * p.y + 0.2 * p.z, 0.9 * p.z}; });
  const TriangleSoup knot = scaled(make_example(ExampleShape::knot, {}).truth, 0.25);
  const Box3 box = bounding_box(knot);
  const TriangleSoup centred = moved(knot, box.center() * -1.0);
  ASSERT_LT(box.longest_side(), 3);
  for (const NamedMesh& m : all_meshes(6)) {
    expect_volume(m.cells.exact(ellipsoid), signed_volume(ellipsoid), m.name);
    expect_volume(m.cells.exact(torus(40, 20)), signed_volume(torus(40, 20)), m.name);
    if (m.name.starts_with("warped")) expect_volume(m.cells.exact(centred), signed_volume(centred), m.name);
  }
}

TEST(ExactFractions, CubeOnTheFacesOfCellsFillsThemWhole) {
  const Cells cells(hexahedra(cubic_grid({0, 0, 0}, {1, 1, 1}, 10)));
  const double a = cells.mesh.points[2].x, b = cells.mesh.points[7].x;  // as the mesh has 0.2 and 0.7
  const VolumeFractions result = cells.exact(box_between({a, a, a}, {b, b, b}));
  expect_volume(result, (b - a) * (b - a) * (b - a), "aligned");
  for (int k = 0; k < 10; ++k)
    for (int j = 0; j < 10; ++j)
      for (int i = 0; i < 10; ++i) {
        const auto in = [](int n) { return n >= 2 && n < 7; };
        EXPECT_EQ(result.alpha[static_cast<std::size_t>(i + 10 * (j + 10 * k))], in(i) && in(j) && in(k) ? 1.0 : 0.0);
      }
}

TEST(ExactFractions, FacetsInInnerPlanesAndEdgesThroughPointsAreRight) {
  // On the middles of cells, where all their tetrahedra meet; diagonals of the cube's faces run through mesh points.
  const Grid grid = cubic_grid({-1, -1, -1}, {1, 1, 1}, 8);
  const auto fine = [](const Vec3& p) { return p.z > 0; };
  for (const Cells& cells : {Cells(hexahedra(grid)), Cells(kuhn_tetrahedra(grid)), Cells(two_levels(grid, fine)), Cells(dual_polyhedra(grid))}) {
    expect_volume(cells.exact(box_between({-0.625, -0.625, -0.625}, {0.625, 0.625, 0.625})), 1.25 * 1.25 * 1.25, "on middles");
    expect_volume(cells.exact(box_between({-0.5, -0.625, -0.75}, {0.5, 0.625, 0.75})), 1.0 * 1.25 * 1.5, "on both");
    const TriangleSoup octahedron = mapped(icosphere(0), [](const Vec3& p) { return p; });
    expect_volume(cells.exact(octahedron), signed_volume(octahedron), "icosahedron");
  }
}

TEST(ExactFractions, LargeFacetsAcrossManyCells) {
  const TriangleSoup tilted = tetrahedron({-1.4, -1.3, -1.2}, {1.3, -0.9, -1.1}, {0.1, 1.4, -0.8}, {0.2, 0.1, 1.4});
  const TriangleSoup solid = signed_volume(tilted) > 0 ? tilted : flipped(tilted);
  for (const NamedMesh& m : all_meshes(9)) expect_volume(m.cells.exact(solid), signed_volume(solid), m.name);
  const TriangleSoup far = tetrahedron({-100, -100, 0.1}, {0, 100, 0.2}, {100, -100, -0.3}, {0, 0, -100});
  const Cells cells(hexahedra(cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 4)));
  const Cells fine(hexahedra(cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 9)));
  const TriangleSoup plane = signed_volume(far) > 0 ? far : flipped(far);
  EXPECT_NEAR(cells.exact(plane).volume, fine.exact(plane).volume, 1e-11);
}

TEST(ExactFractions, SingleCellsByHand) {
  const Cells one(hexahedra(cubic_grid({0, 0, 0}, {1, 1, 1}, 1)));
  // A corner cut off: 1/6 of the cube of its legs.
  const TriangleSoup corner = tetrahedron({-1, -1, -1}, {-1, 3.75, -1}, {3.75, -1, -1}, {-1, -1, 3.75});  // x + y + z <= 1.75
  EXPECT_NEAR(one.exact(corner).alpha[0], 1 - 1.25 * 1.25 * 1.25 / 6 + 3 * 0.25 * 0.25 * 0.25 / 6, 1e-14);
  // Half: through the middle of the cell.
  EXPECT_NEAR(one.exact(box_between({-1, -1, -1}, {0.5, 2, 2})).alpha[0], 0.5, 1e-15);
  EXPECT_NEAR(one.exact(box_between({-1, -1, -1}, {1e-9, 2, 2})).alpha[0], 1e-9, 1e-15);
  // A wedge with its edge in the cell.
  EXPECT_NEAR(one.exact(box_between({-1, -1, -1}, {0.3, 0.4, 2})).alpha[0], 0.12, 1e-15);
  EXPECT_NEAR(one.exact(box_between({0.25, 0.25, 0.25}, {0.75, 0.75, 2})).alpha[0], 0.25 * 0.75, 1e-15);
}

TEST(ExactFractions, WholeBodiesInOneCellCountWithCavities) {
  const Cells cells(hexahedra(cubic_grid({-2, -2, -2}, {2, 2, 2}, 1)));
  TriangleSoup bodies = merged(scaled(icosphere(2), 0.5), flipped(scaled(icosphere(2), 0.25)));  // a shell about the middle
  bodies = merged(bodies, moved(scaled(icosphere(1), 0.01), {1, 1, 1}));
  expect_volume(cells.exact(bodies), signed_volume(bodies), "shell and crumb");
  const TriangleSoup crumb = moved(scaled(icosphere(1), 0.01), {1.1, -0.3, 0.2});
  expect_volume(cells.exact(crumb), signed_volume(crumb), "crumb alone");
}

TEST(ExactFractions, SeveralBodiesAndACavityOnEveryMesh) {
  TriangleSoup solid = merged(scaled(icosphere(3), 1.2), flipped(moved(scaled(icosphere(2), 0.5), {0.3, 0.1, 0})));
  solid = merged(solid, moved(scaled(icosphere(2), 0.2), {0.3, 0.1, 0}));
  for (const NamedMesh& m : all_meshes(5)) expect_volume(m.cells.exact(solid), signed_volume(solid), m.name);
}

TEST(ExactFractions, MeshThatHoldsAPartOfTheSolid) {
  const TriangleSoup sphere = scaled(icosphere(4), 4);
  for (const NamedMesh& m : all_meshes(3)) {
    const VolumeFractions inside = m.cells.exact(sphere);
    EXPECT_NEAR(inside.volume, 27, 1e-12);
    EXPECT_EQ(inside.mixed, 0u);
    for (const double a : inside.alpha) EXPECT_EQ(a, 1);
    // An eighth of the box, cut at planes that are not the mesh's.
    expect_volume(m.cells.exact(box_between({0.1, 0.2, 0.3}, {9, 9, 9})), 1.4 * 1.3 * 1.2, m.name);
    expect_volume(m.cells.exact(box_between({-9, -9, -9}, {0, 9, 9})), 13.5, m.name);
  }
}

TEST(ExactFractions, ComplementHasTheRest) {
  const TriangleSoup sphere = moved(icosphere(3), {0.1, 0.2, 0.3});
  const TriangleSoup rest = merged(box_between({-3, -3, -3}, {3, 3, 3}), flipped(sphere));
  for (const NamedMesh& m : all_meshes(6)) {
    const VolumeFractions in = m.cells.exact(sphere), out = m.cells.exact(rest);
    for (std::size_t c = 0; c < in.alpha.size(); ++c) ASSERT_NEAR(in.alpha[c] + out.alpha[c], 1, 1e-12) << m.name << " cell " << c;
  }
}

TEST(ExactFractions, DoNotMoveWithTheMesh) {
  // A mesh in mm, far from the origin: coordinates have lost four digits.
  const Grid grid = cubic_grid({998.5, 998.5, -1001.5}, {1001.5, 1001.5, -998.5}, 9);
  const Cells cells(hexahedra(grid));
  const TriangleSoup sphere = moved(icosphere(3), {1000, 1000, -1000});
  const VolumeFractions result = cells.exact(sphere);
  expect_fractions(result);
  EXPECT_NEAR(result.volume / signed_volume(sphere), 1, 1e-11);
}

TEST(ExactFractions, SameBitsForAnyNumberOfThreads) {
  const Cells cells(jittered(hexahedra(cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 12)), cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 12), 0.2, 3));
  const auto with_threads = [&](int n) {
    const ThreadLimit limit(n);
    return cells.exact(icosphere(4));
  };
  const VolumeFractions one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.alpha, four.alpha);
  EXPECT_EQ(one.volume, four.volume);
}

TEST(ExactFractions, OpenSurfaceIsRefused) {
  const Cells cells(hexahedra(cubic_grid({-1, -1, -1}, {1, 1, 1}, 2)));
  EXPECT_THROW(cells.exact(without_facets(icosphere(1), {3})), Error);
  EXPECT_THROW(cells.exact({}), Error);
}

TEST(PositiveShare, ByHand) {
  EXPECT_DOUBLE_EQ(positive_share(1, -1, -1, -1), 0.125);
  EXPECT_DOUBLE_EQ(positive_share(-1, 1, -1, 1), 0.5);
  EXPECT_DOUBLE_EQ(positive_share(1, 1, -1, 1), 0.875);
  EXPECT_DOUBLE_EQ(positive_share(-1, -2, 3, -3), 0.75 * 0.6 * 0.5);
  EXPECT_EQ(positive_share(-1, -2, 0, -3), 0);
  EXPECT_EQ(positive_share(1, 2, 0.5, 3), 1);
  EXPECT_EQ(positive_share(0, 0, 0, 0), 0);
  // Two corners, one of them nearly zero: as one corner.
  EXPECT_NEAR(positive_share(2, 1e-300, -1, -3), 2.0 / 3 * 2.0 / 5, 1e-15);
  EXPECT_DOUBLE_EQ(positive_share(1e-6, -1, -1, -1) * 1e18, 1 / std::pow(1 + 1e-6, 3));
}

TEST(PositiveShare, IsContinuousAndTheRestIsTheNegative) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> value(-1, 1);
  for (int i = 0; i < 1000; ++i) {
    const double a = value(random), b = value(random), c = value(random), d = value(random), step = 1e-9;
    EXPECT_NEAR(positive_share(a, b, c, d) + positive_share(-a, -b, -c, -d), 1, 1e-14);
    EXPECT_NEAR(positive_share(a, b, c, step), positive_share(a, b, c, -step), 1e-6);
    EXPECT_LE(positive_share(a, b, c, d), positive_share(a, b, c, d + step) + 1e-15);
  }
}

using Distance = std::function<double(const Vec3&)>;
SolidField field_of(const Distance& distance, double band) {
  SolidField field;
  field.band = band;
  field.distance = [distance, band](std::span<const Vec3> points, double* phi) {
    for (const Vec3& p : points) *phi++ = std::clamp(distance(p), -band, band);
  };
  return field;
}

// Positive inside [-half, half].
Distance box_distance(const Vec3& half) {
  return [half](const Vec3& p) {
    const Vec3 q{std::abs(p.x) - half.x, std::abs(p.y) - half.y, std::abs(p.z) - half.z};
    return -norm(max(q, Vec3{})) - std::min(std::max({q.x, q.y, q.z}), 0.0);
  };
}
Distance ball_distance(double radius) {
  return [radius](const Vec3& p) { return radius - norm(p - Vec3{0.03, -0.02, 0.01}); };
}

VolumeFractions linear(const Cells& c, const SolidField& field) { return linear_volume_fractions(c.mesh, c.geometry, c.faces, field); }

TEST(LinearFractions, PlaneIsExactOnEveryMesh) {
  const Vec3 normal = Vec3{0.6, 0.48, 0.64};
  const Cells one(hexahedra(cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 1)));
  const Distance plane = [&](const Vec3& p) { return dot(normal, p) - 0.17; };
  const double volume = linear(one, field_of(plane, 99)).volume;
  for (const NamedMesh& m : all_meshes(5)) expect_volume(linear(m.cells, field_of(plane, 0.8)), volume, m.name);
}

TEST(LinearFractions, AreZeroAndOneOffTheSurface) {
  for (const NamedMesh& m : all_meshes(6)) {
    const VolumeFractions result = linear(m.cells, field_of(ball_distance(1), 0.9));
    expect_fractions(result);
    for (std::size_t c = 0; c < m.cells.mesh.cells; ++c) {
      const double at = ball_distance(1)(m.cells.geometry.middle[c]), reach = norm(m.cells.geometry.box[c].extent());
      if (std::abs(at) > reach) {
        ASSERT_EQ(result.alpha[c], at > 0 ? 1.0 : 0.0);
      }
    }
  }
}

TEST(LinearFractions, BoxWithItsEdgesAndThinWalls) {
  for (const NamedMesh& m : all_meshes(8)) {
    SCOPED_TRACE(m.name);
    const VolumeFractions box = linear(m.cells, field_of(box_distance({0.83, 0.71, 0.6}), 0.8));
    expect_fractions(box);
    EXPECT_NEAR(box.volume / (8 * 0.83 * 0.71 * 0.6), 1, 1e-3);
    // A third of a cell thick.
    const VolumeFractions wall = linear(m.cells, field_of(box_distance({0.83, 0.71, 0.06}), 0.8));
    expect_fractions(wall);
    EXPECT_NEAR(wall.volume / (8 * 0.83 * 0.71 * 0.06), 1, 2e-2);
  }
}

TEST(LinearFractions, ComplementHasTheRest) {
  for (const NamedMesh& m : all_meshes(6)) {
    const VolumeFractions in = linear(m.cells, field_of(ball_distance(1), 0.8));
    const VolumeFractions out = linear(m.cells, field_of([](const Vec3& p) { return -ball_distance(1)(p); }, 0.8));
    for (std::size_t c = 0; c < in.alpha.size(); ++c) ASSERT_NEAR(in.alpha[c] + out.alpha[c], 1, 1e-12) << m.name << " cell " << c;
  }
}

TEST(LinearFractions, BandShorterThanCellsIsDividedFor) {
  const Cells cells(hexahedra(cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 5)));
  const VolumeFractions result = linear(cells, field_of(ball_distance(1), 0.25));  // cells of 0.6
  expect_fractions(result);
  EXPECT_NEAR(result.volume / (4 * std::numbers::pi / 3), 1, 1e-3);
}

TEST(CurvedFractions, KinksAreLeftToTheLinearMethod) {
  // The closest point on a box, as if all of it were flat.
  const Vec3 half{0.83, 0.71, 0.6};
  SolidField field = field_of(box_distance(half), 0.8);
  field.front = [half](std::span<const Vec3> points, SolidField::Front* fronts) {
    for (const Vec3& p : points) {
      const Vec3 q{half.x - std::abs(p.x), half.y - std::abs(p.y), half.z - std::abs(p.z)};
      const int axis = q.x <= q.y && q.x <= q.z ? 0 : q.y <= q.z ? 1 : 2;
      SolidField::Front& front = *fronts++;
      front = {p, {}, {}, {}, 0, 0, true};
      front.foot[axis] = std::copysign(half[axis], p[axis]);
      front.normal[axis] = std::copysign(1.0, p[axis]);
      front.direction1[(axis + 1) % 3] = front.direction2[(axis + 2) % 3] = 1;
    }
  };
  for (const NamedMesh& m : all_meshes(8)) {
    const VolumeFractions box = curved_volume_fractions(m.cells.mesh, m.cells.geometry, m.cells.faces, field);
    expect_fractions(box);
    EXPECT_NEAR(box.volume / (8 * 0.83 * 0.71 * 0.6), 1, 1e-3) << m.name;
  }
}

TEST(LinearFractions, SameBitsForAnyNumberOfThreads) {
  const Cells cells(hexahedra(cubic_grid({-1.5, -1.5, -1.5}, {1.5, 1.5, 1.5}, 16)));
  const auto with_threads = [&](int n) {
    const ThreadLimit limit(n);
    return linear(cells, field_of(ball_distance(1), 0.5));
  };
  const VolumeFractions one = with_threads(1), four = with_threads(4);
  EXPECT_EQ(one.alpha, four.alpha);
  EXPECT_EQ(one.volume, four.volume);
}

}  // namespace
}  // namespace burnish
