#include "burnish/octree/refine.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "cell_scatter.h"

namespace burnish {
namespace {

constexpr std::size_t kFacetGrain = 2048, kOctantGrain = 16;
constexpr std::uint8_t kNothing = 255;
constexpr std::uint64_t kBytesPerDivision = 3000;  // keys and links of the octants that one makes, and of the balance around them
constexpr double kRounding = 1e-6;  // cells

// Octants of one level with their facets.
struct Layer {
  int level = 0;
  std::vector<std::uint64_t> octants;   // interleaved positions
  std::vector<std::uint64_t> first{0};  // CSR
  std::vector<std::uint32_t> facets;

  std::size_t size() const { return octants.size(); }
  std::uint64_t key(std::size_t i) const { return morton::key(octants[i], level); }
  std::span<const std::uint32_t> facets_of(std::size_t i) const {
    return {facets.data() + first[i], static_cast<std::size_t>(first[i + 1] - first[i])};
  }
};

// The octants with chosen[i] == which.
Layer selected(const Layer& layer, const std::vector<char>& chosen, char which) {
  Layer part;
  part.level = layer.level;
  for (std::size_t i = 0; i < layer.size(); ++i) {
    if (chosen[i] != which) continue;
    const auto list = layer.facets_of(i);
    part.octants.push_back(layer.octants[i]);
    part.facets.insert(part.facets.end(), list.begin(), list.end());
    part.first.push_back(part.facets.size());
  }
  return part;
}

class Growth {
 public:
  Growth(const TriangleSoup& soup, int depth, const GrowthOptions& options, std::span<const RefinementCriterion* const> criteria,
         Progress& progress)
      : soup_(soup), depth_(depth), options_(options), criteria_(criteria), progress_(progress), kept_(static_cast<std::size_t>(depth) + 1) {}

  AdaptiveGrowth run() {
    AdaptiveGrowth result;
    result.statistics.divided_by.resize(criteria_.size());
    grow(result.statistics);
    result.grid.octree = Octree::build_graded(depth_, std::move(asked_for_));
    // Every octant with children was divided on the way down, by a criterion, or for the balance.
    std::uint64_t others = divided_to_start_;
    for (const std::uint64_t n : result.statistics.divided_by) others += n;
    result.statistics.divided_by_balance = (result.grid.octree.size() - 1) / 7 - others;
    resort_blocking(result.grid.octree);
    collect(result.grid);
    result.statistics.levels = count_cells(soup_, result.grid, options_.cells_per_side, progress_);
    return result;
  }

 private:
  void grow(GrowthStatistics& statistics) {
    Layer layer;
    layer.level = depth_;
    layer.octants = {0};
    layer.facets.resize(soup_.facets.size());
    std::iota(layer.facets.begin(), layer.facets.end(), 0u);
    layer.first.push_back(layer.facets.size());
    if (layer.facets.empty()) return;
    while (layer.size() > 0) {
      const std::vector<char> divided = octants_to_divide(layer, statistics);
      for (std::size_t i = 0; i < layer.size(); ++i)
        if (divided[i]) asked_for_.push_back(morton::key(layer.octants[i] << 3, layer.level - 1));
      Layer next = children(layer, divided);
      kept_[static_cast<std::size_t>(layer.level)].push_back(selected(layer, divided, 0));
      layer = std::move(next);
    }
  }

  std::vector<char> octants_to_divide(const Layer& layer, GrowthStatistics& statistics) {
    if (layer.level > options_.coarsest_level) {
      divided_to_start_ += layer.size();
      return std::vector<char>(layer.size(), 1);
    }
    std::vector<std::uint8_t> reason(layer.size(), kNothing);
    if (layer.level > 0) {
      parallel_ranges(layer.size(), kOctantGrain, [&](std::size_t begin, std::size_t end) {
        progress_.check();
        for (std::size_t i = begin; i < end; ++i) {
          const OctantFacets octant = view(layer, i);
          for (std::size_t c = 0; c < criteria_.size() && reason[i] == kNothing; ++c)
            if (criteria_[c]->divides(octant)) reason[i] = static_cast<std::uint8_t>(c);
        }
      });
    }
    std::vector<char> divided(layer.size(), 0);
    for (std::size_t i = 0; i < layer.size(); ++i) {
      if (reason[i] == kNothing) continue;
      divided[i] = 1;
      ++statistics.divided_by[reason[i]];
    }
    return divided;
  }

