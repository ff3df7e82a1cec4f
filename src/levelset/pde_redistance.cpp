#include "pde_redistance.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"
#include "pde_crossings.h"
#include "weno_kernel.h"

namespace burnish::detail {
namespace {

constexpr double kWenoCourant = 0.6, kFirstCourant = 0.5;  // [T-PDE-7]
constexpr int kMargin = 5;       // cells beyond the reach that are computed, so that no kink is seen within it
constexpr double kPatience = 2;  // steps allowed, in parts of those that information needs
constexpr int kSettling = 60;    // steps allowed besides
constexpr double kRough = 1e-2;  // the residual at which distances of first order are good enough for WENO5 to start from
constexpr double kShareOfStart = 0.1;  // of the time, about, that steps of first order take before those of WENO5
constexpr std::size_t kGrain = 8;
constexpr std::uint32_t kNone = 0xffffffffu;

// Copies halos in own units, as the kernels want them.
template <class T>
class Halos {
 public:
  explicit Halos(const Octree& tree) : tree_(tree) {}

  void fill_halo(const Field<T>& field, std::size_t leaf, int width, HaloBlock& halo) const {
    const double scale = 1.0 / (1 << tree_.level(leaf));
    std::array<std::array<T, kBlockNodes>, 6> injected;
    if (const auto blocks = faces(field, leaf, width, injected)) return fill(*blocks, scale, width, halo);
    std::array<T, std::size_t{HaloBlock::kSide} * HaloBlock::kSide * HaloBlock::kSide> dense;
    gather_smooth(tree_, field, leaf, width, HaloOrder::cubic, dense.data());
    copy(dense.data(), scale, width, halo);
    continue_where_nothing_is_stored(field, leaf, width, halo);
  }

 private:
  static constexpr std::array<int, 6> kFaces{direction(-1, 0, 0), direction(1, 0, 0),  direction(0, -1, 0),
                                             direction(0, 1, 0),  direction(0, 0, -1), direction(0, 0, 1)};

  // The blocks across the faces, if all that is there needs no interpolation: beside finer leaves one is made of their nodes.
  std::optional<BlockFaces<T>> faces(const Field<T>& field, std::size_t leaf, int width, std::array<std::array<T, kBlockNodes>, 6>& injected) const {
    BlockFaces<T> blocks{field.block(leaf), {}};
    for (std::size_t face = 0; face < 6; ++face) {
      const NeighborKind kind = tree_.neighbor_kind(leaf, kFaces[face]);
      if (kind == NeighborKind::wall) continue;
      if (kind == NeighborKind::finer) {
        inject(field, leaf, face, width, injected[face].data());
        blocks.across[face] = injected[face].data();
        continue;
      }
      const std::uint32_t other = tree_.neighbor(leaf, kFaces[face]);
      if (!field.stores(other)) continue;
      if (kind == NeighborKind::coarser) return std::nullopt;
      blocks.across[face] = field.block(other);
    }
    return blocks;
  }

  // Of four finer leaves every second node, in the first layers of the block that would be there. Width is less than half a block.
  void inject(const Field<T>& field, std::size_t leaf, std::size_t face, int width, T* out) const {
    const auto across = tree_.neighbors(leaf, kFaces[face]);
    const std::size_t axis = face / 2;
    for (int b = 0; b < kBlockSide; ++b)
      for (int a = 0; a < kBlockSide; ++a) {
        const std::uint32_t fine = across[static_cast<std::size_t>((a >= kBlockSide / 2) + 2 * (b >= kBlockSide / 2))];
        for (int n = 0; n < width; ++n) {
          const int layer = face % 2 == 0 ? kBlockSide - 1 - n : n;
          const T value = field.stores(fine) ? field.block(fine)[on_axis(axis, 2 * layer % kBlockSide, 2 * a % kBlockSide, 2 * b % kBlockSide)]
                                             : field.block(leaf)[on_axis(axis, face % 2 == 0 ? 0 : kBlockSide - 1, a, b)];
          out[on_axis(axis, layer, a, b)] = value;
        }
      }
  }

  // The node `along` an axis and (a, b) across it.
  static std::size_t on_axis(std::size_t axis, int along, int a, int b) {
    return axis == 0 ? node_index(along, a, b) : axis == 1 ? node_index(a, along, b) : node_index(a, b, along);
  }

