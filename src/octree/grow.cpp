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
constexpr double kRounding = 1e-6;  // cells: a block that much too far away may be taken along

// Descends from one octant to the finest blocks near one facet.
class Descent {
 public:
  Descent(const TriangleSoup& soup, double band) : soup_(soup), band_(band) {}

  // Calls emit(block) for every finest block near the facet, by interleaved position.
  template <class Emit>
  void run(std::uint32_t facet, Emit&& emit) const {
    const Vec3 &a = soup_.corner(facet, 0), &b = soup_.corner(facet, 1), &c = soup_.corner(facet, 2);
    const TriangleNearBox near(a, b, c, band_ + kRounding);
    const Vec3 low = min(min(a, b), c) - Vec3{1, 1, 1} * band_;
    const Vec3 high = max(max(a, b), c) + Vec3{1, 1, 1} * band_;
    // Start at the level at which the facet spans at most two octants an axis.
    const double reach = std::max({high.x - low.x, high.y - low.y, high.z - low.z}) / kBlockSide;
    int level = 0;
    while (static_cast<double>(1u << level) < reach) ++level;
    const double per_octant = 1.0 / (kBlockSide * static_cast<double>(1u << level));  // a power of two
    const auto octant = [&](double x) { return static_cast<std::uint32_t>(x * per_octant); };
    for (std::uint32_t z = octant(low.z); z <= octant(high.z); ++z)
      for (std::uint32_t y = octant(low.y); y <= octant(high.y); ++y)
        for (std::uint32_t x = octant(low.x); x <= octant(high.x); ++x) visit(near, {x, y, z}, level, emit);
  }

 private:
  template <class Emit>
  static void visit(const TriangleNearBox& near, const morton::Position& p, int level, Emit& emit) {
    // The box of the octant's nodes, which end a cell before its upper faces.
    const double size = kBlockSide * static_cast<double>(1u << level), half = 0.5 * (size - 1);
    if (!near({p.x * size + half, p.y * size + half, p.z * size + half}, half)) return;
    if (level == 0) return emit(morton::interleave(p));
    for (std::uint32_t child = 0; child < 8; ++child)
      visit(near, {2 * p.x + (child & 1), 2 * p.y + (child >> 1 & 1), 2 * p.z + (child >> 2)}, level - 1, emit);
  }

  const TriangleSoup& soup_;
  const double band_;
};

// The facets of one chunk by the blocks that they are near to: those of blocks[i] are facets[first[i]] to first[i + 1].
struct ChunkLists {
  std::vector<std::uint64_t> blocks;
  std::vector<std::uint32_t> first;
  std::vector<std::uint32_t> facets;
};

// Numbers blocks in the order in which they turn up: a chunk's facets lie together, so there are few.
class BlockNumbers {
 public:
  BlockNumbers() : slots_(1024, kFree) {}

  std::uint32_t number(std::uint64_t block) {
    if (!blocks_.empty() && blocks_[last_] == block) return last_;
    std::size_t slot = find(block);
    if (slots_[slot] == kFree) {
      slots_[slot] = static_cast<std::uint32_t>(blocks_.size());
      blocks_.push_back(block);
      if (2 * blocks_.size() > slots_.size()) {
        grow();
        slot = find(block);
      }
    }
    return last_ = slots_[slot];
  }
  const std::vector<std::uint64_t>& blocks() const { return blocks_; }

 private:
  static constexpr std::uint32_t kFree = 0xffffffffu;

  std::size_t find(std::uint64_t block) const {
    std::uint64_t hash = block * 0x9e3779b97f4a7c15ull;
    for (std::size_t slot = (hash ^ hash >> 29) & (slots_.size() - 1);; slot = (slot + 1) & (slots_.size() - 1))
      if (slots_[slot] == kFree || blocks_[slots_[slot]] == block) return slot;
  }
  void grow() {
    slots_.assign(slots_.size() * 2, kFree);
    for (std::uint32_t i = 0; i < blocks_.size(); ++i) slots_[find(blocks_[i])] = i;
  }

