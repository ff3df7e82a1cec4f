#include "closest_point_march.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "burnish/core/large_array.h"
#include "burnish/core/parallel.h"
#include "closest_point_front.h"
#include "closest_point_kernel.h"

namespace burnish::detail {
namespace {

constexpr std::size_t kGrain = 4;
constexpr std::size_t kDistantGrain = 128;  // leaves whose nodes share what is gathered around their feet
constexpr double kRebroadcast = 2;  // cells: refined nodes within this of the edge of what was refined start the next march
constexpr double kUnsettled = 1;    // cells behind the front within which nodes may still take another point: coarser leaves lag by that
constexpr int kFirstPass = 2;       // a radius of one cell: seeds are there already
constexpr int kNearPasses = 12;     // layers of half a cell up to six cells, where paths bend; then of 7/8

constexpr std::size_t kSeedSide = kBlockSide + 2 * kSeedHalo, kSeedNodes = kSeedSide * kSeedSide * kSeedSide;

// The front's radius in a pass, in finest cells. [T-REDIST-3]
double front_radius(int pass) { return pass <= kNearPasses ? 0.5 * pass : 0.5 * kNearPasses + 0.875 * (pass - kNearPasses); }

// Which signs the nodes of a leaf have.
enum class Side : std::uint8_t { inside = 1, outside = 2, both = 3 };

template <class T>
class ClosestPointMarch {
 public:
  ClosestPointMarch(BasicLevelSet<T>& set, const RedistanceOptions& options, Progress& progress)
      : set_(set), tree_(set.octree()), options_(options), progress_(progress), slot_(tree_.size(), kNone) {
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf)
      if (set.phi.stores(leaf)) {
        slot_[leaf] = static_cast<std::uint32_t>(leaves_.size());
        leaves_.push_back(leaf);
      }
    points_.resize(leaves_.size());
    open_.resize(leaves_.size());
    exact_.resize(leaves_.size());
    least_open_.resize(leaves_.size());
  }

  void run() {
    find_leaves_beside_coarser();
    seed_all();
    if (options_.method == RedistanceMethod::closest) {
      const double refined = std::min(options_.reach, kRefineReach);
      march(refined);
      refine_all(refined);
    }
    march(options_.reach);
    refine_distant_nodes();
    store();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;
  static constexpr T kInfinite = std::numeric_limits<T>::infinity();

  std::vector<Side> sides() const {
    std::vector<Side> result(tree_.size());
    parallel_for(
        tree_.size(),
        [&](std::size_t leaf) {
          const T* phi = set_.phi.block(leaf);
          const auto outside = static_cast<std::size_t>(std::count_if(phi, phi + kBlockNodes, [](T v) { return v < 0; }));
          result[leaf] = outside == 0 ? Side::inside : outside == kBlockNodes ? Side::outside : Side::both;
        },
        64);
    return result;
  }

  template <class Visit>
  void for_each_neighbor(std::uint32_t leaf, Visit&& visit) const {
    for (int dir = 0; dir < kDirections; ++dir) {
      const NeighborKind kind = tree_.neighbor_kind(leaf, dir);
      if (dir == kSelf || kind == NeighborKind::wall) continue;
      if (kind != NeighborKind::finer)
        visit(dir, tree_.neighbor(leaf, dir));
      else
        for (const std::uint32_t other : tree_.neighbors(leaf, dir)) visit(dir, other);
    }
  }

  // Whether the leaf and those around it have nodes on both sides.
  bool may_be_beside(std::uint32_t leaf, const std::vector<Side>& sides) const {
    auto seen = static_cast<unsigned>(sides[leaf]);
    if (seen != 3) for_each_neighbor(leaf, [&](int, std::uint32_t other) { seen |= static_cast<unsigned>(sides[other]); });
    return seen == 3;
  }

  void seed_all() {
    const std::vector<Side> side_of = sides();
    parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      std::array<T, kSeedNodes + kPadding> phi{};
      for (std::size_t slot = begin; slot < end; ++slot) {
        points_[slot].bound.fill(kInfinite);
        open_[slot] = exact_[slot] = {};
        least_open_[slot] = kInfinite;
        const bool is_beside = may_be_beside(leaves_[slot], side_of), has_accepted = accepts_some(leaves_[slot]);
        if (!is_beside && !has_accepted) continue;
        gather_smooth(tree_, set_.phi, leaves_[slot], kSeedHalo, HaloOrder::quintic, phi.data());
        const Surroundings<T> around{phi.data(), kSeedHalo};
        NodeBits seeds{};
        if (is_beside) seeds = beside_surface(around);
        seed(around, seeds, points_[slot], exact_[slot]);
        if (has_accepted) seed_accepted(phi.data(), slot, seeds);
        open(slot, seeds);
      }
    });
  }

