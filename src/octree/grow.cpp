#include "burnish/octree/grow.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/octree/field.h"

namespace burnish {
namespace {

constexpr std::size_t kFacetGrain = 4096;

// A facet that concerns a finest block.
struct Pair {
  std::uint64_t block;  // interleaved position
  std::uint32_t facet;
  friend constexpr auto operator<=>(const Pair&, const Pair&) = default;
};

// Descends from one octant to the finest blocks near one facet.
class Descent {
 public:
  Descent(const TriangleSoup& soup, double band, std::vector<Pair>& out) : soup_(soup), band_(band), out_(out) {}

  void run(std::uint32_t facet) {
    facet_ = facet;
    a_ = soup_.corner(facet, 0);
    b_ = soup_.corner(facet, 1);
    c_ = soup_.corner(facet, 2);
    const Vec3 low = min(min(a_, b_), c_) - Vec3{1, 1, 1} * band_;
    const Vec3 high = max(max(a_, b_), c_) + Vec3{1, 1, 1} * band_;
    // Start at the level at which the facet spans at most two octants an axis.
    const double reach = std::max({high.x - low.x, high.y - low.y, high.z - low.z}) / kBlockSide;
    int level = 0;
    while (std::ldexp(1.0, level) < reach) ++level;
    const double size = kBlockSide * std::ldexp(1.0, level);
    const auto octant = [&](double x) { return static_cast<std::uint32_t>(std::floor(x / size)); };
    for (std::uint32_t z = octant(low.z); z <= octant(high.z); ++z)
      for (std::uint32_t y = octant(low.y); y <= octant(high.y); ++y)
        for (std::uint32_t x = octant(low.x); x <= octant(high.x); ++x) visit(morton::interleave({x, y, z}), level);
  }

 private:
  void visit(std::uint64_t octant, int level) {
    const double half = 0.5 * kBlockSide * std::ldexp(1.0, level);
    const morton::Position p = morton::deinterleave(octant);
    const Vec3 center{(2 * p.x + 1) * half, (2 * p.y + 1) * half, (2 * p.z + 1) * half};
    if (!triangle_overlaps_cube(a_, b_, c_, center, half + band_)) return;
    if (level == 0) {
      out_.push_back({octant, facet_});
      return;
    }
    for (std::uint64_t child = 0; child < 8; ++child) visit(octant << 3 | child, level - 1);
  }

  const TriangleSoup& soup_;
  const double band_;
  std::vector<Pair>& out_;
  std::uint32_t facet_ = 0;
  Vec3 a_, b_, c_;
};

std::vector<Pair> facets_near_blocks(const TriangleSoup& soup, double band, Progress& progress) {
  const std::size_t chunks = (soup.facets.size() + kFacetGrain - 1) / kFacetGrain;
  std::vector<std::vector<Pair>> found(chunks);
  parallel_ranges(soup.facets.size(), kFacetGrain, [&](std::size_t begin, std::size_t end) {
    progress.check();
    Descent descent(soup, band, found[begin / kFacetGrain]);
    for (std::size_t f = begin; f < end; ++f) descent.run(static_cast<std::uint32_t>(f));
  });
  std::vector<Pair> all;
  std::size_t total = 0;
  for (const auto& part : found) total += part.size();
  all.reserve(total);
  for (auto& part : found) {
    all.insert(all.end(), part.begin(), part.end());
    std::vector<Pair>().swap(part);
  }
  parallel_sort(all);
  return all;
}

// The blocks and the 26 around each, within the domain: one axis after the other.
std::vector<std::uint64_t> with_neighbors(std::vector<std::uint64_t> blocks, int depth) {
  const std::uint32_t side = 1u << depth;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t n = blocks.size();
    for (std::size_t i = 0; i < n; ++i) {
      const morton::Position p = morton::deinterleave(blocks[i]);
      for (const std::uint32_t step : {0u - 1u, 1u}) {
        const morton::Position q{p.x + (axis == 0 ? step : 0), p.y + (axis == 1 ? step : 0), p.z + (axis == 2 ? step : 0)};
        if (q.x < side && q.y < side && q.z < side) blocks.push_back(morton::interleave(q));
      }
    }
    parallel_sort(blocks);
    blocks.erase(std::unique(blocks.begin(), blocks.end()), blocks.end());
  }
  return blocks;
}

}  // namespace

bool triangle_overlaps_cube(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& center, double half) {  // [T-OCT-3]
  const std::array<Vec3, 3> v{a - center, b - center, c - center};
  for (int axis = 0; axis < 3; ++axis) {
    if (std::min({v[0][axis], v[1][axis], v[2][axis]}) > half) return false;
    if (std::max({v[0][axis], v[1][axis], v[2][axis]}) < -half) return false;
  }
  const std::array<Vec3, 3> e{v[1] - v[0], v[2] - v[1], v[0] - v[2]};
  const Vec3 n = cross(e[0], e[1]);
  if (std::abs(dot(n, v[0])) > half * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z))) return false;
  for (std::size_t i = 0; i < 3; ++i) {
    // Axis cross(unit(k), e): two vertices project to the same value, so the third and one of them decide.
    const Vec3 &p = v[i], &q = v[(i + 2) % 3];
    for (int k = 0; k < 3; ++k) {
      const int u = (k + 1) % 3, w = (k + 2) % 3;
      const double pp = e[i][u] * p[w] - e[i][w] * p[u], pq = e[i][u] * q[w] - e[i][w] * q[u];
      const double reach = half * (std::abs(e[i][u]) + std::abs(e[i][w]));
      if (std::min(pp, pq) > reach || std::max(pp, pq) < -reach) return false;
    }
  }
  return true;
}

SurfaceOctree grow_uniform_band(const TriangleSoup& lattice_soup, int depth, double band, int rings, Progress& progress) {
  const std::vector<Pair> pairs = facets_near_blocks(lattice_soup, band, progress);
  std::vector<std::uint64_t> finest;
  for (const Pair& pair : pairs)
    if (finest.empty() || finest.back() != pair.block) finest.push_back(pair.block);
  for (int ring = 0; ring < rings; ++ring) finest = with_neighbors(std::move(finest), depth);
  SurfaceOctree result;
  result.octree = Octree::build(depth, finest);
  result.first_facet.assign(result.octree.size() + 1, 0);
  result.facets.reserve(pairs.size());
  // Pairs and leaves both follow the Morton curve: one merge fills the lists.
  std::size_t i = 0;
  for (std::size_t leaf = 0; leaf < result.octree.size(); ++leaf) {
    result.first_facet[leaf] = result.facets.size();
    const std::uint64_t key = result.octree.key(leaf);
    for (; i < pairs.size() && morton::key(pairs[i].block, 0) == key; ++i) result.facets.push_back(pairs[i].facet);
  }
  result.first_facet.back() = result.facets.size();
  return result;
}

}  // namespace burnish
