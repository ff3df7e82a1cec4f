#include "surface_diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"

namespace burnish::detail {
namespace {

constexpr std::size_t kGrain = 16;
// Second differences along all axes need a node more than the domain has, along its diagonals.
constexpr double kMargin = 1.5;

int passes_for(double time) { return std::max(1, static_cast<int>(std::ceil(time / HeatTaps::kLongest - 1e-9))); }

}  // namespace

SurfaceDiffusion::SurfaceDiffusion(const LevelSet& set) : tree_(set.octree()) {
  for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf)
    if (tree_.level(leaf) == 0 && set.phi.stores(leaf)) finest_.push_back(leaf);
  source_ = moved_ = next_ = Field<float>::like(set.phi, kUnknown, kUnknown);
}

// Leaves without known nodes are unknown in both of the fields that take turns.
void SurfaceDiffusion::find_leaves(const LevelSet& set, double domain) {
  const auto limit = static_cast<float>(domain);
  std::vector<char> near(finest_.size());
  parallel_for(finest_.size(), [&](std::size_t i) {
    const float* phi = set.phi.block(finest_[i]);
    near[i] = std::any_of(phi, phi + kBlockNodes, [&](float v) { return std::abs(v) < limit; });
    if (near[i] != 0) return;
    std::fill_n(moved_.block(finest_[i]), kBlockNodes, kUnknown);
    std::fill_n(next_.block(finest_[i]), kBlockNodes, kUnknown);
  }, 64);
  leaves_.clear();
  for (std::size_t i = 0; i < finest_.size(); ++i)
    if (near[i] != 0) leaves_.push_back(finest_[i]);
}

void SurfaceDiffusion::start(const LevelSet& set, double limit, double time, Progress& progress) {
  const double domain = limit - kMargin;
  find_leaves(set, domain);
  const int passes = passes_for(time);
  taps_ = HeatTaps(time / passes);
  parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    progress.check();
    alignas(64) std::array<float, kHeatNodes> phi;
    for (std::size_t i = begin; i < end; ++i) {
      gather(tree_, set.phi, leaves_[i], kHeatWidth, phi.data());
      heat_source(phi, taps_, static_cast<float>(limit), static_cast<float>(domain), source_.block(leaves_[i]));
      std::copy_n(source_.block(leaves_[i]), kBlockNodes, moved_.block(leaves_[i]));
    }
  });
  for (int p = 1; p < passes; ++p) pass(taps_, Source::add, progress);
}

void SurfaceDiffusion::go_on(double time, Progress& progress) {
  for (int p = 0; p < static_cast<int>(std::lround(time / taps_.time)); ++p) pass(taps_, Source::add, progress);
}

void SurfaceDiffusion::average(double time, Progress& progress) {
  const int passes = passes_for(time);
  const HeatTaps taps(time / passes);
  for (int p = 0; p < passes; ++p) pass(taps, Source::none, progress);
}

void SurfaceDiffusion::pass(const HeatTaps& taps, Source source, Progress& progress) {
  parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    progress.check();
    alignas(64) std::array<float, kHeatNodes> moved;
    for (std::size_t i = begin; i < end; ++i) {
      gather(tree_, moved_, leaves_[i], kHeatWidth, moved.data());
      float* out = next_.block(leaves_[i]);
      heat_pass(moved, taps, out);
      if (source == Source::none) continue;
      const float* added = std::as_const(source_).block(leaves_[i]);
      for (std::size_t n = 0; n < kBlockNodes; ++n)
        if (is_known(out[n])) out[n] += added[n];
    }
  });
  std::swap(moved_, next_);
}

void SurfaceDiffusion::for_each_bend(const LevelSet& set, const std::function<void(std::uint32_t, const Bends&)>& body) const {
  parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::array<float, kBendNodes> phi, moved;
    Bends bends;
    for (std::size_t i = begin; i < end; ++i) {
      gather(tree_, set.phi, leaves_[i], 1, phi.data());
      gather(tree_, moved_, leaves_[i], 1, moved.data());
      for (std::size_t n = 0; n < kBendNodes; ++n) phi[n] += moved[n];
      heat_bends(phi, bends);
      body(leaves_[i], bends);
    }
  });
}

}  // namespace burnish::detail
