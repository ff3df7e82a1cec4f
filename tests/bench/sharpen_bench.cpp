// Sharpening: without creases, where closest points are all there is to it, and with them.
#include "burnish/extract/sharpen.h"

#include <benchmark/benchmark.h>

#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/weld.h"
#include "models.h"

namespace burnish::bench {
namespace {

struct Model {
  TriangleSoup m;
  ReferenceSurface reference;
};

Model model_of(const TriangleSoup& solid, const GridFrame& frame, const CreaseOptions& which) {
  const TriangleSoup s = to_lattice(solid, frame);
  return {extract_surface(level_set_from_triangles(solid, frame).level_set).soup, ReferenceSurface(s, find_creases(s, which))};
}

// A staircase of 16 steps, turned so that nothing lies along the lattice: 48 convex edges across, 16 concave ones.
TriangleSoup staircase() {
  TriangleSoup soup;
  const auto turned = [](double x, double y, double z) { return Vec3{0.8 * x - 0.6 * y, 0.48 * x + 0.64 * y - 0.6 * z, 0.36 * x + 0.48 * y + 0.8 * z}; };
  const auto quad = [&](const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
    const auto first = static_cast<std::uint32_t>(soup.points.size());
    soup.points.insert(soup.points.end(), {a, b, c, d});
    soup.facets.insert(soup.facets.end(), {{first, first + 1, first + 2}, {first, first + 2, first + 3}});
  };
  constexpr int kSteps = 16;
  for (int i = 0; i < kSteps; ++i) {
    const double z = i + 1;
    for (int j = 0; j <= i; ++j) {
      quad(turned(i, 0, j), turned(i + 1, 0, j), turned(i + 1, 0, j + 1), turned(i, 0, j + 1));
      quad(turned(i, kSteps, j), turned(i, kSteps, j + 1), turned(i + 1, kSteps, j + 1), turned(i + 1, kSteps, j));
    }
    quad(turned(kSteps, 0, i), turned(kSteps, kSteps, i), turned(kSteps, kSteps, z), turned(kSteps, 0, z));
    quad(turned(i, 0, z), turned(i + 1, 0, z), turned(i + 1, kSteps, z), turned(i, kSteps, z));
    quad(turned(i, 0, i), turned(i, 0, z), turned(i, kSteps, z), turned(i, kSteps, i));
    quad(turned(i, 0, 0), turned(i, kSteps, 0), turned(i + 1, kSteps, 0), turned(i + 1, 0, 0));
  }
  return weld(soup);
}

void run(benchmark::State& state, const Model& model, bool improve) {
  std::size_t facets = 0;
  for (auto _ : state) {
    benchmark::DoNotOptimize(sharpen(model.m, model.reference, {}, {.improve = improve}));
    facets += model.m.facets.size();
  }
  state.SetItemsProcessed(static_cast<std::int64_t>(facets));
}

void sharpen_without_creases(benchmark::State& state) {
  static const Model model = model_of(knot(), knot_frame(), {.angle = 180});
  run(state, model, state.range(0) != 0);
}
BENCHMARK(sharpen_without_creases)->Arg(0)->Arg(1)->Apply(in_cpu_time);

void sharpen_staircase(benchmark::State& state) {
  static const TriangleSoup solid = staircase();
  static const Model model = model_of(solid, make_frame(bounding_box(solid), bounding_box(solid).longest_side() / 256, 8), {});
  run(state, model, state.range(0) != 0);
}
BENCHMARK(sharpen_staircase)->Arg(0)->Arg(1)->Apply(in_cpu_time);

}  // namespace
}  // namespace burnish::bench