  bool accepts_some(std::uint32_t leaf) const {
    if (options_.accepted == nullptr) return false;
    const std::uint8_t* accepted = options_.accepted->block(leaf);
    return std::any_of(accepted, accepted + kBlockNodes, [](std::uint8_t a) { return a != 0; });
  }

  // Accepted values stand for a surface also where no sign changes, as at sheets that fit between nodes: their closest points are as far
  // away as they say, down their slope. [T-REDIST-6]
  void seed_accepted(const T* phi, std::size_t slot, NodeBits& seeds) {
    const std::uint8_t* accepted = options_.accepted->block(leaves_[slot]);
    const double cell = 1 << tree_.level(leaves_[slot]);
    for (std::size_t n = 0; n < kBlockNodes; ++n) {
      if (accepted[n] == 0 || has(seeds, n)) continue;
      const std::size_t i = n % 8, j = n / 8 % 8, k = n / 64;
      const Vec3 down = down_slope(phi + (i + kSeedHalo) + kSeedSide * ((j + kSeedHalo) + kSeedSide * (k + kSeedHalo)));
      const double slope = norm(down);
      if (!(slope > 0)) continue;
      put(points_[slot], n, down * (std::abs(static_cast<double>(phi_of(slot)[n])) / (cell * slope)), false);
      add(seeds, n);
    }
  }

  const T* phi_of(std::size_t slot) const { return std::as_const(set_.phi).block(leaves_[slot]); }

  // Where |phi| falls, by one-sided differences: along each axis towards the smaller neighbour, of second order where it falls on.
  static Vec3 down_slope(const T* center) {
    constexpr std::array<std::ptrdiff_t, 3> kStride{1, kSeedSide, kSeedSide * kSeedSide};
    Vec3 down;
    for (int axis = 0; axis < 3; ++axis) {
      std::ptrdiff_t stride = kStride[static_cast<std::size_t>(axis)];
      if (std::abs(center[-stride]) < std::abs(center[stride])) stride = -stride;
      const double here = std::abs(center[0]), next = std::abs(center[stride]), second = std::abs(center[2 * stride]);
      if (!(next < here)) continue;
      const double fall = second < next ? 0.5 * (3 * here - 4 * next + second) : here - next;
      down[axis] = stride > 0 ? fall : -fall;
    }
    return down;
  }

  // The nodes will be published once the radius has come to them.
  void open(std::size_t slot, const NodeBits& nodes) {
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (has(nodes, n)) least_open_[slot] = std::min(least_open_[slot], points_[slot].bound[n]);
    for (std::size_t row = 0; row < nodes.size(); ++row) open_[slot][row] |= nodes[row];
  }

  // Coarser leaves reach farther, in finest cells: leaves beside them, and beside such ones, carry points on as far as those need.
  void find_leaves_beside_coarser() {
    beside_coarser_.assign(leaves_.size(), 0);
    const auto mark = [&](char ring, auto&& counts) {
      for (std::size_t slot = 0; slot < leaves_.size(); ++slot)
        for_each_neighbor(leaves_[slot], [&](int, std::uint32_t other) {
          if (beside_coarser_[slot] == 0 && slot_[other] != kNone && counts(leaves_[slot], other)) beside_coarser_[slot] = ring;
        });
    };
    mark(1, [&](std::uint32_t leaf, std::uint32_t other) { return tree_.level(other) > tree_.level(leaf); });
    mark(2, [&](std::uint32_t, std::uint32_t other) { return beside_coarser_[slot_[other]] == 1; });
  }

