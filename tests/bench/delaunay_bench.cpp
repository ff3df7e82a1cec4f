// The Delaunay extractor beside marching tetrahedra, all included: seeds, refinement, conversion and checks.
#include <cmath>

#include "burnish/extract/delaunay.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/from_triangles.h"
#include "models.h"

namespace burnish::bench {
namespace {

const LevelSet& knot_level_set() {
  static const LevelSet set = level_set_from_triangles(knot(), knot_frame()).level_set;
  return set;
}

void count(benchmark::State& state, const TriangleSoup& soup) {
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * soup.facets.size()));
  state.counters["facets"] = static_cast<double>(soup.facets.size());
}

// Edges in tenths of a cell.
void delaunay_knot(benchmark::State& state) {
  const DelaunayOptions options{.edge = static_cast<double>(state.range(0)) / 10};
  DelaunaySurface surface;
  for (auto _ : state) surface = extract_delaunay(knot_level_set(), options);
  if (!surface.failure.empty()) state.SkipWithError(surface.failure.c_str());
  count(state, surface.soup);
}
BENCHMARK(delaunay_knot)->Arg(10)->Arg(20)->Apply(in_cpu_time);

// Edges that follow the curvature, chords within a twentieth of a cell.
void delaunay_knot_by_curvature(benchmark::State& state) {
  DelaunaySurface surface;
  for (auto _ : state) surface = extract_delaunay(knot_level_set(), {.edge_tolerance = 0.05});
  if (!surface.failure.empty()) state.SkipWithError(surface.failure.c_str());
  count(state, surface.soup);
}
BENCHMARK(delaunay_knot_by_curvature)->Apply(in_cpu_time);

void marching_knot(benchmark::State& state) {
  TriangleSoup soup;
  for (auto _ : state) soup = extract_surface(knot_level_set()).soup;
  count(state, soup);
}
BENCHMARK(marching_knot)->Apply(in_cpu_time);

void predict_knot(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(predicted_facets(knot_level_set()));
}
BENCHMARK(predict_knot)->Apply(in_cpu_time);

}  // namespace
}  // namespace burnish::bench
