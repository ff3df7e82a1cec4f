#include "box_tree.h"

#include <algorithm>
#include <utility>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr std::size_t kFacetsPerLeaf = 4;
constexpr std::size_t kGrain = 4096;

struct Item {
  Vec3 center;
  std::uint32_t facet;
};

Box3 facet_box(const TriangleSoup& soup, std::uint32_t f) {
  Box3 box;
  for (int i = 0; i < 3; ++i) box.extend(soup.corner(f, i));
  return box;
}

int longest_axis(const std::vector<Item>& items, std::size_t begin, std::size_t end) {
  Box3 box;
  for (std::size_t i = begin; i < end; ++i) box.extend(items[i].center);
  const Vec3 e = box.extent();
  return e.x >= e.y && e.x >= e.z ? 0 : e.y >= e.z ? 1 : 2;
}

void split_at(std::vector<Item>& items, std::size_t begin, std::size_t middle, std::size_t end) {
  const int axis = longest_axis(items, begin, end);
  const auto at = [&](std::size_t i) { return items.begin() + static_cast<std::ptrdiff_t>(i); };
  std::nth_element(at(begin), at(middle), at(end), [axis](const Item& a, const Item& b) {
    return std::pair(a.center[axis], a.facet) < std::pair(b.center[axis], b.facet);
  });
}

}  // namespace

BoxTree::BoxTree(const TriangleSoup& soup, std::vector<std::uint32_t> facets) : facets_(std::move(facets)) {
  while ((kFacetsPerLeaf << depth_) < facets_.size()) ++depth_;
  sort_by_medians(soup);
  fill_boxes(soup);
}

void BoxTree::sort_by_medians(const TriangleSoup& soup) {
  std::vector<Item> items(facets_.size());
  parallel_for(items.size(), [&](std::size_t i) {
    const std::uint32_t f = facets_[i];
    const Box3 box = facet_box(soup, f);
    items[i] = {box.lower * 0.5 + box.upper * 0.5, f};
  }, kGrain);
  for (int level = 0; level < depth_; ++level) {
    const std::size_t grain = std::max<std::size_t>(1, (kGrain << level) / items.size());
    parallel_for(std::size_t{1} << level, [&](std::size_t node) {
      split_at(items, first(level, node), first(level + 1, 2 * node + 1), first(level, node + 1));
    }, grain);
  }
  parallel_for(items.size(), [&](std::size_t i) { facets_[i] = items[i].facet; }, kGrain);
}

void BoxTree::leaves_near(int level, std::size_t node, std::size_t least, std::vector<std::size_t>& leaves) const {
  struct Node {
    int level;
    std::size_t number;
  };
  const Box3& query = node_box(level, node);
  leaves.clear();
  Node stack[80];
  int size = 0;
  stack[size++] = {0, 0};
  while (size > 0) {
    const Node at = stack[--size];
    const std::size_t last_leaf = ((at.number + 1) << (depth_ - at.level)) - 1;
    if (last_leaf < least || !boxes_meet(query, node_box(at.level, at.number))) continue;
    if (at.level == depth_) {
      leaves.push_back(at.number);
      continue;
    }
    stack[size++] = {at.level + 1, 2 * at.number + 1};
    stack[size++] = {at.level + 1, 2 * at.number};
  }
}

void BoxTree::fill_boxes(const TriangleSoup& soup) {
  boxes_.resize(facets_.size());
  parallel_for(boxes_.size(), [&](std::size_t i) { boxes_[i] = facet_box(soup, facets_[i]); }, kGrain);
  nodes_.resize(2 * leaf_count() - 1);
  parallel_for(leaf_count(), [&](std::size_t leaf) {
    Box3& box = node_box(depth_, leaf);
    for (std::size_t i = first(depth_, leaf); i < first(depth_, leaf + 1); ++i) box.extend(boxes_[i]);
  }, kGrain);
  for (int level = depth_ - 1; level >= 0; --level)
    parallel_for(std::size_t{1} << level, [&](std::size_t node) {
      Box3& box = node_box(level, node);
      box.extend(node_box(level + 1, 2 * node));
      box.extend(node_box(level + 1, 2 * node + 1));
    }, kGrain);
}

}  // namespace burnish