  OctantFacets view(const Layer& layer, std::size_t i) const {
    const double side = options_.cells_per_side * std::ldexp(1.0, layer.level);
    const morton::Position p = morton::deinterleave(layer.octants[i]);
    return {soup_,       layer.facets_of(i),      {p.x * side, p.y * side, p.z * side},
            layer.level, options_.cells_per_side, options_.band};
  }

  // Which of the octant's eight children have facet f in their lists. Lists of levels above the coarsest reach as far as the coarsest's
  // band: enough for all that comes of them.
  std::uint8_t children_met(std::uint64_t octant, int level, std::uint32_t f) const {
    const double cell = std::ldexp(1.0, level - 1), half = 0.5 * options_.cells_per_side * cell;
    const double band = options_.band * std::ldexp(1.0, std::min(level - 1, options_.coarsest_level));
    const Vec3 &a = soup_.corner(f, 0), &b = soup_.corner(f, 1), &c = soup_.corner(f, 2);
    const morton::Position p = morton::deinterleave(octant);
    const auto center = [&](std::uint32_t at, std::uint32_t s) { return (4.0 * at + 2.0 * s + 1) * half; };
    const auto of_children = [&](auto&& meets) {
      std::uint8_t met = 0;
      for (std::uint32_t child = 0; child < 8; ++child)
        if (meets(Vec3{center(p.x, child & 1), center(p.y, child >> 1 & 1), center(p.z, child >> 2)})) met = static_cast<std::uint8_t>(met | 1u << child);
      return met;
    };
    if (options_.cells_per_side == 1) return of_children([&](const Vec3& at) { return triangle_overlaps_cube(a, b, c, at, half + band); });
    // A block's nodes end half a cell before its cube on either side of their own centre.
    const double ends = level - 1 <= options_.coarsest_level ? 0.5 * cell : 0;
    const TriangleNearBox near(a, b, c, band + kRounding);
    return of_children([&](const Vec3& at) { return near(at - Vec3{1, 1, 1} * ends, half - ends); });
  }

  // For every facet in the list of an octant that is divided.
  std::vector<std::uint8_t> all_children_met(const Layer& layer, const std::vector<char>& divided) const {
    std::vector<std::uint8_t> met(layer.facets.size());
    parallel_ranges(layer.facets.size(), kFacetGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      std::size_t i = static_cast<std::size_t>(std::upper_bound(layer.first.begin(), layer.first.end(), begin) - layer.first.begin()) - 1;
      for (std::size_t at = begin; at < end; ++i) {
        const std::size_t stop = std::min<std::size_t>(end, layer.first[i + 1]);
        if (divided[i])
          for (std::size_t e = at; e < stop; ++e) met[e] = children_met(layer.octants[i], layer.level, layer.facets[e]);
        at = stop;
      }
    });
    return met;
  }

  // For octants that are about to be divided, and the lists of their children.
  void require_memory(std::size_t divisions, std::size_t listed) {
    divisions_ += divisions;
    listed_ += listed;
    if (divisions_ * kBytesPerDivision + listed_ * sizeof(std::uint32_t) <= options_.memory_bytes) return;
    const auto side = static_cast<std::uint64_t>(options_.cells_per_side);
    throw Error(ErrorCode::memory_limit,
                fmt::format("the octree would have more than {} cells, too many for the memory budget", 7 * (divisions_ - divisions) * side * side * side),
                "choose a larger --cell or limits that divide less, or raise --memory");
  }

