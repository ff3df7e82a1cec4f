#include "tricubic_sampler.h"

#include <algorithm>

#include "field_nodes.h"

namespace burnish {
namespace {

// Weights of the cubic polynomial through nodes -1, 0, 1, 2 at t. [T-EXPORT-2]
std::array<double, 4> cubic_weights(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6};
}

}  // namespace

double TricubicSampler::operator()(const Vec3& p) {
  const StoredNode node = node_at_or_below(set_.octree(), {static_cast<std::int32_t>(p.x), static_cast<std::int32_t>(p.y), static_cast<std::int32_t>(p.z)},
                                           leaf_ == Octree::kNone ? 0 : leaf_);
  if (node.leaf != leaf_) enter(node.leaf);
  std::array<int, 3> first{};
  std::array<std::array<double, 4>, 3> weights{};
  for (int a = 0; a < 3; ++a) {
    const double x = (p[a] - corner_[a]) / cell_;
    first[static_cast<std::size_t>(a)] = std::clamp(static_cast<int>(x), 0, kBlockSide - 1);
    weights[static_cast<std::size_t>(a)] = cubic_weights(x - first[static_cast<std::size_t>(a)]);
  }
  double sum = 0;
  for (std::size_t k = 0; k < 4; ++k)
    for (std::size_t j = 0; j < 4; ++j) {
      const float* row = values_.data() + place(first[0], first[1] + static_cast<int>(j), first[2] + static_cast<int>(k));
      double line = 0;
      for (std::size_t i = 0; i < 4; ++i) line += weights[0][i] * static_cast<double>(row[i]);
      sum += weights[1][j] * weights[2][k] * line;
    }
  return sum;
}

void TricubicSampler::enter(std::uint32_t leaf) {
  leaf_ = leaf;
  gather_smooth(set_.octree(), set_.phi, leaf, kWidth, HaloOrder::cubic, values_.data());
  const LatticeNode corner = lattice_node(set_.octree(), leaf, 0, 0, 0);
  corner_ = {static_cast<double>(corner.x), static_cast<double>(corner.y), static_cast<double>(corner.z)};
  cell_ = 1 << set_.octree().level(leaf);
}

}  // namespace burnish