  std::vector<std::uint32_t> slots_;
  std::vector<std::uint64_t> blocks_;
  std::uint32_t last_ = 0;
};

ChunkLists lists_of_chunk(const Descent& descent, std::size_t begin, std::size_t end) {
  struct Pair {
    std::uint32_t block, facet;
  };
  BlockNumbers numbers;
  std::vector<Pair> pairs;
  pairs.reserve(8 * (end - begin));
  for (std::size_t f = begin; f < end; ++f) {
    const auto facet = static_cast<std::uint32_t>(f);
    descent.run(facet, [&](std::uint64_t block) { pairs.push_back({numbers.number(block), facet}); });
  }
  ChunkLists lists;
  lists.blocks = numbers.blocks();
  lists.first.assign(lists.blocks.size() + 1, 0);
  lists.facets.resize(pairs.size());
  for (const Pair& pair : pairs) ++lists.first[pair.block];
  exclusive_scan_in_place(lists.first);
  std::vector<std::uint32_t> next = lists.first;
  for (const Pair& pair : pairs) lists.facets[next[pair.block]++] = pair.facet;
  return lists;
}

// One chunk's facets near one block.
struct Run {
  std::uint64_t block;
  std::uint32_t chunk, index;
  friend constexpr auto operator<=>(const Run&, const Run&) = default;
};

// The facets near every block: runs in the order of blocks, then of facets.
struct NearFacets {
  std::vector<ChunkLists> chunks;
  std::vector<Run> runs;

  std::span<const std::uint32_t> facets(const Run& run) const {
    const ChunkLists& lists = chunks[run.chunk];
    return {lists.facets.data() + lists.first[run.index], lists.first[run.index + 1] - lists.first[run.index]};
  }
};

NearFacets facets_near_blocks(const TriangleSoup& soup, double band, Progress& progress) {
  NearFacets near;
  near.chunks.resize((soup.facets.size() + kFacetGrain - 1) / kFacetGrain);
  const Descent descent(soup, band);
  parallel_ranges(soup.facets.size(), kFacetGrain, [&](std::size_t begin, std::size_t end) {
    progress.check();
    near.chunks[begin / kFacetGrain] = lists_of_chunk(descent, begin, end);
  });
  std::size_t total = 0;
  for (const ChunkLists& lists : near.chunks) total += lists.blocks.size();
  near.runs.reserve(total);
  for (std::uint32_t c = 0; c < near.chunks.size(); ++c)
    for (std::uint32_t i = 0; i < near.chunks[c].blocks.size(); ++i) near.runs.push_back({near.chunks[c].blocks[i], c, i});
  parallel_sort(near.runs);
  return near;
}

