// Level sets of functions that are known everywhere, in lattice units: what convergence is measured on.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <random>
#include <utility>
#include <vector>

#include "burnish/core/vec.h"
#include "support/level_sets.h"

namespace burnish::test {

// Calls visit(position, value) with every node of leaves near the surface; values may be changed.
template <class T, class Visit>
void for_each_near_node(BasicLevelSet<T>& set, Visit&& visit) {
  const Octree& tree = set.octree();
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
    if (!set.grid.near_surface(leaf)) continue;
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
      visit(to_vec(lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64)), set.phi.block(leaf)[n]);
  }
}

// phi = distance(node), clamped to +-band, on an octree of 2^depth finest blocks a side whose leaves are finest, and near the
// surface, wherever |distance| < band. `distance` must not change by more than 1 a cell.
template <class T, class Distance>
BasicLevelSet<T> analytic_level_set(int depth, double band, Distance&& distance) {
  constexpr double kHalfDiagonal = 7.0;  // of a block, rounded up
  std::vector<std::uint64_t> near;
  for (const std::uint64_t m : all_blocks(depth)) {
    const morton::Position p = morton::deinterleave(m);
    if (std::abs(distance(Vec3{8 * p.x + 4.0, 8 * p.y + 4.0, 8 * p.z + 4.0})) < band + kHalfDiagonal) near.push_back(m);
  }
  Octree tree = Octree::build(depth, near);
  std::sort(near.begin(), near.end());
  BasicLevelSet<T> set = level_set_of<T>(std::move(tree), [&](const LatticeNode& n) {
    return std::clamp(distance(to_vec(n)), -band, band);
  });
  set.band = band;
  // One facet, which nobody looks at, stands for the surface in each block near it.
  std::uint64_t count = 0;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    set.grid.first_facet[leaf] = count;
    const std::uint64_t key = set.octree().key(leaf);
    count += morton::level(key) == 0 && std::binary_search(near.begin(), near.end(), key >> 1);
  }
  set.grid.first_facet.back() = count;
  set.grid.facets.assign(count, 0);
  return set;
}

// The same surface with distances up to `band` only, and values stored near it only, as in a run of the program.
inline LevelSet stored_near_surface(const LevelSet& set, double band) {
  const auto limit = static_cast<float>(band);
  LevelSet sparse;
  sparse.frame = set.frame;
  sparse.grid = set.grid;
  sparse.band = band;
  sparse.phi = Field<float>(layout_of(set.octree().size(), [&](std::size_t leaf) { return set.grid.near_surface(leaf); }), -limit, limit);
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    const float* from = set.phi.block(leaf);
    if (sparse.phi.stores(leaf))
      std::transform(from, from + kBlockNodes, sparse.phi.block(leaf), [&](float v) { return std::clamp(v, -limit, limit); });
    else
      sparse.phi.set_uniform(leaf, from[0] > 0);
  }
  return sparse;
}

// A ball in a domain with room for its band, its centre off the lattice by `offset`.
template <class T>
struct Ball {
  BasicLevelSet<T> set;
  Vec3 center;
};

template <class T>
Ball<T> analytic_ball(double radius, const Vec3& offset, double band) {
  int depth = 0;
  while (8 << depth < 2 * (radius + band) + 20) ++depth;
  const double middle = (8 << depth) / 2.0;
  const Vec3 center = Vec3{middle, middle, middle} + offset;
  return {analytic_level_set<T>(depth, band, [=](const Vec3& p) { return radius - norm(p - center); }), center};
}

// An offset of a shape against the lattice, in [0, 1)^3.
inline Vec3 random_offset(std::mt19937& random) {
  std::uniform_real_distribution<double> any(0, 1);
  const double x = any(random), y = any(random), z = any(random);
  return {x, y, z};
}

// Where phi changes sign along lattice edges, by linear interpolation.
template <class T>
std::vector<Vec3> edge_crossings(const BasicLevelSet<T>& set) {
  constexpr int side = kBlockSide + 2;
  std::vector<T> dense(side * side * side);
  std::vector<Vec3> crossings;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    if (!set.grid.near_surface(leaf)) continue;
    gather(set.octree(), set.phi, leaf, 1, dense.data());
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i)
          for (int axis = 0; axis < 3; ++axis) {
            const int at = (i + 1) + side * ((j + 1) + side * (k + 1));
            const int step = axis == 0 ? 1 : axis == 1 ? side : side * side;
            const double p = dense[static_cast<std::size_t>(at)], q = dense[static_cast<std::size_t>(at + step)];
            if ((p >= 0) == (q >= 0)) continue;
            Vec3 x = to_vec(lattice_node(set.octree(), leaf, i, j, k));
            x[axis] += p / (p - q);
            crossings.push_back(x);
          }
  }
  return crossings;
}

// Mean distance of the zero crossings of lattice edges from `center`.
template <class T>
double mean_radius(const BasicLevelSet<T>& set, const Vec3& center) {
  double sum = 0;
  const std::vector<Vec3> crossings = edge_crossings(set);
  for (const Vec3& x : crossings) sum += norm(x - center);
  return sum / static_cast<double>(crossings.size());
}

}  // namespace burnish::test
