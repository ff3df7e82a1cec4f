#include "burnish/levelset/sign.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/winding.h"
#include "pieces.h"

namespace burnish {
namespace {

using detail::Pieces;

constexpr double kOutside = 0.25, kInside = 0.75;  // samples beyond these leave no doubt

Vec3 position(const Octree& tree, std::size_t leaf, std::size_t node) {
  const int n = static_cast<int>(node);
  const LatticeNode at = lattice_node(tree, leaf, n % kBlockSide, n / kBlockSide % kBlockSide, n / kBlockSide / kBlockSide);
  return {static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
}

// A node at which the winding number is evaluated on behalf of a region.
struct Sample {
  std::uint32_t region;
  std::uint64_t cube;  // key of the 2 x 2 x 2 blocks it stands for
  float nearness;      // the negative distance to the surface
  std::uint32_t leaf;
  std::uint32_t node;
  friend constexpr auto operator<=>(const Sample&, const Sample&) = default;
};

// The node farthest from the surface of each of a leaf's pieces.
void sample_leaf(const SurfaceOctree& grid, const Field<float>& distance, const Pieces& pieces, std::size_t leaf, Sample* out) {
  const std::uint32_t first = pieces.first[leaf], count = pieces.count(leaf);
  for (std::uint32_t p = 0; p < count; ++p)
    out[p] = {pieces.region[first + p], morton::parent(grid.octree.key(leaf)), 1.0f, static_cast<std::uint32_t>(leaf),
              static_cast<std::uint32_t>(node_index(4, 4, 4))};
  if (!grid.near_surface(leaf)) return;
  for (std::size_t n = 0; n < kBlockNodes; ++n) {
    Sample& s = out[pieces.label.block(leaf)[n]];
    const float nearness = -distance.block(leaf)[n];
    if (nearness >= s.nearness) continue;
    s.nearness = nearness;
    s.node = static_cast<std::uint32_t>(n);
  }
}

// The node farthest from the surface of every piece, then of every region and cube.
std::vector<Sample> choose_samples(const SurfaceOctree& grid, const Field<float>& distance, const Pieces& pieces) {
  std::vector<Sample> samples(pieces.first.back());
  parallel_for(
      grid.octree.size(), [&](std::size_t leaf) { sample_leaf(grid, distance, pieces, leaf, &samples[pieces.first[leaf]]); }, 64);
  parallel_sort(samples);
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

constexpr std::uint8_t kCertain = 255;

// [T-SIGN-3]
std::uint8_t certainty_of(double w) { return static_cast<std::uint8_t>(std::lround(kCertain * std::min(1.0, std::abs(2 * w - 1)))); }

// Decides a leaking region's part of one block: by its extremes if they agree, else node by node.
std::size_t decide_leaking_piece(const SurfaceOctree& grid, const Field<float>& distance, const Pieces& pieces,
                                 std::size_t leaf, std::size_t piece, const TriangleIndex& triangles,
                                 std::uint8_t* inside, std::uint8_t* certainty) {
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
    const std::uint8_t least = std::min(certainty_of(verdict.low), certainty_of(verdict.high));
    for (const std::size_t n : nodes) inside[n] = verdict.inside(), certainty[n] = least;
    return probes.size();
  }
  for (const std::size_t n : nodes) {
    const double w = triangles.winding_number(position(grid.octree, leaf, n));
    inside[n] = w > 0.5, certainty[n] = certainty_of(w);
  }
  return probes.size() + nodes.size();
}

// The winding number at the samples: whole numbers about a closed chain, else from the index, which is made for it.
std::vector<double> winding_at(const std::vector<Vec3>& points, const TriangleSoup& soup, std::optional<TriangleIndex>& triangles) {
  if (is_closed_chain(soup)) {
    const std::vector<std::int32_t> winding = winding_numbers(soup, points);
    return {winding.begin(), winding.end()};
  }
  triangles.emplace(soup);
  std::vector<double> winding(points.size());
  parallel_for(
      points.size(), [&](std::size_t i) { winding[i] = triangles->winding_number(points[i]); }, 64);
  return winding;
}

// One verdict per region, from samples of the winding number.
std::vector<Verdict> judge_regions(const SurfaceOctree& grid, const Field<float>& distance, const Pieces& pieces,
                                   const TriangleSoup& soup, std::optional<TriangleIndex>& triangles, InsideField& result) {
  const std::vector<Sample> samples = choose_samples(grid, distance, pieces);
  std::vector<Vec3> points(samples.size());
  parallel_for(points.size(), [&](std::size_t i) { points[i] = position(grid.octree, samples[i].leaf, samples[i].node); });
  const std::vector<double> winding = winding_at(points, soup, triangles);
  result.evaluations += samples.size();
  std::vector<Verdict> verdicts(pieces.regions);
  for (std::size_t i = 0; i < samples.size(); ++i) verdicts[samples[i].region].add(winding[i]);
  return verdicts;
}

}  // namespace

InsideField classify_nodes(const SurfaceOctree& grid, const Field<float>& distance, const Field<std::uint8_t>& crossed,
                           const TriangleSoup& lattice_soup, Progress& progress) {
  const Octree& tree = grid.octree;
  const Pieces pieces = detail::find_pieces(grid, crossed, progress);
  InsideField result;
  result.regions = pieces.regions;
  std::optional<TriangleIndex> triangles;
  const std::vector<Verdict> verdicts = judge_regions(grid, distance, pieces, lattice_soup, triangles, result);
  for (const Verdict& v : verdicts) result.ambiguous_regions += !v.clear();
  if (result.ambiguous_regions > 0 && !triangles) triangles.emplace(lattice_soup);

  result.inside = Field<std::uint8_t>::like(crossed, 0, 1);
  // A region that leaks may be decided node by node far from the surface too.
  if (result.ambiguous_regions > 0) {
    result.inside.make_dense(tree.size());
    result.certainty = Field<std::uint8_t>(tree.size(), kCertain);
  }
  std::vector<std::size_t> evaluations(tree.size(), 0);
  parallel_for(
      tree.size(),
      [&](std::size_t leaf) {
        progress.check();
        for (std::uint32_t local = 0; local < pieces.count(leaf); ++local) {
          const Verdict& verdict = verdicts[pieces.region[pieces.first[leaf] + local]];
          if (!verdict.clear()) {
            evaluations[leaf] += decide_leaking_piece(grid, distance, pieces, leaf, local, *triangles, result.inside.block(leaf), result.certainty.block(leaf));
          } else if (!verdict.inside()) {
            continue;
          } else if (!result.inside.stores(leaf)) {
            result.inside.set_uniform(leaf, true);
          } else {
            std::uint8_t* inside = result.inside.block(leaf);
            const std::uint16_t* label = pieces.label.block(leaf);
            for (std::size_t n = 0; n < kBlockNodes; ++n) inside[n] |= label[n] == local;
          }
        }
      },
      16);
  for (const std::size_t e : evaluations) result.evaluations += e;
  return result;
}

}  // namespace burnish
