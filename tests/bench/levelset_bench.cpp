// The knot with 256 cells along its longest side.
#include <functional>

#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/crossings.h"
#include "burnish/levelset/distance.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/levelset/redistance.h"
#include "burnish/levelset/sign.h"
#include "burnish/levelset/smooth/mean_curvature_flow.h"
#include "burnish/levelset/smooth/smoothing.h"
#include "models.h"

namespace burnish::bench {
namespace {

const SurfaceOctree& grid() {
  static const SurfaceOctree grid = grow_uniform_band(lattice_knot(), knot_frame().depth, kBand);
  return grid;
}

const LevelSet& level_set() {
  static const LevelSet set =
      level_set_from_triangles(knot(), knot_frame(), {.band = kFlowBand, .room = kBlockSide, .far_field = false}).level_set;
  return set;
}

std::size_t nodes_near_surface(const SurfaceOctree& of) {
  std::size_t near = 0;
  for (std::size_t leaf = 0; leaf < of.octree.size(); ++leaf) near += of.near_surface(leaf);
  return near * kBlockNodes;
}

std::size_t finest_nodes(const SurfaceOctree& of) {
  std::size_t finest = 0;
  for (std::size_t leaf = 0; leaf < of.octree.size(); ++leaf) finest += of.octree.level(leaf) == 0;
  return finest * kBlockNodes;
}

// CPU time per node near the surface, and how many nodes the coarser levels hold, which cost memory and no distances.
void count_nodes(benchmark::State& state, const SurfaceOctree& of) {
  using benchmark::Counter;
  const std::size_t near = nodes_near_surface(of);
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * near));
  state.counters["seconds_per_node"] = Counter(static_cast<double>(near), Counter::kIsIterationInvariantRate | Counter::kInvert);
  state.counters["coarser_nodes"] = static_cast<double>(of.octree.size() * kBlockNodes - finest_nodes(of));
}

void grow_octree(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(grow_uniform_band(lattice_knot(), knot_frame().depth, kBand));
  count_nodes(state, grid());
}
BENCHMARK(grow_octree)->Apply(in_cpu_time);

void exact_distances(benchmark::State& state) {
  for (auto _ : state) benchmark::DoNotOptimize(burnish::exact_distances(lattice_knot(), grid(), kBand));
  count_nodes(state, grid());
}
BENCHMARK(exact_distances)->Apply(in_cpu_time);

void classify(benchmark::State& state) {
  const Field<float> distance = burnish::exact_distances(lattice_knot(), grid(), kBand).distance;
  for (auto _ : state)
    benchmark::DoNotOptimize(classify_nodes(grid(), distance, crossed_edges(lattice_knot(), grid()), lattice_knot()));
  count_nodes(state, grid());
}
BENCHMARK(classify)->Apply(in_cpu_time);

void redistance(benchmark::State& state) {
  LevelSet set = level_set();
  for (auto _ : state) burnish::redistance(set);
  count_nodes(state, set.grid);
}
BENCHMARK(redistance)->Apply(in_cpu_time);

// Through the whole domain, where every leaf of any level stores values.
template <class T>
void redistance_domain(benchmark::State& state, RedistanceMethod method) {
  BasicLevelSet<T> set;
  set.frame = level_set().frame;
  set.grid = level_set().grid;
  set.band = level_set().band;
  Field<float> dense = level_set().phi;
  dense.make_dense(set.grid.octree.size());
  set.phi = Field<T>(set.grid.octree.size(), 0);
  std::copy(dense.values().begin(), dense.values().end(), set.phi.values().begin());
  const Field<T> start = set.phi;
  for (auto _ : state) {
    set.phi = start;
    burnish::redistance(set, {.method = method});
  }
  const auto nodes = static_cast<double>(set.phi.values().size());
  state.counters["seconds_per_node"] = benchmark::Counter(nodes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}
void closest_in_domain(benchmark::State& state) { redistance_domain<float>(state, RedistanceMethod::closest); }
BENCHMARK(closest_in_domain)->Apply(in_cpu_time);
void fmm_in_domain(benchmark::State& state) { redistance_domain<float>(state, RedistanceMethod::fmm); }
BENCHMARK(fmm_in_domain)->Apply(in_cpu_time);
void fmm_in_domain_double(benchmark::State& state) { redistance_domain<double>(state, RedistanceMethod::fmm); }
BENCHMARK(fmm_in_domain_double)->Apply(in_cpu_time);

// Six Euler steps and one redistancing.
void flow_of_unit_time(benchmark::State& state) {
  LevelSet set = level_set();
  for (auto _ : state) {
    set.phi = level_set().phi;
    benchmark::DoNotOptimize(mean_curvature_flow(set, 1.0));
  }
  count_nodes(state, set.grid);
}
BENCHMARK(flow_of_unit_time)->Apply(in_cpu_time);

// A length of 20 cells: explicit steps, and those of `smooth`.
constexpr double kLength = 20;

void smooth_knot(benchmark::State& state, const std::function<void(LevelSet&)>& how) {
  static const LevelSet start =
      level_set_from_triangles(knot(), knot_frame(), {.band = kFlowBand, .room = room_for_smoothing(FlowMode::mcf, kLength), .far_field = false}).level_set;
  LevelSet set = start;
  for (auto _ : state) {
    set.phi = start.phi;
    how(set);
  }
  count_nodes(state, set.grid);
}
void smooth_explicitly(benchmark::State& state) {
  smooth_knot(state, [](LevelSet& set) { mean_curvature_flow(set, flow_time_for(FlowMode::mcf, kLength)); });
}
BENCHMARK(smooth_explicitly)->Apply(in_cpu_time);
void smooth_by(benchmark::State& state, FlowMode mode, bool keep_volume) {
  SmoothingOptions options;
  options.mode = mode;
  options.length = kLength;
  options.keep_volume = keep_volume;
  smooth_knot(state, [&](LevelSet& set) { smooth(set, options); });
}
void smooth_mcf(benchmark::State& state) { smooth_by(state, FlowMode::mcf, false); }
BENCHMARK(smooth_mcf)->Apply(in_cpu_time);
void smooth_mcf_volume_kept(benchmark::State& state) { smooth_by(state, FlowMode::mcf, true); }
BENCHMARK(smooth_mcf_volume_kept)->Apply(in_cpu_time);
void smooth_volume(benchmark::State& state) { smooth_by(state, FlowMode::volume, true); }
BENCHMARK(smooth_volume)->Apply(in_cpu_time);
void smooth_filtered(benchmark::State& state) { smooth_by(state, FlowMode::filtered, true); }
BENCHMARK(smooth_filtered)->Apply(in_cpu_time);

void extract(benchmark::State& state) {
  std::size_t facets = 0;
  for (auto _ : state) facets += extract_surface(level_set()).soup.facets.size();
  state.SetItemsProcessed(static_cast<std::int64_t>(facets));
}
BENCHMARK(extract)->Apply(in_cpu_time);

}  // namespace
}  // namespace burnish::bench
