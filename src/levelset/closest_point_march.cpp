#include "closest_point_march.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "burnish/core/large_array.h"
#include "burnish/core/parallel.h"
#include "closest_point_front.h"
#include "closest_point_kernel.h"

namespace burnish::detail {
namespace {

constexpr std::size_t kGrain = 4;
constexpr double kRebroadcast = 2;  // cells: refined nodes within this of the edge of what was refined start the next march
constexpr int kFirstPass = 2;       // a radius of one cell: seeds are there already

constexpr std::size_t kSeedSide = kBlockSide + 2 * kSeedHalo, kSeedNodes = kSeedSide * kSeedSide * kSeedSide;

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
    seed_all();
    if (options_.method == RedistanceMethod::closest) {
      const double refined = std::min(options_.reach, kRefineReach);
      march(refined);
      refine_all(refined);
    }
    march(options_.reach);
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
    for (int dir = 0; dir < kDirections; ++dir)
      if (dir != kSelf)
        for (const std::uint32_t other : tree_.neighbors(leaf, dir)) visit(dir, other);
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
      std::array<T, kSeedNodes> phi;
      for (std::size_t slot = begin; slot < end; ++slot) {
        points_[slot].bound.fill(kInfinite);
        open_[slot] = exact_[slot] = {};
        least_open_[slot] = kInfinite;
        if (!may_be_beside(leaves_[slot], side_of)) continue;
        gather_smooth(tree_, set_.phi, leaves_[slot], kSeedHalo, HaloOrder::cubic, phi.data());
        const Surroundings<T> around{phi.data(), kSeedHalo};
        const BlockBits beside = beside_surface(around);
        seed(around, beside, points_[slot], exact_[slot]);
        open(slot, beside);
      }
    });
  }

  // The nodes will be published once the radius has come to them.
  void open(std::size_t slot, const BlockBits& nodes) {
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if ((nodes[n / kBlockSide] >> (n % kBlockSide) & 1) != 0) least_open_[slot] = std::min(least_open_[slot], points_[slot].bound[n]);
    for (std::size_t row = 0; row < nodes.size(); ++row) open_[slot][row] |= nodes[row];
  }

  // Carries closest points outwards, in layers of half a cell of each leaf's level, up to `reach` of its cells. [T-REDIST-3]
  void march(double reach) {
    const T reach2 = static_cast<T>(reach * reach);
    for (int pass = kFirstPass; std::any_of(least_open_.begin(), least_open_.end(), [&](T b) { return b < kInfinite && b <= reach2; }); ++pass) {
      progress_.check();
      publish_layer(pass, reach);
      if (!published_slots_.empty()) spread_layer();
    }
  }

  // The radius of a pass in cells of a leaf, or 0 if it is none of its passes.
  static double radius_of(int pass, int level) { return pass % (1 << level) == 0 ? 0.5 * (pass >> level) : 0; }

  void publish_layer(int pass, double reach) {
    published_slots_.clear();
    for (std::uint32_t slot = 0; slot < leaves_.size(); ++slot) {
      const double radius = std::min(reach, radius_of(pass, tree_.level(leaves_[slot])));
      if (radius > 0 && least_open_[slot] <= static_cast<T>(radius * radius)) published_slots_.push_back(slot);
    }
    published_.resize(std::max(published_.size(), published_slots_.size()));
    published_of_.resize(leaves_.size(), kNone);
    parallel_for(
        published_slots_.size(),
        [&](std::size_t p) {
          const std::uint32_t slot = published_slots_[p];
          const double radius = std::min(reach, radius_of(pass, tree_.level(leaves_[slot])));
          published_of_[slot] = static_cast<std::uint32_t>(p);
          least_open_[slot] = publish(points_[slot], radius, open_[slot], published_[p]);
        },
        16);
  }

  void spread_layer() {
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
      FrontPoints<T> front{};
      for (std::size_t r = begin; r < end; ++r) {
        const std::uint32_t slot = readers[r];
        read_front(slot, front);
        least_open_[slot] = std::min(least_open_[slot], spread(front, points_[slot], open_[slot], exact_[slot]));
      }
    });
    for (const std::uint32_t slot : published_slots_) published_of_[slot] = kNone;
  }

  void read_front(std::uint32_t slot, FrontPoints<T>& front) const {
    front.clear();
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

  // The octants around a leaf, as bits, that are no more than one level finer: elsewhere the leaf's own lattice may be too coarse
  // for the surface.
  std::uint32_t octants_to_refine_in(std::uint32_t leaf) const {
    std::uint32_t octants = 1u << kSelf;
    for (int dir = 0; dir < kDirections; ++dir) {
      const NeighborKind kind = tree_.neighbor_kind(leaf, dir);
      if (kind == NeighborKind::same || kind == NeighborKind::coarser || (kind == NeighborKind::finer && is_one_finer(leaf, dir)))
        octants |= 1u << dir;
    }
    return octants;
  }

  bool is_one_finer(std::uint32_t leaf, int dir) const {
    const auto [dx, dy, dz] = offset_of(dir);
    const LatticeNode low = lattice_node(tree_, leaf, kBlockSide * dx, kBlockSide * dy, kBlockSide * dz);
    const std::uint32_t last = (1u << tree_.level(leaf)) - 1;
    const morton::Position first{static_cast<std::uint32_t>(low.x) / kBlockSide, static_cast<std::uint32_t>(low.y) / kBlockSide,
                                 static_cast<std::uint32_t>(low.z) / kBlockSide};
    return tree_.find({first.x + last, first.y + last, first.z + last}) - tree_.find(first) == 7;
  }

  bool wants_refinement(std::size_t slot, T limit) const {
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (points_[slot].bound[n] <= limit && (exact_[slot][n / kBlockSide] >> (n % kBlockSide) & 1) == 0) return true;
    return false;
  }

  void refine_all(double reach) {
    const int width = std::min(kWidestHalo, static_cast<int>(std::ceil(reach)) + 3), side = kBlockSide + 2 * width;
    const T limit = static_cast<T>(reach * reach);
    parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      LargeArray<T> phi(static_cast<std::size_t>(side * side * side));
      for (std::size_t slot = begin; slot < end; ++slot) {
        if (!wants_refinement(slot, limit)) continue;
        gather_smooth(tree_, set_.phi, leaves_[slot], width, HaloOrder::cubic, phi.data());
        refine(Surroundings<T>{phi.data(), width}, reach, octants_to_refine_in(leaves_[slot]), points_[slot], exact_[slot]);
        if (options_.reach > reach) open(slot, outermost(slot, reach));
      }
    });
  }

  // Nodes whose better points the next march is to carry on.
  BlockBits outermost(std::size_t slot, double reach) const {
    BlockBits nodes = exact_[slot];
    const T least = static_cast<T>((reach - kRebroadcast) * (reach - kRebroadcast));
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (points_[slot].bound[n] < least) nodes[n / kBlockSide] = static_cast<std::uint8_t>(nodes[n / kBlockSide] & ~(1u << (n % kBlockSide)));
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
            const double x = p.x[n], y = p.y[n], z = p.z[n];
            const double known = p.bound[n] < kInfinite ? cell * std::sqrt(x * x + y * y + z * z) : std::abs(static_cast<double>(phi[n]));
            phi[n] = with_sign_of(phi[n], std::min(known, options_.reach * cell));
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
  std::vector<BlockBits> open_, exact_;
  std::vector<T> least_open_;
  LargeArray<PublishedPoints<T>> published_;
  std::vector<std::uint32_t> published_slots_, published_of_;
  std::vector<char> reached_;
};

}  // namespace

template <class T>
void closest_point_redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress) {
  ClosestPointMarch<T>(level_set, options, progress).run();
}

template void closest_point_redistance(BasicLevelSet<float>&, const RedistanceOptions&, Progress&);
template void closest_point_redistance(BasicLevelSet<double>&, const RedistanceOptions&, Progress&);

}  // namespace burnish::detail