  // How far a leaf carries points, in its cells, when results are wanted up to `reach`.
  double reach_of(std::size_t slot, double reach) const { return beside_coarser_[slot] != 0 ? 2 * reach : reach; }

  // Carries closest points outwards, in layers of a part of a cell of each leaf's level, up to `reach` of its cells. [T-REDIST-3]
  void march(double reach) {
    for (int pass = kFirstPass; is_open(reach); ++pass) {
      progress_.check();
      publish_layer(pass, reach);
      if (!published_slots_.empty()) spread_layer(pass);
    }
  }

  bool is_open(double reach) const {
    for (std::size_t slot = 0; slot < leaves_.size(); ++slot)
      if (is_within(slot, reach_of(slot, reach))) return true;
    return false;
  }

  // Whether some open node of the leaf is.
  bool is_within(std::size_t slot, double radius) const {
    return least_open_[slot] < kInfinite && least_open_[slot] <= static_cast<T>(radius * radius);
  }

  // The radius up to which a leaf publishes in a pass, in its cells, or 0 if that is none of its passes.
  double radius_of(int pass, std::size_t slot, double reach) const {
    const int level = tree_.level(leaves_[slot]);
    return pass % (1 << level) == 0 ? std::min(front_radius(pass) / (1 << level), reach_of(slot, reach)) : 0;
  }

  void publish_layer(int pass, double reach) {
    published_slots_.clear();
    for (std::uint32_t slot = 0; slot < leaves_.size(); ++slot)
      if (is_within(slot, radius_of(pass, slot, reach))) published_slots_.push_back(slot);
    published_.resize(std::max(published_.size(), published_slots_.size()));
    published_of_.resize(leaves_.size(), kNone);
    parallel_for(
        published_slots_.size(),
        [&](std::size_t p) {
          const std::uint32_t slot = published_slots_[p];
          published_of_[slot] = static_cast<std::uint32_t>(p);
          least_open_[slot] = publish(points_[slot], radius_of(pass, slot, reach), open_[slot], published_[p]);
        },
        16);
  }

