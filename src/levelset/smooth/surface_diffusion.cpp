#include "surface_diffusion.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "../../octree/lattice_lookup.h"

namespace burnish::detail {
namespace {

constexpr std::size_t kGrain = 16;
// Second differences along all axes need a node more than the domain has, along its diagonals.
constexpr double kMargin = 1;

int passes_for(double time) { return std::max(1, static_cast<int>(std::ceil(time / HeatTaps::kLongest - 1e-9))); }

}  // namespace

SurfaceDiffusion::SurfaceDiffusion(const LevelSet& set) : tree_(set.octree()) {
  for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf)
    if (tree_.level(leaf) == 0 && set.phi.stores(leaf)) finest_.push_back(leaf);
  for (Field<float>* field : {&source_, &moved_, &next_}) *field = Field<float>::like(set.phi, kUnknown, kUnknown);
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
      gather_finest(set.phi, leaves_[i], kHeatWidth, phi.data());
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
      gather_finest(moved_, leaves_[i], kHeatWidth, moved.data());
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

void SurfaceDiffusion::change_by_bends(const LevelSet& set, const std::function<float(float, float, float, float)>& change) {
  parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::array<float, kBendNodes> phi, moved;
    Bends bends;
    for (std::size_t i = begin; i < end; ++i) {
      gather_finest(set.phi, leaves_[i], 1, phi.data());
      gather_finest(moved_, leaves_[i], 1, moved.data());
      for (std::size_t n = 0; n < kBendNodes; ++n) phi[n] += moved[n];
      heat_bends(phi, bends);
      const float *d = set.phi.block(leaves_[i]), *w = std::as_const(moved_).block(leaves_[i]);
      float* out = next_.block(leaves_[i]);
      for (std::size_t n = 0; n < kBlockNodes; ++n) out[n] = is_known(w[n]) ? change(w[n], d[n], bends.trace[n], bends.square[n]) : kUnknown;
    }
  });
  std::swap(moved_, next_);
}

void SurfaceDiffusion::gather_finest(const Field<float>& field, std::uint32_t leaf, int width, float* dense) const {
  const int side = kBlockSide + 2 * width;
  for (int dir = 0; dir < kDirections; ++dir) {
    const auto [dx, dy, dz] = offset_of(dir);
    const Range x = halo_range(dx, width), y = halo_range(dy, width), z = halo_range(dz, width);
    const bool is_there = dir == kSelf || tree_.neighbor_kind(leaf, dir) == NeighborKind::same;
    const float* from = is_there ? field.block(dir == kSelf ? leaf : tree_.neighbor(leaf, dir)) : nullptr;
    for (int k = z.begin; k < z.end; ++k)
      for (int j = y.begin; j < y.end; ++j) {
        float* to = dense + (x.begin + width) + side * ((j + width) + side * (k + width));
        if (is_there)
          std::copy_n(from + node_index(x.begin - kBlockSide * dx, j - kBlockSide * dy, k - kBlockSide * dz), x.end - x.begin, to);
        else
          std::fill_n(to, x.end - x.begin, kUnknown);
      }
  }
}

}  // namespace burnish::detail
