#include "burnish/levelset/volume.h"

#include <algorithm>
#include <array>
#include <functional>

#include "burnish/core/parallel.h"
#include "transition_tetrahedra.h"

namespace burnish {
namespace {

constexpr int kSide = kBlockSide + 2;

// [T-VOL-1]
double cut_cell_volume(const std::array<double, 8>& phi) {
  double sum = 0;
  for (const auto& t : detail::kKuhnPaths)
    sum += positive_fraction(phi[static_cast<std::size_t>(t[0])], phi[static_cast<std::size_t>(t[1])],
                             phi[static_cast<std::size_t>(t[2])], phi[static_cast<std::size_t>(t[3])]);
  return sum / 6;
}

// The inside volume of one leaf, in cells of the leaf.
template <class T>
double leaf_volume(const BasicLevelSet<T>& set, std::size_t leaf) {
  const T* own = set.phi.block(leaf);
  const bool deep = !set.phi.stores(leaf) || std::all_of(own, own + kBlockNodes, [](T v) { return v > 2 || v < -2; });
  if (deep && !set.grid.near_surface(leaf)) return own[0] >= 0 ? static_cast<double>(kBlockNodes) : 0.0;
  std::array<T, std::size_t{kSide} * kSide * kSide> dense;
  gather(set.octree(), set.phi, leaf, 1, dense.data());
  double sum = 0;
  for (int k = 1; k <= kBlockSide; ++k)
    for (int j = 1; j <= kBlockSide; ++j)
      for (int i = 1; i <= kBlockSide; ++i) {
        std::array<double, 8> phi;
        int in = 0;
        for (int c = 0; c < 8; ++c) {
          phi[static_cast<std::size_t>(c)] =
              dense[static_cast<std::size_t>((i + (c & 1)) + kSide * ((j + (c >> 1 & 1)) + kSide * (k + (c >> 2 & 1))))];
          in += phi[static_cast<std::size_t>(c)] >= 0;
        }
        sum += in == 8 ? 1.0 : in == 0 ? 0.0 : cut_cell_volume(phi);
      }
  return sum;
}

}  // namespace

double positive_fraction(double a, double b, double c, double d) {
  std::array<double, 4> v{a, b, c, d};
  std::sort(v.begin(), v.end(), std::greater<>());
  const auto part = [](double from, double to) { return from / (from - to); };  // of an edge that is inside
  if (v[3] >= 0) return 1;
  if (v[0] < 0) return 0;
  if (v[1] < 0) return part(v[0], v[1]) * part(v[0], v[2]) * part(v[0], v[3]);
  if (v[2] >= 0) return 1 - part(v[3], v[0]) * part(v[3], v[1]) * part(v[3], v[2]);
  const double p = part(v[0], v[2]), q = part(v[0], v[3]), r = part(v[1], v[2]), s = part(v[1], v[3]);
  return p * q + p * s * (1 - q) + (1 - p) * r * s;  // [T-VOL-2]
}

template <class T>
double enclosed_volume(const BasicLevelSet<T>& level_set) {
  const Octree& tree = level_set.octree();
  return parallel_reduce(
      tree.size(), 64, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double sum = 0;
        for (std::size_t leaf = begin; leaf < end; ++leaf) {
          const double side = static_cast<double>(1u << tree.level(leaf));
          sum += leaf_volume(level_set, leaf) * side * side * side;
        }
        return sum;
      },
      std::plus<>());
}

template double enclosed_volume(const BasicLevelSet<float>&);
template double enclosed_volume(const BasicLevelSet<double>&);

}  // namespace burnish
