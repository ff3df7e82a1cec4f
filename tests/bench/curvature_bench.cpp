// The knot with 256 cells along its longest side: curvatures at the nodes beside its surface, per point; those of all nodes, per node.
#include "burnish/levelset/curvature.h"

#include <array>
#include <cmath>
#include <random>

#include "burnish/levelset/from_triangles.h"
#include "levelset/curvature_kernel.h"
#include "levelset/nodal_curvature_kernel.h"
#include "models.h"

namespace burnish::bench {
namespace {

const LevelSet& level_set() {
  static const LevelSet set =
      level_set_from_triangles(knot(), knot_frame(), {.band = curvature_band(CurvatureOrder::sixth), .room = kBlockSide, .far_field = false}).level_set;
  return set;
}

// Nodes with |phi| < 1.
const std::vector<Vec3>& near_nodes() {
  static const std::vector<Vec3> points = [] {
    std::vector<Vec3> found;
    const LevelSet& set = level_set();
    for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
      for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
        if (!set.phi.stores(leaf) || std::abs(set.phi.block(leaf)[n]) >= 1) continue;
        const LatticeNode node = lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64);
        found.push_back({static_cast<double>(node.x), static_cast<double>(node.y), static_cast<double>(node.z)});
      }
    return found;
  }();
  return points;
}

void count(benchmark::State& state, std::size_t items) {
  using benchmark::Counter;
  state.SetItemsProcessed(static_cast<std::int64_t>(state.iterations() * items));
  state.counters["seconds_per_node"] = Counter(static_cast<double>(items), Counter::kIsIterationInvariantRate | Counter::kInvert);
}

// Newton's method, jets and all that is done once per block.
void front_curvature(benchmark::State& state) {
  const auto order = static_cast<CurvatureOrder>(state.range(0));
  near_nodes();  // made here, not in the loop
  for (auto _ : state) benchmark::DoNotOptimize(burnish::front_curvature(level_set(), std::span<const Vec3>(near_nodes()), order));
  count(state, near_nodes().size());
}
BENCHMARK(front_curvature)->Arg(2)->Arg(4)->Arg(6)->Apply(in_cpu_time);

void quadric_curvature(benchmark::State& state) {
  const std::span<const Vec3> some(near_nodes().data(), std::min<std::size_t>(near_nodes().size(), 5000));
  for (auto _ : state) benchmark::DoNotOptimize(burnish::quadric_curvature(level_set(), some));
  count(state, some.size());
}
BENCHMARK(quadric_curvature)->Apply(in_cpu_time);

void nodal_curvature(benchmark::State& state) {
  const auto order = static_cast<CurvatureOrder>(state.range(0));
  for (auto _ : state) benchmark::DoNotOptimize(burnish::nodal_curvature(level_set(), order));
  std::size_t stored = 0;
  for (std::size_t leaf = 0; leaf < level_set().octree().size(); ++leaf) stored += level_set().phi.stores(leaf);
  count(state, stored * kBlockNodes);
}
BENCHMARK(nodal_curvature)->Arg(2)->Arg(4)->Apply(in_cpu_time);

// What of this are jets and curvatures at feet that are known, and what one step of Newton's method for a foot.
struct Ball {
  detail::JetBlock block;
  std::vector<Vec3> points;

  Ball() {
    std::array<double, detail::kJetNodes> phi;
    for (int n = 0; n < static_cast<int>(phi.size()); ++n)
      phi[static_cast<std::size_t>(n)] = 9 - std::hypot(n % detail::kJetSide + 1.3, n / detail::kJetSide % detail::kJetSide + 0.2, n / 256 - 2.9);
    detail::JetLimits limits;
    for (auto& row : limits) row.fill(20);
    detail::fill(phi.data(), 1, limits, block);
    std::mt19937 random(1);
    std::uniform_real_distribution<double> any(4, 12);
    for (int i = 0; i < 1024; ++i) points.push_back({any(random), any(random), any(random)});
  }
};

template <auto jet>
void jets(benchmark::State& state) {
  static const Ball ball;
  detail::Jet found;
  detail::JetBatch batch;
  detail::CurvatureBatch curvatures;
  for (auto _ : state)
    for (std::size_t i = 0; i < ball.points.size(); ++i) {
      const std::size_t lane = i % detail::JetBatch::kSize;
      jet(ball.block, ball.points[i], found);
      batch.set(lane, found);
      if (lane + 1 < detail::JetBatch::kSize) continue;
      detail::principal_curvatures(batch, detail::JetBatch::kSize, curvatures);
      benchmark::DoNotOptimize(curvatures.k1.data());
    }
  count(state, ball.points.size());
}
BENCHMARK(jets<detail::jet_of_second_order>)->Name("curvature_at_feet/2")->Apply(in_cpu_time);
BENCHMARK(jets<detail::jet_of_fourth_order>)->Name("curvature_at_feet/4")->Apply(in_cpu_time);
BENCHMARK(jets<detail::jet_of_sixth_order>)->Name("curvature_at_feet/6")->Apply(in_cpu_time);

void tricubic_newton_step(benchmark::State& state) {
  static const Ball ball;
  for (auto _ : state)
    for (const Vec3& p : ball.points) {
      double value;
      Vec3 gradient;
      detail::cubic(ball.block, p, value, gradient);
      benchmark::DoNotOptimize(gradient * (value / squared_norm(gradient)));
    }
  count(state, ball.points.size());
}
BENCHMARK(tricubic_newton_step)->Apply(in_cpu_time);

// Without filling halos.
void nodal_stencils(benchmark::State& state) {
  std::array<float, detail::kNodalNodes> phi;
  for (int n = 0; n < static_cast<int>(phi.size()); ++n)
    phi[static_cast<std::size_t>(n)] = static_cast<float>(9 - std::hypot(n % 12 + 1.3, n / 12 % 12 + 0.2, n / 144 - 2.9));
  std::array<double, kBlockNodes> found;
  for (auto _ : state) {
    detail::nodal_curvatures(phi.data(), 1, static_cast<int>(state.range(0)), found.data());
    benchmark::DoNotOptimize(found.data());
  }
  count(state, kBlockNodes);
}
BENCHMARK(nodal_stencils)->Arg(2)->Arg(4)->Apply(in_cpu_time);

}  // namespace
}  // namespace burnish::bench