// Fills the lists of the octree's leaves. Runs and leaves both follow the Morton curve.
void list_facets(const NearFacets& near, SurfaceOctree& result) {
  const std::size_t leaves = result.octree.size();
  std::vector<std::size_t> first_run(leaves + 1, near.runs.size());
  result.first_facet.assign(leaves + 1, 0);
  std::size_t r = 0;
  for (std::size_t leaf = 0; leaf < leaves; ++leaf) {
    first_run[leaf] = r;
    const std::uint64_t key = result.octree.key(leaf);
    for (; r < near.runs.size() && morton::key(near.runs[r].block, 0) == key; ++r)
      result.first_facet[leaf] += near.facets(near.runs[r]).size();
  }
  result.facets.resize(exclusive_scan_in_place(result.first_facet));
  parallel_for(leaves, [&](std::size_t leaf) {
    auto to = result.facets.begin() + static_cast<std::ptrdiff_t>(result.first_facet[leaf]);
    for (std::size_t i = first_run[leaf]; i < first_run[leaf + 1]; ++i) {
      const auto facets = near.facets(near.runs[i]);
      to = std::copy(facets.begin(), facets.end(), to);
    }
  });
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
  // All three vertices: the normal of a triangle that is a line but for rounding is any direction.
  const Vec3 n = cross(e[0], e[1]);
  const std::array<double, 3> height{dot(n, v[0]), dot(n, v[1]), dot(n, v[2])};
  const double across = half * (std::abs(n.x) + std::abs(n.y) + std::abs(n.z));
  if (*std::min_element(height.begin(), height.end()) > across || *std::max_element(height.begin(), height.end()) < -across) return false;
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

TriangleNearBox::TriangleNearBox(const Vec3& a, const Vec3& b, const Vec3& c, double reach)
    : a_(a), reach_squared_(reach * reach), low_(min(min(a, b), c) - a), high_(max(max(a, b), c) - a) {
  const std::array<Vec3, 3> v{Vec3{}, b - a, c - a};
  const Vec3 extent = high_ - low_;
  extent_ = std::max({extent.x, extent.y, extent.z});
  const auto add = [&](std::size_t at, const Vec3& axis, double low, double high) {
    axes_[at] = {axis, low, high, std::abs(axis.x) + std::abs(axis.y) + std::abs(axis.z), reach_squared_ * squared_norm(axis)};
  };
  // Of a triangle that is a line but for rounding the normal is any direction: its projection on that is no point.
  const Vec3 n = cross(v[1], v[2]);
  const double n1 = dot(n, v[1]), n2 = dot(n, v[2]);
  add(0, n, std::min({n1, n2, 0.0}), std::max({n1, n2, 0.0}));
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 e = v[(i + 1) % 3] - v[i];
    for (int k = 0; k < 3; ++k) {
      Vec3 unit;
      unit[k] = 1;
      const Vec3 axis = cross(unit, e);
      // Two vertices project to the same value, so the third and one of them decide.
      const double p = dot(axis, v[i]), q = dot(axis, v[(i + 2) % 3]);
      add(1 + 3 * i + static_cast<std::size_t>(k), axis, std::min(p, q), std::max(p, q));
    }
  }
}

bool TriangleNearBox::operator()(const Vec3& center, double half) const {  // [T-OCT-4]
  const Vec3 at = center - a_;
  double gap_squared = 0;
  for (int k = 0; k < 3; ++k) {
    const double gap = std::max({low_[k] - at[k] - half, at[k] - half - high_[k], 0.0});
    gap_squared += gap * gap;
  }
  if (gap_squared > reach_squared_) return false;
  // Of a triangle smaller than the cube the normal says it all, nearly.
  const std::size_t asked = extent_ <= half ? 1 : axes_.size();
  for (std::size_t i = 0; i < asked; ++i) {
    const Axis& axis = axes_[i];
    const double p = dot(axis.direction, at), box = half * axis.box;
    const double gap = std::max(axis.low - p, p - axis.high) - box;
    if (gap > 0 && gap * gap > axis.reach_squared) return false;
  }
  return true;
}

SurfaceOctree grow_uniform_band(const TriangleSoup& lattice_soup, int depth, double band, int rings, Progress& progress) {
  const NearFacets near = facets_near_blocks(lattice_soup, band, progress);
  std::vector<std::uint64_t> finest;
  for (const Run& run : near.runs)
    if (finest.empty() || finest.back() != run.block) finest.push_back(run.block);
  for (int ring = 0; ring < rings; ++ring) finest = with_neighbors(std::move(finest), depth);
  SurfaceOctree result;
  result.octree = Octree::build(depth, finest);
  list_facets(near, result);
  // Leaves and finest blocks both follow the Morton curve.
  auto next = finest.begin();
  result.layout = layout_of(result.octree.size(), [&](std::size_t leaf) {
    if (next == finest.end() || morton::key(*next, 0) != result.octree.key(leaf)) return false;
    ++next;
    return true;
  });
  return result;
}

}  // namespace burnish
