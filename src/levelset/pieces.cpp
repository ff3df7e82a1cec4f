#include "pieces.h"

#include <algorithm>
#include <array>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"

namespace burnish::detail {
namespace {

constexpr std::size_t kGrain = 64;

// Unites the runs that edges along one axis join.
void unite_along(const std::uint8_t* crossed, const std::uint16_t* run, std::size_t stride, std::uint8_t bit, UnionFind& forest) {
  std::uint32_t last = 0xffffffffu;
  for (std::size_t n = 0; n + stride < kBlockNodes; ++n) {
    if (n / stride % kBlockSide == kBlockSide - 1 || (crossed[n] & bit)) continue;
    const std::uint32_t both = static_cast<std::uint32_t>(run[n]) << 16 | run[n + stride];
    if (both != last) forest.unite(run[n], run[n + stride]);
    last = both;
  }
}

// The block's node number of point (a, b) on the face of an axis at `depth`.
std::size_t face_node(int axis, int depth, int a, int b) {
  std::array<int, 3> at{};
  at[static_cast<std::size_t>(axis)] = depth;
  at[static_cast<std::size_t>((axis + 1) % 3)] = a;
  at[static_cast<std::size_t>((axis + 2) % 3)] = b;
  return node_index(at[0], at[1], at[2]);
}

using Join = std::pair<std::uint32_t, std::uint32_t>;

// The pieces that a leaf's edges across its upper faces join, each pair once in a row.
class Joins {
 public:
  Joins(const SurfaceOctree& grid, const Field<std::uint8_t>& crossed, const Pieces& pieces, std::vector<Join>& out)
      : grid_(grid), crossed_(crossed), pieces_(pieces), out_(out) {}

  void across_upper_face(std::size_t leaf, int axis) {
    const Octree& tree = grid_.octree;
    const int dir = direction(axis == 0, axis == 1, axis == 2);
    const auto others = tree.neighbors(leaf, dir);
    const auto is_whole = [&](std::uint32_t other) { return pieces_.count(other) == 1; };
    if (!grid_.near_surface(leaf) && std::all_of(others.begin(), others.end(), is_whole)) {
      for (const std::uint32_t other : others) add(pieces_.first[leaf], pieces_.first[other]);
      return;
    }
    for (int b = 0; b < kBlockSide; ++b)
      for (int a = 0; a < kBlockSide; ++a) {
        const std::size_t here = face_node(axis, kBlockSide - 1, a, b);
        if (crossed_.block(leaf)[here] & (1u << axis)) continue;
        const StoredNode there = next_node(tree, leaf, here, axis);
        if (there.leaf != Octree::kNone) add(pieces_.of(leaf, here), pieces_.of(there.leaf, there.node));
      }
  }

 private:
  void add(std::uint32_t p, std::uint32_t q) {
    if (out_.empty() || out_.back() != Join{p, q}) out_.push_back({p, q});
  }

  const SurfaceOctree& grid_;
  const Field<std::uint8_t>& crossed_;
  const Pieces& pieces_;
  std::vector<Join>& out_;
};

// Numbers the regions by their first pieces.
void number_regions(const SurfaceOctree& grid, const Field<std::uint8_t>& crossed, Pieces& pieces, Progress& progress) {
  const std::size_t leaves = grid.octree.size();
  std::vector<std::vector<Join>> joins((leaves + kGrain - 1) / kGrain);
  parallel_ranges(leaves, kGrain, [&](std::size_t begin, std::size_t end) {
    progress.check();
    Joins found(grid, crossed, pieces, joins[begin / kGrain]);
    for (std::size_t leaf = begin; leaf < end; ++leaf)
      for (int axis = 0; axis < 3; ++axis) found.across_upper_face(leaf, axis);
  });
  const std::size_t count = pieces.first.back();
  UnionFind forest(count);
  for (const auto& part : joins)
    for (const auto& [p, q] : part) forest.unite(p, q);
  constexpr std::uint32_t kNone = 0xffffffffu;
  std::vector<std::uint32_t> number(count, kNone);
  pieces.region.resize(count);
  for (std::uint32_t p = 0; p < count; ++p) {
    std::uint32_t& n = number[forest.find(p)];
    if (n == kNone) n = static_cast<std::uint32_t>(pieces.regions++);
    pieces.region[p] = n;
  }
}

}  // namespace

std::uint16_t label_block(const std::uint8_t* crossed, std::uint16_t* label) {
  if (std::all_of(crossed, crossed + kBlockNodes, [](std::uint8_t bits) { return bits == 0; })) {
    std::fill_n(label, kBlockNodes, std::uint16_t{0});
    return 1;
  }
  // Runs of uncrossed x edges first; then what edges along y and z join.
  std::uint16_t runs = 0;
  for (std::size_t n = 0; n < kBlockNodes; ++n) {
    const bool goes_on = n % kBlockSide != 0 && !(crossed[n - 1] & 1u);
    label[n] = goes_on ? label[n - 1] : runs++;
  }
  UnionFind forest(runs);
  unite_along(crossed, label, kBlockSide, 2, forest);
  unite_along(crossed, label, std::size_t{kBlockSide} * kBlockSide, 4, forest);
  std::array<std::uint16_t, kBlockNodes> number;
  std::uint16_t count = 0;
  for (std::uint16_t run = 0; run < runs; ++run) {
    const std::uint32_t root = forest.find(run);
    number[run] = root == run ? count++ : number[root];
  }
  for (std::size_t n = 0; n < kBlockNodes; ++n) label[n] = number[label[n]];
  return count;
}

Pieces find_pieces(const SurfaceOctree& grid, const Field<std::uint8_t>& crossed, Progress& progress) {
  const std::size_t leaves = grid.octree.size();
  Pieces pieces;
  pieces.label = Field<std::uint16_t>::like(crossed, 0, 0);
  pieces.first.assign(leaves + 1, 1);
  pieces.first.back() = 0;
  parallel_for(
      leaves,
      [&](std::size_t leaf) {
        if (grid.near_surface(leaf)) pieces.first[leaf] = label_block(crossed.block(leaf), pieces.label.block(leaf));
      },
      kGrain);
  std::uint64_t total = 0;
  for (const std::uint32_t n : pieces.first) total += n;
  require_pieces(total);
  exclusive_scan_in_place(pieces.first);
  number_regions(grid, crossed, pieces, progress);
  return pieces;
}

}  // namespace burnish::detail