  void spread_layer(int pass) {
    reached_.resize(leaves_.size());
    const auto reach = [&](std::uint32_t leaf) {
      if (slot_[leaf] != kNone) reached_[slot_[leaf]] = 1;
    };
    for (const std::uint32_t slot : published_slots_) {
      reach(leaves_[slot]);
      for_each_neighbor(leaves_[slot], [&](int, std::uint32_t other) { reach(other); });
    }
    std::vector<std::uint32_t> readers;
    for (std::uint32_t slot = 0; slot < leaves_.size(); ++slot)
      if (reached_[slot] != 0) readers.push_back(slot), reached_[slot] = 0;
    parallel_ranges(readers.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      FrontPoints<T> front;
      for (std::size_t r = begin; r < end; ++r) {
        const std::uint32_t slot = readers[r];
        read_front(slot, front);
        if (front.empty()) continue;
        const double settled = std::max(0.0, front_radius(pass) / (1 << tree_.level(leaves_[slot])) - kUnsettled);
        least_open_[slot] = std::min(least_open_[slot], spread(front, settled, points_[slot], open_[slot], exact_[slot]));
        front.clear();
      }
    });
    for (const std::uint32_t slot : published_slots_) published_of_[slot] = kNone;
  }

  void read_front(std::uint32_t slot, FrontPoints<T>& front) const {
    const std::uint32_t leaf = leaves_[slot];
    FrontReader<T> reader(tree_, leaf, front);
    if (published_of_[slot] != kNone) reader.read_same(kSelf, published_[published_of_[slot]]);
    for_each_neighbor(leaf, [&](int dir, std::uint32_t other) {
      const std::uint32_t p = slot_[other] == kNone ? kNone : published_of_[slot_[other]];
      if (p == kNone) return;
      switch (tree_.neighbor_kind(leaf, dir)) {
        case NeighborKind::same: return reader.read_same(dir, published_[p]);
        case NeighborKind::coarser: return reader.read_coarser(dir, other, published_[p]);
        case NeighborKind::finer: return reader.read_finer(dir, other, published_[p]);
        case NeighborKind::wall: return;
      }
    });
  }

  // The octants around a leaf, as bits, that are not finer: its own lattice holds what is known of the surface there.
  std::uint32_t octants_to_refine_in(std::uint32_t leaf) const {
    std::uint32_t octants = 1u << kSelf;
    for (int dir = 0; dir < kDirections; ++dir) {
      const NeighborKind kind = tree_.neighbor_kind(leaf, dir);
      if (kind == NeighborKind::same || kind == NeighborKind::coarser) octants |= 1u << dir;
    }
    return octants;
  }

  // Nodes of one leaf, one behind the other but for such as need nothing, whose closest points one leaf holds.
  struct DistantFeet {
    std::uint32_t holder, slot;
    std::vector<std::uint16_t> nodes;
  };

  // Of the leaves from one to another, holder by holder.
  std::vector<DistantFeet> distant_feet(std::size_t begin, std::size_t end) const {
    const bool everywhere = options_.method == RedistanceMethod::fmm || options_.reach > kRefineReach;
    const T limit = static_cast<T>((options_.reach + 0.25) * (options_.reach + 0.25));
    std::vector<DistantFeet> feet;
    for (std::uint32_t slot = static_cast<std::uint32_t>(begin); slot < end; ++slot) {
      std::uint32_t holder = leaves_[slot];
      for (std::uint32_t n = 0; n < kBlockNodes; ++n) {
        if (!wants_refinement(slot, n, limit)) continue;
        holder = leaf_at(foot_of(slot, n), holder);
        if (slot_[holder] == kNone || (!everywhere && tree_.level(holder) == tree_.level(leaves_[slot]))) continue;
        if (feet.empty() || feet.back().holder != holder || feet.back().slot != slot) feet.push_back({holder, slot, {}});
        feet.back().nodes.push_back(static_cast<std::uint16_t>(n));
      }
    }
    std::stable_sort(feet.begin(), feet.end(), [](const DistantFeet& a, const DistantFeet& b) { return a.holder < b.holder; });
    return feet;
  }

  // Refines nodes on the lattice that holds their closest points: all that `refine_all` left. Points carried from node to node are as far
  // apart as those nodes, and coarse ones are far apart. [T-REDIST-4]
  void refine_distant_nodes() {
    parallel_ranges(leaves_.size(), kDistantGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      constexpr std::size_t side = kBlockSide + 2 * kWidestHalo;
      LargeArray<T> phi(side * side * side + kPadding, 0);
      std::uint32_t gathered = kNone;
      for (const DistantFeet& feet : distant_feet(begin, end)) {
        if (feet.holder != gathered) gather_smooth(tree_, set_.phi, feet.holder, kWidestHalo, HaloOrder::quintic, phi.data());
        gathered = feet.holder;
        for (const std::uint32_t n : feet.nodes) refine_distant(Surroundings<T>{phi.data(), kWidestHalo}, feet.holder, feet.slot, n);
      }
    });
  }

  void refine_distant(const Surroundings<T>& around, std::uint32_t holder, std::uint32_t slot, std::uint32_t n) {
    const std::uint32_t leaf = leaves_[slot];
    const double cell = 1 << tree_.level(holder), ratio = (1 << tree_.level(leaf)) / cell;
    DistantNode node{(position(leaf, n) - position(holder, 0)) / cell, offset(slot, n) * ratio, set_.phi.block(leaf)[n] >= 0 ? 1. : -1.};
    refine(around, node);
    if (node.refined) put(points_[slot], n, node.offset / ratio, true);
  }

  Vec3 position(std::uint32_t leaf, std::uint32_t n) const {
    const LatticeNode at = lattice_node(tree_, leaf, static_cast<int>(n % 8), static_cast<int>(n / 8 % 8), static_cast<int>(n / 64));
    return {static_cast<double>(at.x), static_cast<double>(at.y), static_cast<double>(at.z)};
  }
  Vec3 offset(std::size_t slot, std::uint32_t n) const { return {points_[slot].x[n], points_[slot].y[n], points_[slot].z[n]}; }
  Vec3 foot_of(std::size_t slot, std::uint32_t n) const {
    return position(leaves_[slot], n) + offset(slot, n) * (1 << tree_.level(leaves_[slot]));
  }

  // The leaf that holds a point, which may lie a little beyond a wall.
  std::uint32_t leaf_at(const Vec3& p, std::uint32_t near) const {
    const auto block = [&](double x) {
      return static_cast<std::uint32_t>(std::clamp(x / kBlockSide, 0.0, static_cast<double>(tree_.side() - 1)));
    };
    return tree_.find_near(near, {block(p.x), block(p.y), block(p.z)});
  }

  bool wants_refinement(std::size_t slot, std::size_t n, T limit) const {
    return points_[slot].bound[n] < kInfinite && points_[slot].bound[n] <= limit && !has(exact_[slot], n);
  }
  bool wants_refinement(std::size_t slot, T limit) const {
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (wants_refinement(slot, n, limit)) return true;
    return false;
  }

  void refine_all(double reach) {
    const int width = std::min(kWidestHalo, static_cast<int>(std::ceil(reach)) + 3), side = kBlockSide + 2 * width;
    const T limit = static_cast<T>(reach * reach);
    parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      LargeArray<T> phi(static_cast<std::size_t>(side * side * side) + kPadding, 0);
      for (std::size_t slot = begin; slot < end; ++slot) {
        if (!wants_refinement(slot, limit)) continue;
        gather_smooth(tree_, set_.phi, leaves_[slot], width, HaloOrder::quintic, phi.data());
        refine(Surroundings<T>{phi.data(), width}, reach, octants_to_refine_in(leaves_[slot]), points_[slot], exact_[slot]);
        if (options_.reach > reach) open(slot, outermost(slot, reach));
      }
    });
  }

  // Nodes whose better points the next march is to carry on.
  NodeBits outermost(std::size_t slot, double reach) const {
    NodeBits nodes = exact_[slot];
    const T least = static_cast<T>((reach - kRebroadcast) * (reach - kRebroadcast));
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (points_[slot].bound[n] < least) remove(nodes, n);
    return nodes;
  }

  void store() {
    parallel_for(
        leaves_.size(),
        [&](std::size_t slot) {
          const std::uint8_t* accepted = options_.accepted == nullptr ? nullptr : options_.accepted->block(leaves_[slot]);
          T* phi = set_.phi.block(leaves_[slot]);
          const double cell = 1 << tree_.level(leaves_[slot]);
          const ClosestPoints<T>& p = points_[slot];
          for (std::size_t n = 0; n < kBlockNodes; ++n) {
            if (accepted != nullptr && accepted[n] != 0) continue;
            double d = std::isinf(options_.reach) ? std::abs(static_cast<double>(phi[n])) : options_.reach * cell;
            if (p.bound[n] < kInfinite) d = std::min(options_.reach * cell, cell * norm(offset(slot, static_cast<std::uint32_t>(n))));
            phi[n] = with_sign_of(phi[n], d);
          }
        },
        64);
  }

  // Outside stays outside on the surface too.
  static T with_sign_of(T before, double distance) {
    const auto d = static_cast<T>(distance);
    return before >= 0 ? d : -std::max(d, std::numeric_limits<T>::min());
  }

  BasicLevelSet<T>& set_;
  const Octree& tree_;
  const RedistanceOptions& options_;
  Progress& progress_;
  std::vector<std::uint32_t> leaves_;  // those that store values
  std::vector<std::uint32_t> slot_;    // leaf -> place among them
  LargeArray<ClosestPoints<T>> points_;
  std::vector<NodeBits> open_, exact_;
  std::vector<T> least_open_;
  LargeArray<PublishedPoints<T>> published_;
  std::vector<std::uint32_t> published_slots_, published_of_;
  std::vector<char> reached_, beside_coarser_;
};

}  // namespace

template <class T>
void closest_point_redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress) {
  ClosestPointMarch<T>(level_set, options, progress).run();
}

template void closest_point_redistance(BasicLevelSet<float>&, const RedistanceOptions&, Progress&);
template void closest_point_redistance(BasicLevelSet<double>&, const RedistanceOptions&, Progress&);

}  // namespace burnish::detail
