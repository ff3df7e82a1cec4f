#include "burnish/volume/volume_fraction.h"

#include <algorithm>

#include "models.h"
#include "support/shapes.h"
#include "support/volume_meshes.h"

namespace burnish::bench {
namespace {

// A million hexahedra of the box from -1.25 to 1.25, in it a ball of radius 1: 40 cells.
struct Million {
  PolyhedralMesh mesh = test::hexahedra(test::cubic_grid({-1.25, -1.25, -1.25}, {1.25, 1.25, 1.25}, 100));
  CellFaces faces = cell_faces(mesh);
  CellGeometry geometry = cell_geometry(mesh, faces);
};
const Million& million() {
  static const Million cells;
  return cells;
}

void count_cells(benchmark::State& state) { state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * million().mesh.cells)); }

void geometry_of_a_million_cells(benchmark::State& state) {
  const Million& cells = million();
  for (auto _ : state) benchmark::DoNotOptimize(cell_geometry(cells.mesh, cells.faces));
  count_cells(state);
}
BENCHMARK(geometry_of_a_million_cells)->Apply(in_cpu_time);

// 81,920 facets.
void exact_fractions_of_a_million_cells(benchmark::State& state) {
  const Million& cells = million();
  const TriangleSoup ball = test::icosphere(6);
  for (auto _ : state) benchmark::DoNotOptimize(exact_volume_fractions(cells.mesh, cells.geometry, cells.faces, ball));
  count_cells(state);
}
BENCHMARK(exact_fractions_of_a_million_cells)->Apply(in_cpu_time);

SolidField ball_field() {
  SolidField field;
  field.band = 0.2;
  field.distance = [](std::span<const Vec3> points, double* phi) {
    for (const Vec3& p : points) *phi++ = std::clamp(1 - norm(p), -0.2, 0.2);
  };
  field.front = [](std::span<const Vec3> points, SolidField::Front* fronts) {
    for (const Vec3& p : points) {
      const Vec3 n = p / norm(p), across = cross(n, std::abs(n.x) < 0.6 ? Vec3{1, 0, 0} : Vec3{0, 1, 0}), u = across / norm(across);
      *fronts++ = {n, n, u, cross(n, u), 1, 1, true};
    }
  };
  return field;
}

// Without what a distance costs: here it is that of a ball.
void linear_fractions_of_a_million_cells(benchmark::State& state) {
  const Million& cells = million();
  for (auto _ : state) benchmark::DoNotOptimize(linear_volume_fractions(cells.mesh, cells.geometry, cells.faces, ball_field()));
  count_cells(state);
}
BENCHMARK(linear_fractions_of_a_million_cells)->Apply(in_cpu_time);

void curved_fractions_of_a_million_cells(benchmark::State& state) {
  const Million& cells = million();
  for (auto _ : state) benchmark::DoNotOptimize(curved_volume_fractions(cells.mesh, cells.geometry, cells.faces, ball_field()));
  count_cells(state);
}
BENCHMARK(curved_fractions_of_a_million_cells)->Apply(in_cpu_time);

}  // namespace
}  // namespace burnish::bench
