#include "burnish/levelset/sign.h"

#include <algorithm>
#include <array>
#include <cstring>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"

namespace burnish {
namespace {

constexpr double kOutside = 0.25, kInside = 0.75;  // samples beyond these leave no doubt

Vec3 position(const Octree& tree, std::size_t leaf, std::size_t node) {
  const int n = static_cast<int>(node);
  const LatticeNode at = lattice_node(tree, leaf, n % kBlockSide, n / kBlockSide % kBlockSide, n / kBlockSide / kBlockSide);
  return {static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
}

// The connected pieces of single blocks, numbered through all blocks. [T-SIGN-2]
struct Pieces {
  Field<std::uint16_t> label;        // of a node within its block
  std::vector<std::uint64_t> first;  // number of a block's first piece; size: leaves + 1

  std::uint64_t of(std::size_t leaf, std::size_t node) const { return first[leaf] + label.block(leaf)[node]; }
};

// Labels one block's nodes; returns the number of pieces.
std::size_t label_block(const std::uint8_t* crossed, std::uint16_t* label) {
  constexpr std::uint16_t kUnseen = 0xffff;
  constexpr std::array<std::size_t, 3> kStride{1, kBlockSide, kBlockSide * kBlockSide};
  std::fill_n(label, kBlockNodes, kUnseen);
  std::array<std::uint16_t, kBlockNodes> stack;
  std::uint16_t count = 0;
  for (std::size_t seed = 0; seed < kBlockNodes; ++seed) {
    if (label[seed] != kUnseen) continue;
    std::size_t top = 0;
    const auto reach = [&](std::size_t node) {
      if (label[node] != kUnseen) return;
      label[node] = count;
      stack[top++] = static_cast<std::uint16_t>(node);
    };
    reach(seed);
    while (top > 0) {
      const std::size_t node = stack[--top];
      for (std::size_t a = 0; a < 3; ++a) {
        const std::size_t along = node / kStride[a] % kBlockSide;
        const auto bit = static_cast<std::uint8_t>(1u << a);
        if (along + 1 < kBlockSide && !(crossed[node] & bit)) reach(node + kStride[a]);
        if (along > 0 && !(crossed[node - kStride[a]] & bit)) reach(node - kStride[a]);
      }
    }
    ++count;
  }
  return count;
}

Pieces label_pieces(const SurfaceOctree& grid, const Field<std::uint8_t>& crossed) {
  const std::size_t leaves = grid.octree.size();
  Pieces pieces{Field<std::uint16_t>(leaves, 0), std::vector<std::uint64_t>(leaves + 1, 0)};
  parallel_for(
      leaves,
      [&](std::size_t leaf) {
        pieces.first[leaf] =
            grid.near_surface(leaf) ? label_block(crossed.block(leaf), pieces.label.block(leaf)) : 1;
      },
      64);
  exclusive_scan_in_place(pieces.first);
  return pieces;
}

// The block's node number of point (a, b) on the face of an axis at `depth`.
std::size_t face_node(int axis, int depth, int a, int b) {
  std::array<int, 3> at{};
  at[static_cast<std::size_t>(axis)] = depth;
  at[static_cast<std::size_t>((axis + 1) % 3)] = a;
  at[static_cast<std::size_t>((axis + 2) % 3)] = b;
  return node_index(at[0], at[1], at[2]);
}

// Joins pieces across block faces. The surface is at least a cell away from coarser blocks, so towards those
// nothing is crossed.
void join_across_faces(const SurfaceOctree& grid, const Field<std::uint8_t>& crossed, const Pieces& pieces, UnionFind& forest) {
  const Octree& tree = grid.octree;
  const auto join = [&](std::uint64_t p, std::uint64_t q) {
    forest.unite(static_cast<std::uint32_t>(p), static_cast<std::uint32_t>(q));
  };
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    for (int axis = 0; axis < 3; ++axis)
      for (const int sign : {-1, +1}) {
        const int dir = direction(axis == 0 ? sign : 0, axis == 1 ? sign : 0, axis == 2 ? sign : 0);
        const NeighborKind kind = tree.neighbor_kind(leaf, dir);
        const bool same = kind == NeighborKind::same && sign > 0;
        if (!same && kind != NeighborKind::coarser) continue;
        const std::size_t other = tree.neighbor(leaf, dir);
        if (!grid.near_surface(leaf) && !grid.near_surface(other)) {
          join(pieces.first[leaf], pieces.first[other]);
          continue;
        }
        for (int b = 0; b < kBlockSide; ++b)
          for (int a = 0; a < kBlockSide; ++a) {
            const std::size_t here = face_node(axis, sign > 0 ? kBlockSide - 1 : 0, a, b);
            const std::size_t there = face_node(axis, 0, a, b);
            if (!same) {
              join(pieces.of(leaf, here), pieces.first[other]);
            } else if (!(crossed.block(leaf)[here] & (1u << axis))) {
              join(pieces.of(leaf, here), pieces.of(other, there));
            }
          }
      }
}

// A node at which the winding number is evaluated on behalf of a region.
struct Sample {
  std::uint32_t region;
  std::uint64_t cube;  // key of the 2 x 2 x 2 blocks it stands for
  float distance;
  std::uint32_t leaf;
  std::uint32_t node;
};

// The node farthest from the surface of every piece, then of every region and cube.
std::vector<Sample> choose_samples(const SurfaceOctree& grid, const Field<float>& distance, const Pieces& pieces,
                                   const std::vector<std::uint32_t>& region_of_piece) {
  std::vector<Sample> samples;
  std::vector<Sample> best;
  for (std::size_t leaf = 0; leaf < grid.octree.size(); ++leaf) {
    const std::size_t count = pieces.first[leaf + 1] - pieces.first[leaf];
    const std::uint64_t key = grid.octree.key(leaf);
    best.assign(count, Sample{0, morton::parent(key), -1.0f, static_cast<std::uint32_t>(leaf), 0});
    if (!grid.near_surface(leaf)) {
      best[0].node = static_cast<std::uint32_t>(node_index(4, 4, 4));
    } else {
      for (std::size_t n = 0; n < kBlockNodes; ++n) {
        Sample& s = best[pieces.label.block(leaf)[n]];
        if (distance.block(leaf)[n] > s.distance) {
          s.distance = distance.block(leaf)[n];
          s.node = static_cast<std::uint32_t>(n);
        }
      }
    }
    for (std::size_t p = 0; p < count; ++p) {
      best[p].region = region_of_piece[pieces.first[leaf] + p];
      samples.push_back(best[p]);
    }
  }
  std::stable_sort(samples.begin(), samples.end(), [](const Sample& a, const Sample& b) {
    return a.region != b.region ? a.region < b.region : a.cube != b.cube ? a.cube < b.cube : a.distance > b.distance;
  });
  samples.erase(std::unique(samples.begin(), samples.end(),
                            [](const Sample& a, const Sample& b) { return a.region == b.region && a.cube == b.cube; }),
                samples.end());
  return samples;
}

struct Verdict {
  double low = 1e300, high = -1e300;

  void add(double w) {
    low = std::min(low, w);
    high = std::max(high, w);
  }
  // [T-SIGN-3]
  bool clear() const { return high < kOutside || low > kInside; }
  bool inside() const { return low > kInside; }
};

// Decides a leaking region's part of one block: by its extremes if they agree, else node by node.
std::size_t decide_leaking_piece(const SurfaceOctree& grid, const Field<float>& distance, const Pieces& pieces,
                                 std::size_t leaf, std::size_t piece, const TriangleIndex& triangles,
                                 std::uint8_t* inside) {
  std::vector<std::size_t> nodes;
  for (std::size_t n = 0; n < kBlockNodes; ++n)
    if (pieces.label.block(leaf)[n] == piece) nodes.push_back(n);
  std::array<std::size_t, 4> probes{nodes.front(), nodes.back(), nodes.front(), nodes.front()};
  for (const std::size_t n : nodes) {
    if (distance.block(leaf)[n] > distance.block(leaf)[probes[2]]) probes[2] = n;
    if (distance.block(leaf)[n] < distance.block(leaf)[probes[3]]) probes[3] = n;
  }
  Verdict verdict;
  for (const std::size_t n : probes) verdict.add(triangles.winding_number(position(grid.octree, leaf, n)));
  if (verdict.clear()) {
    for (const std::size_t n : nodes) inside[n] = verdict.inside();
    return probes.size();
  }
  for (const std::size_t n : nodes) inside[n] = triangles.winding_number(position(grid.octree, leaf, n)) > 0.5;
  return probes.size() + nodes.size();
}

}  // namespace

InsideField classify_nodes(const SurfaceOctree& grid, const Field<float>& distance, const Field<std::uint8_t>& crossed,
                           const TriangleIndex& triangles, Progress& progress) {
  const Octree& tree = grid.octree;
  const Pieces pieces = label_pieces(grid, crossed);
  const std::size_t piece_count = pieces.first.back();
  UnionFind forest(piece_count);
  join_across_faces(grid, crossed, pieces, forest);
  progress.check();

  InsideField result;
  std::vector<std::uint32_t> region_of_piece(piece_count), number(piece_count, 0xffffffffu);
  for (std::uint32_t p = 0; p < piece_count; ++p) {
    std::uint32_t& n = number[forest.find(p)];
    if (n == 0xffffffffu) n = static_cast<std::uint32_t>(result.regions++);
    region_of_piece[p] = n;
  }
  const std::vector<Sample> samples = choose_samples(grid, distance, pieces, region_of_piece);
  std::vector<double> winding(samples.size());
  parallel_for(
      samples.size(),
      [&](std::size_t i) { winding[i] = triangles.winding_number(position(tree, samples[i].leaf, samples[i].node)); },
      64);
  result.evaluations = samples.size();
  std::vector<Verdict> verdicts(result.regions);
  for (std::size_t i = 0; i < samples.size(); ++i) verdicts[samples[i].region].add(winding[i]);
  for (const Verdict& v : verdicts) result.ambiguous_regions += !v.clear();

  result.inside = Field<std::uint8_t>(tree.size(), 0);
  std::vector<std::size_t> evaluations(tree.size(), 0);
  parallel_for(
      tree.size(),
      [&](std::size_t leaf) {
        progress.check();
        std::uint8_t* inside = result.inside.block(leaf);
        for (std::size_t p = pieces.first[leaf]; p < pieces.first[leaf + 1]; ++p) {
          const Verdict& verdict = verdicts[region_of_piece[p]];
          const std::size_t local = p - pieces.first[leaf];
          if (!verdict.clear()) {
            evaluations[leaf] += decide_leaking_piece(grid, distance, pieces, leaf, local, triangles, inside);
          } else if (verdict.inside()) {
            for (std::size_t n = 0; n < kBlockNodes; ++n)
              if (pieces.label.block(leaf)[n] == local) inside[n] = 1;
          }
        }
      },
      16);
  for (const std::size_t e : evaluations) result.evaluations += e;
  return result;
}

}  // namespace burnish