  static void copy(const T* dense, double scale, int width, HaloBlock& halo) {
    const int side = kBlockSide + 2 * width;
    for (int k = -width; k < kBlockSide + width; ++k)
      for (int j = -width; j < kBlockSide + width; ++j) {
        const T* row = dense + side * ((j + width) + side * (k + width));
        for (int i = 0; i < side; ++i) halo.at(i - width, j, k) = scale * row[i];
      }
  }

  // Leaves that store nothing have no distances: phi goes on as it is at the node before them, like at a wall.
  void continue_where_nothing_is_stored(const Field<T>& field, std::size_t leaf, int width, HaloBlock& halo) const {
    for (std::size_t face = 0; face < 6; ++face) {
      const NeighborKind kind = tree_.neighbor_kind(leaf, kFaces[face]);
      if (kind == NeighborKind::wall) continue;
      const auto across = tree_.neighbors(leaf, kFaces[face]);
      if (std::all_of(across.begin(), across.end(), [&](std::uint32_t other) { return field.stores(other); })) continue;
      const std::size_t axis = face / 2;
      for (int b = 0; b < kBlockSide; ++b)
        for (int a = 0; a < kBlockSide; ++a) {
          const std::size_t part = across.size() == 1 ? 0 : static_cast<std::size_t>((a >= kBlockSide / 2) + 2 * (b >= kBlockSide / 2));
          if (field.stores(across[part])) continue;
          std::array<int, 3> node{};
          node[axis] = face % 2 == 0 ? 0 : kBlockSide - 1;
          node[axis == 0 ? 1 : 0] = a;
          node[axis == 2 ? 1 : 2] = b;
          double* last = &halo.at(node[0], node[1], node[2]);
          const int stride = HaloBlock::kStride[axis] * (face % 2 == 0 ? -1 : 1);
          for (int n = 1; n <= width; ++n) last[n * stride] = *last;
        }
    }
  }

  const Octree& tree_;
};

// Gives the two uniform blocks of a field other values while it lives.
template <class T>
class UniformValues {
 public:
  UniformValues(Field<T>& field, double size) : field_(field) {
    if (field.layout().empty()) return;
    for (std::size_t b = 0; b < kUniformBlocks; ++b) {
      T* block = field.values().data() + b * kBlockNodes;
      before_[b] = *block;
      std::fill_n(block, kBlockNodes, static_cast<T>(before_[b] < 0 ? -size : size));
    }
  }
  ~UniformValues() {
    if (field_.layout().empty()) return;
    for (std::size_t b = 0; b < kUniformBlocks; ++b) std::fill_n(field_.values().data() + b * kBlockNodes, kBlockNodes, before_[b]);
  }
  UniformValues(const UniformValues&) = delete;
  UniformValues& operator=(const UniformValues&) = delete;

 private:
  Field<T>& field_;
  std::array<T, kUniformBlocks> before_{};
};

template <class T>
class PdeRedistancer {
 public:
  PdeRedistancer(BasicLevelSet<T>& set, const RedistanceOptions& options, Progress& progress)
      : set_(set), options_(options), tree_(set.octree()), progress_(progress), halos_(tree_),
        first_order_(options.method == RedistanceMethod::pde_first), courant_(first_order_ ? kFirstCourant : kWenoCourant),
        counted_(options.reach) {
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf) {
      if (!set.phi.stores(leaf)) continue;
      leaves_.push_back(leaf);
      coarsest_ = std::max(coarsest_, tree_.level(leaf));
    }
    const double farthest = std::sqrt(3.0) * kBlockSide * tree_.side();
    limit_ = std::min(farthest, (options.reach + kMargin) * (1 << coarsest_));
  }

  RedistanceResult run() {
    if (leaves_.empty()) return {};
    const UniformValues<T> uniform(set_.phi, std::max(set_.band, 1.0) * (1 << coarsest_));
    find_surface();
    start();
    RedistanceResult result;
    if (first_order_ || options_.most_steps > 0) {
      advance(options_.most_steps > 0 ? options_.most_steps : steps_needed(), options_.steady, 0, result);
    } else {
      // From distances of first order, whatever phi was: the scheme of high order has no maximum principle. [T-PDE-10]
      use_first_order(true);
      advance(steps_needed(), kRough, 0, result);
      use_first_order(false);
      advance(steps_needed(), options_.steady, kShareOfStart, result);
    }
    finish();
    return result;
  }

 private:
  void use_first_order(bool first_order) {
    first_order_ = first_order;
    courant_ = first_order ? kFirstCourant : kWenoCourant;
    counted_ = first_order ? limit_ : options_.reach;
    for (const std::uint32_t leaf : leaves_) rest(leaf);
  }