  // The children of the octants that are divided, without those that no facet meets. [T-REF-2]
  Layer children(const Layer& layer, const std::vector<char>& divided) {
    const std::vector<std::uint8_t> met = all_children_met(layer, divided);
    std::vector<std::size_t> parents;
    for (std::size_t i = 0; i < layer.size(); ++i)
      if (divided[i]) parents.push_back(i);
    std::vector<std::uint64_t> first(8 * parents.size() + 1, 0);
    parallel_for(
        parents.size(),
        [&](std::size_t n) {
          for (std::size_t e = layer.first[parents[n]]; e < layer.first[parents[n] + 1]; ++e)
            for (std::size_t child = 0; child < 8; ++child) first[8 * n + child] += met[e] >> child & 1;
        },
        kOctantGrain);
    exclusive_scan_in_place(first);
    require_memory(parents.size(), first.back());
    Layer next;
    next.level = layer.level - 1;
    next.facets.resize(first.back());
    parallel_for(
        parents.size(),
        [&](std::size_t n) {
          std::array<std::uint64_t, 8> to;
          std::copy_n(first.begin() + static_cast<std::ptrdiff_t>(8 * n), 8, to.begin());
          for (std::size_t e = layer.first[parents[n]]; e < layer.first[parents[n] + 1]; ++e)
            for (std::size_t child = 0; child < 8; ++child)
              if (met[e] >> child & 1) next.facets[to[child]++] = layer.facets[e];
        },
        kOctantGrain);
    for (std::size_t n = 0; n < 8 * parents.size(); ++n) {
      if (first[n] == first[n + 1]) continue;
      next.octants.push_back(layer.octants[parents[n / 8]] << 3 | n % 8);
      next.first.push_back(first[n + 1]);
    }
    return next;
  }

  // Divides what is no leaf of the balanced octree.
  void resort_blocking(const Octree& tree) {
    for (std::size_t level = kept_.size(); level-- > 0;)
      for (Layer& layer : kept_[level]) {
        std::vector<char> divided(layer.size());
        parallel_for(layer.size(), [&](std::size_t i) { divided[i] = tree.find_key(layer.key(i)) == Octree::kNone; });
        if (std::find(divided.begin(), divided.end(), 1) == divided.end()) continue;
        kept_[level - 1].push_back(children(layer, divided));
        layer = selected(layer, divided, 0);
      }
  }

  // The lists of all layers, by leaf.
  void collect(SurfaceOctree& grid) {
    grid.first_facet.assign(grid.octree.size() + 1, 0);
    const auto for_each_list = [&](auto&& visit) {
      for (const std::vector<Layer>& layers : kept_)
        for (const Layer& layer : layers)
          parallel_for(layer.size(), [&](std::size_t i) { visit(grid.octree.find_key(layer.key(i)), layer.facets_of(i)); });
    };
    for_each_list([&](std::size_t leaf, auto list) { grid.first_facet[leaf] = list.size(); });
    grid.facets.resize(exclusive_scan_in_place(grid.first_facet));
    for_each_list([&](std::size_t leaf, auto list) {
      std::copy(list.begin(), list.end(), grid.facets.begin() + static_cast<std::ptrdiff_t>(grid.first_facet[leaf]));
    });
  }

  const TriangleSoup& soup_;
  const int depth_;
  const GrowthOptions options_;
  const std::span<const RefinementCriterion* const> criteria_;
  Progress& progress_;
  std::vector<std::uint64_t> asked_for_;  // keys of a child of each octant that is divided
  std::vector<std::vector<Layer>> kept_;  // octants that are not, by level
  std::uint64_t divided_to_start_ = 0;
  std::uint64_t divisions_ = 0, listed_ = 0;
};

std::uint64_t cells_cut_in(const OctantFacets& octant) {
  std::array<bool, detail::kMostCells> cut{};
  for (const std::uint32_t f : octant.facets)
    detail::for_cells_cut(octant, f, [&](std::size_t cell) {
      cut[cell] = true;
      return false;
    });
  return static_cast<std::uint64_t>(std::count(cut.begin(), cut.end(), true));
}

}  // namespace

