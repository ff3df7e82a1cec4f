// Points sorted by the leaves that hold them.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/core/vec.h"
#include "burnish/octree/field.h"

namespace burnish::detail {

// Points of leaf leaves[g]: order[first[g]] ... order[first[g + 1] - 1], in their order.
struct PointGroups {
  std::vector<std::uint32_t> leaves, order;
  std::vector<std::size_t> first;

  // By the leaf of each point; those with leaf kNone are in no group.
  PointGroups(const std::vector<std::uint32_t>& leaf_of, std::size_t tree_size) {
    std::vector<std::size_t> place(tree_size);
    for (const std::uint32_t leaf : leaf_of)
      if (leaf != Octree::kNone) ++place[leaf];
    for (std::uint32_t leaf = 0; leaf < tree_size; ++leaf)
      if (place[leaf] > 0) {
        leaves.push_back(leaf);
        first.push_back(place[leaf]);
      }
    first.push_back(0);
    order.resize(exclusive_scan_in_place(first));
    for (std::size_t g = 0; g < leaves.size(); ++g) place[leaves[g]] = first[g];
    for (std::uint32_t i = 0; i < leaf_of.size(); ++i)
      if (leaf_of[i] != Octree::kNone) order[place[leaf_of[i]]++] = i;
  }
};

// The leaf that stores values around p (lattice units), or kNone. `near`: a leaf to start from.
template <class T>
std::uint32_t storing_leaf(const Octree& tree, const Field<T>& field, const Vec3& p, std::uint32_t near) {
  const double side = static_cast<double>(tree.side()) * kBlockSide;
  for (int a = 0; a < 3; ++a)
    if (!(p[a] >= 0 && p[a] < side)) return Octree::kNone;
  const auto block = [](double x) { return static_cast<std::uint32_t>(x) / kBlockSide; };
  const std::uint32_t leaf = tree.find_near(near, {block(p.x), block(p.y), block(p.z)});
  return field.stores(leaf) ? leaf : Octree::kNone;
}

template <class T>
std::vector<std::uint32_t> storing_leaves(const Octree& tree, const Field<T>& field, std::span<const Vec3> points) {
  std::vector<std::uint32_t> leaves(points.size());
  parallel_ranges(points.size(), kDefaultGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t near = 0;
    for (std::size_t i = begin; i < end; ++i) {
      leaves[i] = storing_leaf(tree, field, points[i], near);
      if (leaves[i] != Octree::kNone) near = leaves[i];
    }
  });
  return leaves;
}

// In cells of the leaf, from the lower corner of an array with `width` layers around the leaf's block; and back.
inline Vec3 to_array(const Octree& tree, std::uint32_t leaf, int width, const Vec3& p) {
  const morton::Position c = tree.corner(leaf);
  const auto w = static_cast<double>(width);
  return (p - Vec3{8.0 * c.x, 8.0 * c.y, 8.0 * c.z}) * (1.0 / (1 << tree.level(leaf))) + Vec3{w, w, w};
}
inline Vec3 to_lattice(const Octree& tree, std::uint32_t leaf, int width, const Vec3& p) {
  const morton::Position c = tree.corner(leaf);
  const auto w = static_cast<double>(width);
  return (p - Vec3{w, w, w}) * (1 << tree.level(leaf)) + Vec3{8.0 * c.x, 8.0 * c.y, 8.0 * c.z};
}

}  // namespace burnish::detail
