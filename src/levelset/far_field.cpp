#include "burnish/levelset/far_field.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr std::size_t kMostCandidates = 128;
constexpr std::size_t kKeptPerPlace = 6;
constexpr std::array<int, 3> kPlaces{0, 4, 8};        // along each axis of a leaf
constexpr std::array<int, 4> kSampled{0, 2, 5, 7};  // along each axis of a neighbour

void add_sampled(const DistanceField& field, std::size_t leaf, std::vector<std::uint32_t>& candidates) {
  const std::uint32_t* nearest = field.nearest.block(leaf);
  for (const int k : kSampled)
    for (const int j : kSampled)
      for (const int i : kSampled)
        if (const std::uint32_t f = nearest[node_index(i, j, k)]; f != kNoFacet) candidates.push_back(f);
}

void add_own(const DistanceField& field, std::size_t leaf, std::vector<std::uint32_t>& candidates) {
  const std::uint32_t* nearest = field.nearest.block(leaf);
  for (std::size_t n = 0; n < kBlockNodes; ++n)
    if (nearest[n] != kNoFacet) candidates.push_back(nearest[n]);
}

void sort_each_once(std::vector<std::uint32_t>& candidates) {
  std::sort(candidates.begin(), candidates.end());
  candidates.erase(std::unique(candidates.begin(), candidates.end()), candidates.end());
}

// A facet is within a ball.
struct Ball {
  Vec3 middle;
  double radius = 0;
};

Ball ball_around(const TriangleSoup& soup, std::uint32_t f) {
  const Vec3 middle = (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3;
  double radius = 0;
  for (int i = 0; i < 3; ++i) radius = std::max(radius, norm(soup.corner(f, i) - middle));
  return {middle, radius};
}

// Sorted, each once; if there are too many, those that may be the closest of 27 places all over the leaf, by the balls around them. [T-FAR-1]
void thin_out(const TriangleSoup& soup, const Octree& tree, std::size_t leaf, std::vector<std::uint32_t>& candidates) {
  sort_each_once(candidates);
  if (candidates.size() <= kMostCandidates) return;
  std::vector<Ball> balls;
  balls.reserve(candidates.size());
  for (const std::uint32_t f : candidates) balls.push_back(ball_around(soup, f));
  std::vector<std::pair<double, std::uint32_t>> nearest(candidates.size());
  std::vector<std::uint32_t> kept;
  for (const int k : kPlaces)
    for (const int j : kPlaces)
      for (const int i : kPlaces) {
        const LatticeNode node = lattice_node(tree, leaf, i, j, k);
        const Vec3 place{static_cast<double>(node.x), static_cast<double>(node.y), static_cast<double>(node.z)};
        for (std::size_t c = 0; c < candidates.size(); ++c) nearest[c] = {norm(balls[c].middle - place) - balls[c].radius, candidates[c]};
        std::nth_element(nearest.begin(), nearest.begin() + kKeptPerPlace, nearest.end());
        for (std::size_t c = 0; c < kKeptPerPlace; ++c) kept.push_back(nearest[c].second);
      }
  sort_each_once(kept);
  candidates.swap(kept);
}

// [T-FAR-1]
class FarField {
 public:
  FarField(const TriangleSoup& soup, const SurfaceOctree& grid, DistanceField& field, Progress& progress)
      : soup_(soup), tree_(grid.octree), field_(field), progress_(progress), wave_of_(tree_.size(), kUnreached) {
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf) {
      const std::uint32_t* nearest = field.nearest.block(leaf);
      if (std::any_of(nearest, nearest + kBlockNodes, [](std::uint32_t f) { return f != kNoFacet; })) {
        wave_of_[leaf] = 0;
        front_.push_back(leaf);
      }
    }
  }

  void run() {
    // First the rest of the band's own leaves, from values that are exact; then their neighbours, wave by wave.
    fill(front_, 1);
    for (int wave = 1; !front_.empty(); ++wave) {
      advance(wave);
      fill(front_, wave);
    }
  }

 private:
  static constexpr int kUnreached = 1 << 30;

  void advance(int wave) {
    std::vector<std::uint32_t> next;
    for (const std::uint32_t leaf : front_)
      for (int dir = 0; dir < kDirections; ++dir)
        for (const std::uint32_t other : tree_.neighbors(leaf, dir))
          if (wave_of_[other] == kUnreached) {
            wave_of_[other] = wave;
            next.push_back(other);
          }
    std::sort(next.begin(), next.end());
    front_.swap(next);
  }

  // Leaves read what waves before `wave` left and write their own far nodes: into copies first, so that leaves of one
  // wave do not see each other's work.
  void fill(const std::vector<std::uint32_t>& leaves, int wave) {
    struct Values {
      std::array<float, kBlockNodes> distance;
      std::array<std::uint32_t, kBlockNodes> nearest;
    };
    std::vector<Values> values(leaves.size());
    parallel_for(
        leaves.size(),
        [&](std::size_t i) {
          progress_.check();
          compute(leaves[i], wave, values[i].distance.data(), values[i].nearest.data());
        },
        8);
    for (std::size_t i = 0; i < leaves.size(); ++i) {
      std::copy(values[i].distance.begin(), values[i].distance.end(), field_.distance.block(leaves[i]));
      std::copy(values[i].nearest.begin(), values[i].nearest.end(), field_.nearest.block(leaves[i]));
    }
  }

  void compute(std::uint32_t leaf, int wave, float* distance, std::uint32_t* nearest) const {
    const float* old_distance = field_.distance.block(leaf);
    const std::uint32_t* old_nearest = field_.nearest.block(leaf);
    std::copy(old_distance, old_distance + kBlockNodes, distance);
    std::copy(old_nearest, old_nearest + kBlockNodes, nearest);
    if (std::find(old_nearest, old_nearest + kBlockNodes, kNoFacet) == old_nearest + kBlockNodes) return;
    std::vector<std::uint32_t> candidates;
    add_own(field_, leaf, candidates);
    for (int dir = 0; dir < kDirections; ++dir)
      for (const std::uint32_t other : tree_.neighbors(leaf, dir))
        if (dir != kSelf && wave_of_[other] < wave) add_sampled(field_, other, candidates);
    thin_out(soup_, tree_, leaf, candidates);
    std::array<double, kBlockNodes> squared;
    std::array<std::uint32_t, kBlockNodes> ids;
    squared_distances_to(soup_, candidates, tree_, leaf, squared.data(), ids.data());
    for (std::size_t n = 0; n < kBlockNodes; ++n) {
      if (old_nearest[n] != kNoFacet || ids[n] == kNoFacet) continue;
      distance[n] = static_cast<float>(std::sqrt(squared[n]));
      nearest[n] = ids[n];
    }
  }

  const TriangleSoup& soup_;
  const Octree& tree_;
  DistanceField& field_;
  Progress& progress_;
  std::vector<int> wave_of_;          // when a leaf is filled; 0: has nodes within the band
  std::vector<std::uint32_t> front_;
};

}  // namespace

void spread_far_field(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, DistanceField& field, Progress& progress) {
  field.distance.make_dense(grid.octree.size());
  field.nearest.make_dense(grid.octree.size());
  FarField(lattice_soup, grid, field, progress).run();
}

}  // namespace burnish
