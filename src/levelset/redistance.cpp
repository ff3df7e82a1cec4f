#include "burnish/levelset/redistance.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <vector>

#include "burnish/core/parallel.h"
#include "pde_redistance.h"
#include "tricubic.h"

namespace burnish {
namespace {

constexpr int kWidth = 3;
constexpr int kSide = kBlockSide + 2 * kWidth;
constexpr std::size_t kDense = std::size_t{kSide} * kSide * kSide;
constexpr int kNewtonSteps = 12;
constexpr double kConverged = 1e-6;  // cells
constexpr double kReach = 1.9;       // cells from a node to its closest point; the tricubic stencil allows two
constexpr double kNewtonZone = 1.7;  // cells: nodes that seem to be this near are projected themselves
constexpr double kRadiusStep = 0.5;  // cells: less than the step to some neighbour that is closer to the surface
constexpr float kUnknown = std::numeric_limits<float>::infinity();
constexpr std::size_t kGrain = 8;

std::size_t dense_index(int i, int j, int k) {
  return static_cast<std::size_t>((i + kWidth) + kSide * ((j + kWidth) + kSide * (k + kWidth)));
}

// From a node to its closest point on the surface.
struct Offset {
  float x = kUnknown, y = 0, z = 0;
  bool known() const { return x != kUnknown; }
};

double squared_length(double x, double y, double z) { return x * x + y * y + z * z; }

// Whether a cell around node (i, j, k) has corners on both sides.
bool touches_cut_cell(const double* phi, int i, int j, int k) {
  const bool in = phi[dense_index(i, j, k)] >= 0;
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        if ((phi[dense_index(i + dx, j + dy, k + dz)] >= 0) != in) return true;
  return false;
}

// The closest crossing of the lattice edges within one node of (i, j, k), by linear interpolation.
Offset closest_edge_crossing(const double* phi, int i, int j, int k) {
  Offset best;
  double least = std::numeric_limits<double>::infinity();
  for (int dz = -1; dz <= 1; ++dz)
    for (int dy = -1; dy <= 1; ++dy)
      for (int dx = -1; dx <= 1; ++dx)
        for (int axis = 0; axis < 3; ++axis) {
          const std::array<int, 3> step{axis == 0, axis == 1, axis == 2};
          const double p = phi[dense_index(i + dx, j + dy, k + dz)];
          const double q = phi[dense_index(i + dx + step[0], j + dy + step[1], k + dz + step[2])];
          if ((p >= 0) == (q >= 0)) continue;
          const double t = p / (p - q);
          const double x = dx + t * step[0], y = dy + t * step[1], z = dz + t * step[2];
          if (squared_length(x, y, z) >= least) continue;
          least = squared_length(x, y, z);
          best = {static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)};
        }
  return best;
}

// Newton's method for the closest point; unknown if it leaves the reach or does not settle. [T-REDIST-1]
Offset newton_closest_point(const double* phi, int i, int j, int k) {
  const Vec3 x{static_cast<double>(i + kWidth), static_cast<double>(j + kWidth), static_cast<double>(k + kWidth)};
  Vec3 y = x;
  for (int step = 0; step < kNewtonSteps; ++step) {
    const auto [value, g] = detail::tricubic<kSide>(phi, y);
    const double g2 = squared_norm(g);
    if (!(g2 > 1e-4)) return {};
    const Vec3 along = x - y;
    Vec3 move = g * (-value / g2) + along - g * (dot(along, g) / g2);
    const double length = norm(move);
    if (length > 1) move *= 1 / length;
    y += move;
    if (squared_norm(y - x) > kReach * kReach) return {};
    if (length < kConverged) {
      const Vec3 d = y - x;
      return {static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)};
    }
  }
  return {};
}

template <class T>
class Redistancer {
 public:
  Redistancer(BasicLevelSet<T>& set, double reach, Progress& progress)
      : set_(set), tree_(set.octree()), reach_(std::min(reach, set.band)), progress_(progress) {
    slot_.assign(tree_.size(), kNone);
    for (std::uint32_t leaf = 0; leaf < tree_.size(); ++leaf)
      if (tree_.level(leaf) == 0 && set.phi.stores(leaf)) {
        slot_[leaf] = static_cast<std::uint32_t>(leaves_.size());
        leaves_.push_back(leaf);
      }
    offsets_.resize(leaves_.size() * kBlockNodes);
  }