std::uint64_t GrowthStatistics::cells() const {
  return std::accumulate(levels.begin(), levels.end(), std::uint64_t{0}, [](std::uint64_t n, const LevelCount& l) { return n + l.cells; });
}
std::uint64_t GrowthStatistics::cells_cut() const {
  return std::accumulate(levels.begin(), levels.end(), std::uint64_t{0}, [](std::uint64_t n, const LevelCount& l) { return n + l.cells_cut; });
}

std::vector<LevelCount> count_cells(const TriangleSoup& lattice_soup, const SurfaceOctree& grid, int cells_per_side, Progress& progress) {
  const Octree& tree = grid.octree;
  const auto n = static_cast<std::uint64_t>(cells_per_side);
  using Counts = std::vector<LevelCount>;
  const auto range = [&](std::size_t begin, std::size_t end) {
    progress.check();
    Counts counts(static_cast<std::size_t>(tree.depth()) + 1);
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      LevelCount& count = counts[static_cast<std::size_t>(tree.level(leaf))];
      ++count.leaves;
      count.cells += n * n * n;
      if (!grid.near_surface(leaf)) continue;
      ++count.near_surface;
      const morton::Position c = tree.corner(leaf);
      const Vec3 corner = Vec3{static_cast<double>(c.x), static_cast<double>(c.y), static_cast<double>(c.z)} * cells_per_side;
      count.cells_cut += cells_cut_in({lattice_soup, grid.facets_of(leaf), corner, tree.level(leaf), cells_per_side, 0});
    }
    return counts;
  };
  const auto sum = [](Counts a, const Counts& b) {
    for (std::size_t l = 0; l < b.size(); ++l) {
      a[l].leaves += b[l].leaves;
      a[l].near_surface += b[l].near_surface;
      a[l].cells += b[l].cells;
      a[l].cells_cut += b[l].cells_cut;
    }
    return a;
  };
  return parallel_reduce(tree.size(), 256, Counts(static_cast<std::size_t>(tree.depth()) + 1), range, sum);
}

AdaptiveGrowth grow_adaptive(const TriangleSoup& lattice_soup, int depth, const GrowthOptions& options,
                             std::span<const RefinementCriterion* const> criteria, Progress& progress) {
  GrowthOptions within = options;
  within.coarsest_level = std::min(options.coarsest_level, depth);
  return Growth(lattice_soup, depth, within, criteria, progress).run();
}

AdaptiveGrowth grow_cells_counted(const TriangleSoup& soup, const GridFrame& frame, const RefinementLimits& limits, Progress& progress) {
  const int depth = frame.depth + std::countr_zero(static_cast<unsigned>(kBlockSide));
  if (depth > morton::kMaxDepth)
    throw Error(ErrorCode::memory_limit, "an octree of single cells can have 1048576 cells a side; this one needs more", "choose a larger --cell");
  TriangleSoup lattice{soup.points, soup.facets, {}};
  parallel_for(lattice.points.size(), [&](std::size_t i) { lattice.points[i] = frame.to_lattice(lattice.points[i]); });
  const auto criteria = criteria_of(limits);
  std::vector<const RefinementCriterion*> asked;
  asked.reserve(criteria.size());
  for (const auto& criterion : criteria) asked.push_back(criterion.get());
  return grow_adaptive(lattice, depth, {1, limits.coarsest_level, limits.band}, asked, progress);
}

SurfaceOctree grow_cells(const TriangleSoup& soup, const GridFrame& frame, const RefinementLimits& limits, Progress& progress) {
  return grow_cells_counted(soup, frame, limits, progress).grid;
}

}  // namespace burnish
