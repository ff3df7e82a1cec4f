// BoxTree: a balanced binary tree of boxes over facets, for finding all pairs whose boxes meet.
//
// Every node splits its facets at the median of their centres along the longest axis, so the depth does
// not depend on how sizes are spread or on one facet lying far away. The layout needs no pointers: node i
// of level l holds the facets [n i / 2^l, n (i + 1) / 2^l) in the tree's order; its children are 2i and
// 2i + 1.
#pragma once

#include <algorithm>
#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

inline bool boxes_meet(const Box3& a, const Box3& b) {
  return a.lower.x <= b.upper.x && b.lower.x <= a.upper.x && a.lower.y <= b.upper.y &&
         b.lower.y <= a.upper.y && a.lower.z <= b.upper.z && b.lower.z <= a.upper.z;
}

class BoxTree {
 public:
  // A tree over the listed facets of the soup. O(n log n).
  BoxTree(const TriangleSoup& soup, std::vector<std::uint32_t> facets);

  std::size_t leaf_count() const { return std::size_t{1} << depth_; }

  // Calls visit(f, g) for each pair of facets whose boxes meet, the first one in a leaf of [begin, end), the other in
  // the same leaf behind it or in a later leaf. Over all leaves: each pair once, in the same order however they are cut into
  // ranges. Ends early once visit returns false.
  template <class Visit>
  void pairs_from_leaves(std::size_t begin, std::size_t end, Visit&& visit) const;

  // Calls visit(f) for each facet whose box meets `box`, in the tree's order.
  template <class Visit>
  void facets_meeting(const Box3& box, Visit&& visit) const;

 private:
  std::size_t first(int level, std::size_t node) const { return (facets_.size() * node) >> level; }
  static std::size_t slot(int level, std::size_t node) { return (std::size_t{1} << level) - 1 + node; }
  const Box3& node_box(int level, std::size_t node) const { return nodes_[slot(level, node)]; }
  Box3& node_box(int level, std::size_t node) { return nodes_[slot(level, node)]; }

  void sort_by_medians(const TriangleSoup& soup);
  void fill_boxes(const TriangleSoup& soup);
  // The leaves from `least` on whose boxes meet that of a node, ascending.
  void leaves_near(int level, std::size_t node, std::size_t least, std::vector<std::size_t>& leaves) const;
  template <class Visit>
  bool pairs_of_leaves(std::size_t a, std::size_t b, Visit&& visit) const;

  int depth_ = 0;
  std::vector<std::uint32_t> facets_;  // in the tree's order
  std::vector<Box3> boxes_;            // of the facets, in the tree's order
  std::vector<Box3> nodes_;            // level by level
};

template <class Visit>
bool BoxTree::pairs_of_leaves(std::size_t a, std::size_t b, Visit&& visit) const {
  for (std::size_t i = first(depth_, a); i < first(depth_, a + 1); ++i)
    for (std::size_t j = a == b ? i + 1 : first(depth_, b); j < first(depth_, b + 1); ++j)
      if (boxes_meet(boxes_[i], boxes_[j]) && !visit(facets_[i], facets_[j])) return false;
  return true;
}

template <class Visit>
void BoxTree::pairs_from_leaves(std::size_t begin, std::size_t end, Visit&& visit) const {
  // Leaves of a small subtree have nearly the same neighbours: one descent finds them for all.
  const int up = std::min(depth_, 4);
  std::vector<std::size_t> near;
  std::size_t group = leaf_count();
  for (std::size_t leaf = begin; leaf < end; ++leaf) {
    if (leaf >> up != group) {
      group = leaf >> up;
      leaves_near(depth_ - up, group, leaf, near);
    }
    const Box3& box = node_box(depth_, leaf);
    for (const std::size_t other : near)
      if (other >= leaf && boxes_meet(box, node_box(depth_, other)) && !pairs_of_leaves(leaf, other, visit)) return;
  }
}

template <class Visit>
void BoxTree::facets_meeting(const Box3& box, Visit&& visit) const {
  struct Node {
    int level;
    std::size_t number;
  };
  Node stack[80];  // the depth is at most 30, and each step pushes one
  int size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const auto [level, number] = stack[--size];
    if (!boxes_meet(box, node_box(level, number))) continue;
    if (level < depth_) {
      stack[size++] = {level + 1, 2 * number + 1};
      stack[size++] = {level + 1, 2 * number};
      continue;
    }
    for (std::size_t i = first(depth_, number); i < first(depth_, number + 1); ++i)
      if (boxes_meet(box, boxes_[i])) visit(facets_[i]);
  }
}

}  // namespace burnish
