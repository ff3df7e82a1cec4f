#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/levelset/curvature.h"
#include "nodal_curvature_kernel.h"

namespace burnish {

template <class T>
Field<T> nodal_curvature(const BasicLevelSet<T>& level_set, CurvatureOrder order, Progress& progress) {
  const Octree& tree = level_set.octree();
  Field<T> result = Field<T>::like(level_set.phi, 0, 0);
  const int used = order == CurvatureOrder::second ? 2 : 4;
  parallel_ranges(tree.size(), 8, [&](std::size_t begin, std::size_t end) {
    progress.check();
    std::array<T, detail::kNodalNodes> phi;
    std::array<double, kBlockNodes> curvatures;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      if (!level_set.phi.stores(leaf)) continue;
      const double cell = 1 << tree.level(leaf), band = level_set.band * cell * (1 - 1e-6);
      gather_smooth(tree, level_set.phi, leaf, detail::kNodalWidth, used == 2 ? HaloOrder::cubic : HaloOrder::quintic, phi.data());
      detail::nodal_curvatures(phi.data(), 1 / cell, used, curvatures.data());
      const T* own = level_set.phi.block(leaf);
      T* out = result.block(leaf);
      for (std::size_t n = 0; n < kBlockNodes; ++n) out[n] = std::abs(own[n]) < band ? static_cast<T>(curvatures[n] / cell) : T{0};
    }
  });
  return result;
}

template Field<float> nodal_curvature(const BasicLevelSet<float>&, CurvatureOrder, Progress&);
template Field<double> nodal_curvature(const BasicLevelSet<double>&, CurvatureOrder, Progress&);

}  // namespace burnish
