// Volume fractions of shapes whose volume is known, on meshes of every kind.
#include "burnish/volume/volume_fraction.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>
#include <string>

#include "support/analytic_shapes.h"
#include "support/volume_meshes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kPi = std::numbers::pi;
// A paraboloid may overshoot where the plane cuts off a corner alone: measured 6.6e-3 of a cell at R/h = 3 (the coarse half of 2:1 meshes), 2e-3 at 6.
constexpr double kOvershoot = 0.01;

SolidField::Front front_at(const PlacedShape& shape, const Vec3& p) {
  const SurfacePoint at = shape.closest(p);
  Vec3 direction = at.direction1;
  if (squared_norm(direction) < 0.5) direction = cross(at.normal, std::abs(at.normal.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0});
  direction = direction / norm(direction);
  return {at.foot, at.normal, direction, cross(at.normal, direction), at.k1, at.k2, true};
}

// Clamped at the band, as level sets are.
SolidField field_of(const PlacedShape& shape, double band) {
  SolidField field;
  field.band = band;
  field.distance = [&shape, band](std::span<const Vec3> points, double* phi) {
    for (const Vec3& p : points) *phi++ = std::clamp(shape.distance(p), -band, band);
  };
  field.front = [&shape](std::span<const Vec3> points, SolidField::Front* fronts) {
    for (const Vec3& p : points) *fronts++ = front_at(shape, p);
  };
  return field;
}

enum class Kind { hexahedra, warped, tetrahedra, two_levels, polyhedra };
PolyhedralMesh mesh_of(Kind kind, double half) {
  const int n = static_cast<int>(std::ceil(half / 2)) * 2;
  const Grid grid = cubic_grid({-double(n), -double(n), -double(n)}, {double(n), double(n), double(n)}, kind == Kind::two_levels ? n : 2 * n);
  switch (kind) {
    case Kind::hexahedra: return hexahedra(grid);
    case Kind::warped: return jittered(hexahedra(grid), grid, 0.2, 4);
    case Kind::tetrahedra: return kuhn_tetrahedra(grid);
    case Kind::two_levels: return two_levels(grid, [](const Vec3& p) { return p.x + 0.4 * p.y > 0; });
    case Kind::polyhedra: break;
  }
  return dual_polyhedra(grid, 0.1, 3);
}
constexpr std::array kKinds{Kind::hexahedra, Kind::warped, Kind::tetrahedra, Kind::two_levels, Kind::polyhedra};

using Method = decltype(&linear_volume_fractions);
// Relative error of the volume of a shape with `size` cells in its smallest radius of curvature.
double volume_error(Method method, const AnalyticShape& unit, double unit_volume, double size, Kind kind) {
  std::mt19937 random(5);
  const PlacedShape shape{&unit, size, random_rotation(random), {0.13, 0.27, -0.31}, 0};
  const PolyhedralMesh mesh = mesh_of(kind, unit.radius() * size + 2);
  const CellFaces faces = cell_faces(mesh);
  const VolumeFractions result = method(mesh, cell_geometry(mesh, faces), faces, field_of(shape, 0.5 * size), {}, no_progress());
  EXPECT_LE(result.worst_clamp, kOvershoot);
  for (const double a : result.alpha) EXPECT_TRUE(a >= 0 && a <= 1);
  return std::abs(result.volume / (unit_volume * size * size * size) - 1);
}

// Errors of single sizes change sign and may be lucky, so both are held against one curve: `bar` at R/h = 6, falling with the order.
void expect_order(Method method, const AnalyticShape& shape, double volume, Kind kind, double finest, double bar, double order) {
  SCOPED_TRACE(shape.name() + ", mesh " + std::to_string(static_cast<int>(kind)));
  EXPECT_LE(volume_error(method, shape, volume, 6, kind), bar);
  EXPECT_LE(volume_error(method, shape, volume, finest, kind), bar * std::pow(6 / finest, order));
}

// `finer`: the bar of the hexahedra up to R/h = 24.
void expect_order_three_of_spheres(Method method, double bar, double finer) {
  const auto sphere = unit_sphere();
  for (const Kind kind : kKinds) expect_order(method, *sphere, 4 * kPi / 3, kind, 12, bar, 3);
  expect_order(method, *sphere, 4 * kPi / 3, Kind::hexahedra, 24, finer, 3);
}

void expect_order_three_of_ellipsoid_and_torus(Method method) {
  const auto ellipsoid = unit_ellipsoid(), torus = unit_torus();
  const double volume = 4 * kPi / 3 * 1.5625 * 1.4 * 1.25;
  for (const Kind kind : {Kind::hexahedra, Kind::tetrahedra, Kind::polyhedra}) expect_order(method, *ellipsoid, volume, kind, 9, 2e-5, 3);
  expect_order(method, *torus, 2 * kPi * kPi * 2.5, Kind::hexahedra, 8, 1e-5, 3);
}

TEST(LinearFractions, SphereConvergesWithOrderThreeOnEveryMesh) { expect_order_three_of_spheres(&linear_volume_fractions, 1e-4, 2e-5); }
TEST(LinearFractions, EllipsoidAndTorusConvergeWithOrderThree) { expect_order_three_of_ellipsoid_and_torus(&linear_volume_fractions); }
TEST(CurvedFractions, SphereConvergesWithOrderThreeOnEveryMesh) { expect_order_three_of_spheres(&curved_volume_fractions, 2e-4, 5e-5); }
TEST(CurvedFractions, EllipsoidAndTorusConvergeWithOrderThree) { expect_order_three_of_ellipsoid_and_torus(&curved_volume_fractions); }

}  // namespace
}  // namespace burnish
