// Redistancing by the PDE on leaves of one level: what a node costs per stage, halos included.
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/levelset/redistance.h"
#include "models.h"

namespace burnish::bench {
namespace {

constexpr int kDepth = 4;  // 128^3 nodes
constexpr double kRadius = 40;
constexpr int kSteps = 4;

// All leaves of the finest level, phi a ball's distance that is somewhat off.
template <class T>
BasicLevelSet<T> ball() {
  std::vector<std::uint64_t> all;
  for (std::uint64_t m = 0; m < std::uint64_t{1} << (3 * kDepth); ++m) all.push_back(m);
  BasicLevelSet<T> set;
  set.frame.depth = kDepth;
  set.grid.octree = Octree::build(kDepth, all);
  set.phi = Field<T>(set.octree().size(), 0);
  set.band = 200;
  const double middle = 4.0 * (1 << kDepth) + 0.3;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
      const LatticeNode x = lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64);
      const double r = std::hypot(x.x - middle, x.y - middle, x.z - middle);
      set.phi.block(leaf)[n] = static_cast<T>((kRadius - r) * (1 + 0.02 * std::sin(0.3 * x.x)));
    }
  return set;
}

// Seconds per node and stage, with what is done once spread over few steps or many.
template <class T>
void steps(benchmark::State& state, RedistanceMethod method, bool frozen, int stages) {
  const ThreadLimit one(1);
  const BasicLevelSet<T> start = ball<T>();
  Field<std::uint8_t> accepted(start.octree().size(), 0);
  for (std::size_t i = 0; i < accepted.values().size(); ++i) accepted.values()[i] = std::abs(start.phi.values()[i]) < 2;
  RedistanceOptions options;
  options.method = method;
  options.most_steps = static_cast<int>(state.range(0));
  options.steady = 0;
  if (frozen) options.accepted = &accepted;
  for (auto _ : state) {
    state.PauseTiming();
    BasicLevelSet<T> set = start;
    state.ResumeTiming();
    redistance(set, options);
  }
  const double nodes = static_cast<double>(start.octree().size() * kBlockNodes) * stages * options.most_steps;
  state.counters["seconds_per_node"] = benchmark::Counter(nodes, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
}

void few_and_many(benchmark::internal::Benchmark* b) { in_cpu_time(b), b->Arg(kSteps)->Arg(8 * kSteps); }

constexpr auto kWeno = RedistanceMethod::pde_weno5, kFirst = RedistanceMethod::pde_first;

void pde_weno5_accepted(benchmark::State& state) { steps<double>(state, kWeno, true, 3); }
void pde_weno5_accepted_float(benchmark::State& state) { steps<float>(state, kWeno, true, 3); }
void pde_weno5_free(benchmark::State& state) { steps<double>(state, kWeno, false, 3); }
void pde_first_accepted(benchmark::State& state) { steps<double>(state, kFirst, true, 1); }
void pde_first_accepted_float(benchmark::State& state) { steps<float>(state, kFirst, true, 1); }
void pde_first_free(benchmark::State& state) { steps<double>(state, kFirst, false, 1); }
BENCHMARK(pde_weno5_accepted)->Apply(few_and_many);
BENCHMARK(pde_weno5_accepted_float)->Apply(few_and_many);
BENCHMARK(pde_weno5_free)->Apply(few_and_many);
BENCHMARK(pde_first_accepted)->Apply(few_and_many);
BENCHMARK(pde_first_accepted_float)->Apply(few_and_many);
BENCHMARK(pde_first_free)->Apply(few_and_many);

}  // namespace
}  // namespace burnish::bench