  void run() {
    project_near_nodes();
    // A node settles once the radius has come to it: by then the nodes between it and the surface have.
    for (double radius = 1; radius <= reach_ + kRadiusStep; radius += kRadiusStep) propagate(radius);
    store();
  }

 private:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  void project_near_nodes() {
    parallel_ranges(leaves_.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      std::array<T, kDense> values;
      std::array<double, kDense> phi;
      for (std::size_t slot = begin; slot < end; ++slot) {
        const T* block = set_.phi.block(leaves_[slot]);
        if (std::all_of(block, block + kBlockNodes, [](T v) { return std::abs(v) > 2.5; })) continue;
        gather(tree_, set_.phi, leaves_[slot], kWidth, values.data());
        std::copy(values.begin(), values.end(), phi.begin());
        project_block(phi.data(), &offsets_[slot * kBlockNodes]);
      }
    });
  }

  static void project_block(const double* phi, Offset* out) {
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i, ++out) {
          const bool cut = touches_cut_cell(phi, i, j, k);
          if (!cut && std::abs(phi[dense_index(i, j, k)]) > kNewtonZone) continue;
          *out = newton_closest_point(phi, i, j, k);
          if (cut && !out->known()) *out = closest_edge_crossing(phi, i, j, k);
        }
  }

  // Copies the offsets of a leaf and one layer around it; nodes of coarser leaves stay unknown.
  void gather_offsets(std::size_t slot, Offset* dense) const {
    constexpr int side = kBlockSide + 2;
    for (int dir = 0; dir < kDirections; ++dir) {
      const auto [dx, dy, dz] = offset_of(dir);
      const bool same = tree_.neighbor_kind(leaves_[slot], dir) == NeighborKind::same;
      const std::uint32_t other = same ? slot_[tree_.neighbor(leaves_[slot], dir)] : kNone;
      const auto begin = [](int d) { return d > 0 ? kBlockSide : d < 0 ? -1 : 0; };
      const auto end = [](int d) { return d > 0 ? kBlockSide + 1 : d < 0 ? 0 : kBlockSide; };
      for (int k = begin(dz); k < end(dz); ++k)
        for (int j = begin(dy); j < end(dy); ++j)
          for (int i = begin(dx); i < end(dx); ++i)
            dense[(i + 1) + side * ((j + 1) + side * (k + 1))] =
                other == kNone ? Offset{}
                               : offsets_[other * kBlockNodes +
                                          node_index(i - kBlockSide * dx, j - kBlockSide * dy, k - kBlockSide * dz)];
    }
  }

  // Whether some, and whether all of a leaf's nodes are known.
  struct Coverage {
    bool some = false, all = false;
  };

  std::vector<Coverage> coverage() const {
    std::vector<Coverage> result(leaves_.size());
    parallel_for(
        leaves_.size(),
        [&](std::size_t slot) {
          const Offset* own = &offsets_[slot * kBlockNodes];
          const auto known = static_cast<std::size_t>(std::count_if(own, own + kBlockNodes, [](const Offset& o) { return o.known(); }));
          result[slot] = {known > 0, known == kBlockNodes};
        },
        64);
    return result;
  }

  // Leaves with unknown nodes that have known ones in themselves or beside them.
  std::vector<std::uint32_t> growing_leaves() const {
    const std::vector<Coverage> cover = coverage();
    std::vector<std::uint32_t> growing;
    for (std::uint32_t slot = 0; slot < leaves_.size(); ++slot) {
      if (cover[slot].all) continue;
      bool reached = cover[slot].some;
      for (int dir = 0; dir < kDirections && !reached; ++dir) {
        if (tree_.neighbor_kind(leaves_[slot], dir) != NeighborKind::same) continue;
        const std::uint32_t other = slot_[tree_.neighbor(leaves_[slot], dir)];
        reached = other != kNone && cover[other].some;
      }
      if (reached) growing.push_back(slot);
    }
    return growing;
  }

  // Gives unknown nodes the best of their neighbours' closest points, if it is within the radius. [T-REDIST-3]
  void propagate(double radius) {
    const std::vector<std::uint32_t> growing = growing_leaves();
    std::vector<std::array<Offset, kBlockNodes>> next(growing.size());
    parallel_ranges(growing.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      constexpr int side = kBlockSide + 2;
      std::array<Offset, std::size_t{side} * side * side> dense;
      for (std::size_t g = begin; g < end; ++g) {
        gather_offsets(growing[g], dense.data());
        std::copy_n(&offsets_[growing[g] * kBlockNodes], kBlockNodes, next[g].begin());
        propagate_block(dense.data(), static_cast<float>(radius), next[g].data());
      }
    });
    parallel_for(
        growing.size(), [&](std::size_t g) { std::copy(next[g].begin(), next[g].end(), &offsets_[growing[g] * kBlockNodes]); }, 64);
  }

  static void propagate_block(const Offset* dense, float radius, Offset* out) {
    constexpr int side = kBlockSide + 2;
    for (int k = 0; k < kBlockSide; ++k)
      for (int j = 0; j < kBlockSide; ++j)
        for (int i = 0; i < kBlockSide; ++i, ++out) {
          if (out->known()) continue;
          float least = radius * radius;
          for (int dz = -1; dz <= 1; ++dz)
            for (int dy = -1; dy <= 1; ++dy)
              for (int dx = -1; dx <= 1; ++dx) {
                const Offset& n = dense[(i + 1 + dx) + side * ((j + 1 + dy) + side * (k + 1 + dz))];
                if (!n.known()) continue;
                const float x = n.x + static_cast<float>(dx), y = n.y + static_cast<float>(dy), z = n.z + static_cast<float>(dz);
                const float d2 = x * x + y * y + z * z;
                if (d2 >= least) continue;
                least = d2;
                *out = {x, y, z};
              }
        }
  }

  void store() {
    parallel_for(
        leaves_.size(),
        [&](std::size_t slot) {
          T* phi = set_.phi.block(leaves_[slot]);
          for (std::size_t n = 0; n < kBlockNodes; ++n) {
            const Offset& o = offsets_[slot * kBlockNodes + n];
            const double d = o.known() ? std::min(std::sqrt(squared_length(o.x, o.y, o.z)), reach_) : reach_;
            phi[n] = static_cast<T>(phi[n] >= 0 ? d : -d);
          }
        },
        64);
  }

  BasicLevelSet<T>& set_;
  const Octree& tree_;
  const double reach_;
  Progress& progress_;
  std::vector<std::uint32_t> leaves_;  // of level 0
  std::vector<std::uint32_t> slot_;    // leaf -> place among them
  std::vector<Offset> offsets_;
};

}  // namespace