  // `done`: the part of the work that lies behind.
  void advance(int most, double steady, double done, RedistanceResult& result) {
    const double enough = std::max(steady, rounding()), share = done > 0 || first_order_only() ? 1 - done : kShareOfStart;
    result.steady = false;
    for (int step = 0; step < most && !result.steady; ++step) {
      find_active();
      result.residual = first_order_ ? euler_step() : runge_kutta_step();
      result.steady = result.residual < enough;
      ++result.steps;
      progress_.update(done + share * (step + 1) / most);
    }
  }

  bool first_order_only() const { return options_.method == RedistanceMethod::pde_first || options_.most_steps > 0; }

  // Changes that rounding makes: a part of the last bit of the largest values.
  double rounding() const {
    return std::numeric_limits<T>::epsilon() / 8 * std::min(limit_, 0.5 * kBlockSide * static_cast<double>(tree_.side()));
  }

  double scale(std::size_t leaf) const { return 1 << tree_.level(leaf); }

  // Accepted nodes, cut nodes, held nodes: all that kernels have to leave alone.
  void find_surface() {
    crossings_.resize(leaves_.size());
    parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      HaloBlock halo;
      for (std::size_t slot = begin; slot < end; ++slot) {
        if (options_.accepted != nullptr) {
          mark_accepted(leaves_[slot], crossings_[slot]);
        } else {
          halos_.fill_halo(set_.phi, leaves_[slot], kWenoWidth, halo);
          find_crossings(halo, crossings_[slot]);
        }
      }
    });
  }

  void mark_accepted(std::size_t leaf, BlockCrossings& crossings) const {
    const std::uint8_t* accepted = options_.accepted->block(leaf);
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (accepted[n] != 0) add(crossings.still, n), crossings.any = true;
  }

  // Clamps phi, sets held nodes, and makes the fields of the stages.
  void start() {
    least_.resize(leaves_.size());
    slot_.assign(tree_.size(), kNone);
    parallel_for(
        leaves_.size(),
        [&](std::size_t slot) {
          const std::uint32_t leaf = leaves_[slot];
          slot_[leaf] = static_cast<std::uint32_t>(slot);
          T* phi = set_.phi.block(leaf);
          clamp_unaccepted(leaf, limit_);
          for (const HeldNode& held : crossings_[slot].held)
            phi[held.node] = static_cast<T>(std::copysign(held.distance * scale(leaf), static_cast<double>(phi[held.node])));
          double least = limit_;
          for (std::size_t n = 0; n < kBlockNodes; ++n) least = std::min(least, std::abs(static_cast<double>(phi[n])));
          least_[slot] = least / scale(leaf);
        },
        64);
    first_ = set_.phi;
    if (options_.method == RedistanceMethod::pde_weno5) second_ = set_.phi;
    was_active_.assign(leaves_.size(), 0);
  }

  void clamp_unaccepted(std::uint32_t leaf, double size) {
    T* phi = set_.phi.block(leaf);
    const std::uint8_t* accepted = options_.accepted == nullptr ? nullptr : options_.accepted->block(leaf);
    for (std::size_t n = 0; n < kBlockNodes; ++n)
      if (accepted == nullptr || accepted[n] == 0) phi[n] = static_cast<T>(std::clamp<double>(phi[n], -size, size));
  }

  // Leaves in which something can change: they, or leaves that touch them, have nodes below the limit. Others rest, the same in all fields.
  void find_active() {
    active_.clear();
    for (std::uint32_t slot = 0; slot < leaves_.size(); ++slot) {
      const bool active = is_active(slot);
      if (active)
        active_.push_back(slot);
      else if (was_active_[slot] != 0)
        rest(leaves_[slot]);
      was_active_[slot] = active;
    }
  }

  bool is_below_limit(std::uint32_t slot) const { return least_[slot] * scale(leaves_[slot]) < limit_ * (1 - 1e-6); }

  bool is_active(std::uint32_t slot) const {
    if (is_below_limit(slot)) return true;
    for (int dir = 0; dir < kDirections; ++dir) {
      if (dir == kSelf) continue;
      for (const std::uint32_t other : tree_.neighbors(leaves_[slot], dir))
        if (slot_[other] != kNone && is_below_limit(slot_[other])) return true;
    }
    return false;
  }

  void rest(std::uint32_t leaf) {
    std::copy_n(std::as_const(set_.phi).block(leaf), kBlockNodes, first_.block(leaf));
    if (!second_.empty()) std::copy_n(std::as_const(set_.phi).block(leaf), kBlockNodes, second_.block(leaf));
  }

  // One stage over all active leaves: `from` is read with halos; `out` is written. Returns the sum of squared rates.
  double stage(const Field<T>& from, Field<T>& out, double keep) {
    return parallel_reduce(
        active_.size(), kGrain, 0.0,
        [&](std::size_t begin, std::size_t end) {
          progress_.check();
          HaloBlock halo;
          double sum = 0;
          for (std::size_t a = begin; a < end; ++a) sum += stage_of_leaf(active_[a], from, out, keep, halo);
          return sum;
        },
        [](double a, double b) { return a + b; });
  }

  double stage_of_leaf(std::uint32_t slot, const Field<T>& from, Field<T>& out, double keep, HaloBlock& halo) {
    const std::uint32_t leaf = leaves_[slot];
    const BlockCrossings& c = crossings_[slot];
    halos_.fill_halo(from, leaf, first_order_ ? 1 : kWenoWidth, halo);
    const Stage<T> stage{keep, courant_, limit_ / scale(leaf), counted_, scale(leaf), c.any ? c.still.data() : nullptr, c.cut.data(), c.cut.size(),
                         std::as_const(set_.phi).block(leaf), out.block(leaf)};
    const StageSums sums = first_order_ ? first_order_stage(halo, stage) : weno5_stage(halo, stage);
    least_[slot] = sums.least;
    return sums.squared_rate;
  }

  double rms(double sum) const { return std::sqrt(sum / std::max<double>(1, static_cast<double>(active_.size() * kBlockNodes))); }

  double euler_step() {
    const double sum = stage(set_.phi, first_, 0);
    std::swap(set_.phi, first_);
    return rms(sum);
  }

  // Shu and Osher's, of third order. [T-PDE-8]
  double runge_kutta_step() {
    stage(set_.phi, first_, 0);
    stage(first_, second_, 0.75);
    return rms(stage(second_, set_.phi, 1.0 / 3));
  }

  // What information needs to come from the surface to the reach, or to all leaves. [T-PDE-9]
  int steps_needed() const {
    const double cells = std::min(limit_, waves() * kBlockSide * std::sqrt(3.0));
    return static_cast<int>(std::ceil(kPatience * cells / courant_)) + kSettling;
  }

  // How many leaves lie behind each other from the surface to the farthest one.
  int waves() const {
    std::vector<std::uint32_t> front, next;
    std::vector<char> seen(leaves_.size());
    for (std::uint32_t slot = 0; slot < leaves_.size(); ++slot)
      if (crossings_[slot].any) seen[slot] = 1, front.push_back(slot);
    int count = 1;
    for (; !front.empty(); ++count, front.swap(next)) {
      next.clear();
      for (const std::uint32_t slot : front)
        for (int dir = 0; dir < kDirections; ++dir) {
          if (dir == kSelf) continue;
          for (const std::uint32_t other : tree_.neighbors(leaves_[slot], dir))
            if (slot_[other] != kNone && seen[slot_[other]] == 0) seen[slot_[other]] = 1, next.push_back(slot_[other]);
        }
    }
    return count;
  }

  void finish() {
    parallel_for(leaves_.size(), [&](std::size_t slot) { clamp_unaccepted(leaves_[slot], options_.reach * scale(leaves_[slot])); }, 64);
  }

  BasicLevelSet<T>& set_;
  const RedistanceOptions& options_;
  const Octree& tree_;
  Progress& progress_;
  const Halos<T> halos_;
  bool first_order_;
  double courant_;
  double counted_;                          // cells within which rates are to become small
  int coarsest_ = 0;
  double limit_ = 0;                        // in finest cells
  std::vector<std::uint32_t> leaves_;       // that store values
  std::vector<std::uint32_t> slot_;         // leaf -> place among them
  std::vector<BlockCrossings> crossings_;   // of these leaves
  std::vector<double> least_;               // |phi| in each of them, in own units
  std::vector<char> was_active_;
  std::vector<std::uint32_t> active_;
  Field<T> first_, second_;                 // after the first and the second stage
};

}  // namespace

template <class T>
RedistanceResult pde_redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress) {
  return PdeRedistancer<T>(level_set, options, progress).run();
}

template RedistanceResult pde_redistance(BasicLevelSet<float>&, const RedistanceOptions&, Progress&);
template RedistanceResult pde_redistance(BasicLevelSet<double>&, const RedistanceOptions&, Progress&);

}  // namespace burnish::detail
