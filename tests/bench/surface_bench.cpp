#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "models.h"

namespace burnish::bench {
namespace {

void count_facets(benchmark::State& state, const TriangleSoup& soup) {
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * soup.facets.size()));
}

void weld_nozzle(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(weld(nozzle_as_read()));
  count_facets(state, nozzle());
}
BENCHMARK(weld_nozzle)->Apply(in_cpu_time);

void inspect_nozzle(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(inspect(nozzle()));
  count_facets(state, nozzle());
}
BENCHMARK(inspect_nozzle)->Apply(in_cpu_time);

void orient_and_cap_nozzle(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(cap_boundary(orient(nozzle()).soup));
  count_facets(state, nozzle());
}
BENCHMARK(orient_and_cap_nozzle)->Apply(in_cpu_time);

void index_nozzle(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(TriangleIndex(nozzle()));
  count_facets(state, nozzle());
}
BENCHMARK(index_nozzle)->Apply(in_cpu_time);

// At points along the diagonal of the box, inside and out.
void winding_number(benchmark::State& state) {
  const TriangleIndex index(nozzle());
  const Box3 box = bounding_box(nozzle());
  double t = 0;
  for (auto _ : state) {
    t += 0.6180339887;
    t -= t >= 1 ? 1 : 0;
    benchmark::DoNotOptimize(index.winding_number(box.lower + box.extent() * t));
  }
}
BENCHMARK(winding_number)->Unit(benchmark::kMicrosecond)->MeasureProcessCPUTime();

void closest_points(benchmark::State& state) {
  const TriangleIndex index(nozzle());
  const CompareOptions options;
  for (auto _ : state) benchmark::DoNotOptimize(one_sided_distance(nozzle(), index, options));
  state.SetItemsProcessed(
      static_cast<std::int64_t>(state.iterations() * (options.area_samples + options.vertex_samples)));
}
BENCHMARK(closest_points)->Apply(in_cpu_time);

}  // namespace
}  // namespace burnish::bench