std::string_view name(RedistanceMethod method) {
  switch (method) {
    case RedistanceMethod::closest: return "closest";
    case RedistanceMethod::fmm: return "fmm";
    case RedistanceMethod::pde_weno5: return "pde-weno5";
    case RedistanceMethod::pde_first: return "pde-first";
  }
  return "";
}

template <class T>
RedistanceResult redistance(BasicLevelSet<T>& level_set, const RedistanceOptions& options, Progress& progress) {
  if (options.method == RedistanceMethod::pde_weno5 || options.method == RedistanceMethod::pde_first)
    return detail::pde_redistance(level_set, options, progress);
  Redistancer<T>(level_set, options.reach, progress).run();
  return {};
}

template <class T>
void redistance(BasicLevelSet<T>& level_set, double reach, Progress& progress) {
  RedistanceOptions options;
  options.reach = std::min(level_set.band, reach);
  redistance(level_set, options, progress);
}

template RedistanceResult redistance(BasicLevelSet<float>&, const RedistanceOptions&, Progress&);
template RedistanceResult redistance(BasicLevelSet<double>&, const RedistanceOptions&, Progress&);

template void redistance(BasicLevelSet<float>&, double, Progress&);
template void redistance(BasicLevelSet<double>&, double, Progress&);

}  // namespace burnish
