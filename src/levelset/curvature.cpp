#include "burnish/levelset/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "burnish/core/parallel.h"
#include "curvature_kernel.h"
#include "point_groups.h"

namespace burnish {
namespace {

using namespace detail;

constexpr double kReach = 2;            // cells from a point to its foot
constexpr int kRoughSteps = 12;
constexpr double kRough = 1e-2;         // cells: from here Newton's method, which has second derivatives, mostly ends in two steps
constexpr double kFoot = 1e-4;          // cells: what curvatures of second order need of a foot
constexpr int kFineSteps = 6;
constexpr double kFineFourth = 1e-6, kFineSixth = 1e-8;  // cells
constexpr double kUnsettled = 0.05;     // cells: between two cells, where gradients jump, steps can go to and fro; larger ones are kinks
constexpr double kFlattest = 0.75, kSteepest = 4.0 / 3;  // |grad phi|
constexpr double kSmooth = 0.1;         // where second derivatives of high and of second order differ by more of themselves, phi has a kink nearby,
constexpr double kFlat = 0.02;          // or of more than this times it, per cell, where they are small
constexpr double kSharpest = 2;         // the largest curvature that a lattice can show, per cell
constexpr std::size_t kGrain = 4;       // leaves

int points_of(int order) { return order + 2; }

void jet_of_order(int order, const JetBlock& block, const Vec3& p, Jet& jet) {
  if (order == 2) return jet_of_second_order(block, p, jet);
  if (order == 4) return jet_of_fourth_order(block, p, jet);
  jet_of_sixth_order(block, p, jet);
}

template <class T>
class FrontCurvatures {
 public:
  FrontCurvatures(const BasicLevelSet<T>& set, std::span<const Vec3> points, CurvatureOrder order, Progress& progress)
      : set_(set), tree_(set.octree()), points_(points), order_(static_cast<int>(order)), progress_(progress), found_(points.size()),
        leaf_of_(storing_leaves(tree_, set.phi, points)) {}

  std::vector<FrontCurvature> run() {
    for (std::size_t i = 0; i < points_.size(); ++i) found_[i].foot = points_[i];
    // Feet in leaves that their points' leaves cannot see for are found there once more: derivatives come from the foot's own level.
    visit_groups(true);
    visit_groups(false);
    return std::move(found_);
  }

 private:
  // Points whose jets are known.
  struct Batch {
    std::size_t count = 0;
    std::array<std::uint32_t, JetBatch::kSize> points;
    JetBatch jets;
  };

  void visit_groups(bool may_move) {
    const PointGroups groups(leaf_of_, tree_.size());
    parallel_ranges(groups.leaves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      std::array<T, kJetNodes> values;
      JetBlock block;
      Batch batch;
      for (std::size_t g = begin; g < end; ++g) {
        const std::uint32_t leaf = groups.leaves[g];
        gather_smooth(tree_, set_.phi, leaf, kJetWidth, order_ == 2 ? HaloOrder::cubic : HaloOrder::quintic, values.data());
        fill(values.data(), 1.0 / (1 << tree_.level(leaf)), limits_of(leaf), block);
        for (std::size_t n = groups.first[g]; n < groups.first[g + 1]; ++n) visit_point(leaf, block, groups.order[n], may_move, batch);
        finish(1.0 / (1 << tree_.level(leaf)), batch);
      }
    });
  }

  // What a value may be and still be a distance, in the leaf's cells, by where it comes from.
  JetLimits limits_of(std::uint32_t leaf) const {
    const double band = set_.band * (1 - 1e-6);  // stored bands are rounded
    // Halo nodes between coarse ones are interpolated from as far as 2.5 (1.5) coarse cells along each axis.
    const double from_coarser = std::max(2 * band - (order_ == 2 ? 3 : 5) * std::numbers::sqrt3, 0.0);
    JetLimits limits;
    for (int dir = 0; dir < kDirections; ++dir) {
      const NeighborKind kind = tree_.neighbor_kind(leaf, dir);
      const double limit = kind == NeighborKind::same ? band : kind == NeighborKind::finer ? band / 2 : kind == NeighborKind::coarser ? from_coarser : 0;
      const int begin = std::array{0, kJetWidth, kJetWidth + kBlockSide}[static_cast<std::size_t>(dir % 3)];
      std::array<double, kJetSide>& row = limits[static_cast<std::size_t>(dir / 3)];
      std::fill_n(row.begin() + begin, dir % 3 == 1 ? kBlockSide : kJetWidth, limit);
    }
    return limits;
  }

  // Whether derivatives at p, in the array of the leaf, are those in the array of the leaf that holds p: it is this leaf, or one of the same level
  // whose stencils this array holds.
  bool serves(std::uint32_t leaf, const Vec3& p) const {
    const int low = points_of(order_) / 2 - 1, high = kJetSide - points_of(order_) / 2;
    std::array<int, 3> toward{};
    for (int a = 0; a < 3; ++a) {
      if (!(p[a] >= low && p[a] < high)) return false;
      toward[static_cast<std::size_t>(a)] = p[a] < kJetWidth ? -1 : p[a] < kJetWidth + kBlockSide ? 0 : 1;
    }
    const int dir = direction(toward[0], toward[1], toward[2]);
    return dir == kSelf || tree_.neighbor_kind(leaf, dir) == NeighborKind::same;
  }

  void visit_point(std::uint32_t leaf, const JetBlock& block, std::uint32_t i, bool may_move, Batch& batch) {
    FrontCurvature& found = found_[i];
    const Vec3 x = to_array(tree_, leaf, kJetWidth, points_[i]);
    Vec3 y = to_array(tree_, leaf, kJetWidth, found.foot);
    leaf_of_[i] = Octree::kNone;
    // In a finer leaf than the point's the same way has twice as many cells.
    if (!find_foot(block, x, may_move ? kReach : 2 * kReach, y)) return;
    if (may_move && !serves(leaf, y)) {
      found.foot = to_lattice(tree_, leaf, kJetWidth, y);
      leaf_of_[i] = storing_leaf(tree_, set_.phi, found.foot, leaf);
      return;
    }
    Jet jet;
    found.order = find_jet(block, x, y, jet);
    if (found.order == 0) return;
    found.foot = to_lattice(tree_, leaf, kJetWidth, y);
    batch.jets.set(batch.count, jet);
    batch.points[batch.count++] = i;
    if (batch.count == JetBatch::kSize) finish(1.0 / (1 << tree_.level(leaf)), batch);
  }

  // [T-REDIST-1] Closest point to x on the tricubic interpolant's zero surface, from y on.
  bool find_foot(const JetBlock& block, const Vec3& x, double reach, Vec3& y) const {
    const double enough = order_ == 2 ? kFoot : kRough;
    double length = 0;
    for (int step = 0; step < kRoughSteps; ++step) {
      double value;
      Vec3 g;
      cubic(block, y, value, g);
      const double g2 = squared_norm(g);
      if (!(g2 > 1e-4)) return false;
      const Vec3 along = x - y;
      Vec3 move = g * (-value / g2) + along - g * (dot(along, g) / g2);
      length = norm(move);
      if (length > 1) move *= 1 / length;
      y += move;
      if (!(squared_norm(y - x) <= reach * reach)) return false;
      if (length < enough) return true;
    }
    return length < kUnsettled;
  }

  // The jet at the closest point to x, near y, and its order: the highest that is asked for and whose stencil is free of clamped values. 0: none.
  int find_jet(const JetBlock& block, const Vec3& x, Vec3& y, Jet& jet) const {
    int order = order_;
    const double fine = order == 4 ? kFineFourth : kFineSixth;
    for (int step = 0; step < kFineSteps; ++step) {
      while (!block.is_free(points_of(order), y))
        if ((order -= 2) == 0) return 0;
      jet_of_order(order, block, y, jet);
      const double length = norm(jet.gradient);
      if (!(length > kFlattest && length < kSteepest)) return 0;
      if (order == 2) return order;
      const Vec3 move = newton_move(jet, length, x - y);
      y += move;
      const double longest = step + 1 < kFineSteps ? 1 : kUnsettled;
      if (!(squared_norm(move) < longest * longest)) return 0;
      if (squared_norm(move) < fine * fine) break;
    }
    return is_smooth(block, y, jet) ? order : 2;
  }

  // [T-CURV-7] Where the stencil seems to reach over a kink, derivatives of second order take the jet's place.
  static bool is_smooth(const JetBlock& block, const Vec3& y, Jet& jet) {
    const auto size = [](double xx, double yy, double zz, double xy, double xz, double yz) {
      return xx * xx + yy * yy + zz * zz + 2 * (xy * xy + xz * xz + yz * yz);
    };
    Jet low;
    jet_of_second_order(block, y, low);
    const double difference = size(jet.xx - low.xx, jet.yy - low.yy, jet.zz - low.zz, jet.xy - low.xy, jet.xz - low.xz, jet.yz - low.yz);
    const double most = kSmooth * (std::sqrt(size(low.xx, low.yy, low.zz, low.xy, low.xz, low.yz)) + kFlat);
    if (difference <= most * most) return true;
    jet = low;
    return false;
  }

  // [T-CURV-5] `along`: from the foot as it is to the point.
  static Vec3 newton_move(const Jet& jet, double length, const Vec3& along) {
    const auto times = [&](const Vec3& a) {
      return Vec3{jet.xx * a.x + jet.xy * a.y + jet.xz * a.z, jet.xy * a.x + jet.yy * a.y + jet.yz * a.z, jet.xz * a.x + jet.yz * a.y + jet.zz * a.z};
    };
    const Vec3 n = jet.gradient * (-1 / length), hn = times(n);
    const double nhn = dot(n, hn), trace = -(jet.xx + jet.yy + jet.zz - nhn) / length;
    // tr(S^2) = tr((P H P)^2) / |grad phi|^2
    const double h2 = jet.xx * jet.xx + jet.yy * jet.yy + jet.zz * jet.zz + 2 * (jet.xy * jet.xy + jet.xz * jet.xz + jet.yz * jet.yz);
    const double squares = (h2 - 2 * squared_norm(hn) + nhn * nhn) / (length * length);
    const double d = dot(along, n), determinant = std::max(1 + d * trace + 0.5 * d * d * (trace * trace - squares), 0.1);
    const Vec3 t = along - n * d, ht = times(t), st = (ht - n * dot(n, ht)) * (-1 / length);
    return n * (jet.value / length) + (t * (1 + d * trace) - st * d) * (1 / determinant);
  }

  void finish(double per_cell, Batch& batch) {
    CurvatureBatch curvatures;
    principal_curvatures(batch.jets, batch.count, curvatures);
    for (std::size_t n = 0; n < batch.count; ++n) {
      FrontCurvature& found = found_[batch.points[n]];
      const double k1 = curvatures.k1[n], k2 = curvatures.k2[n];
      found.normal = CurvatureBatch::at(curvatures.normal, n);
      found.k1 = k1 * per_cell;
      found.k2 = k2 * per_cell;
      found.direction1 = CurvatureBatch::at(curvatures.direction1, n);
      found.direction2 = CurvatureBatch::at(curvatures.direction2, n);
      found.converged = std::abs(k1) <= kSharpest && std::abs(k2) <= kSharpest;
    }
    batch.count = 0;
  }

  const BasicLevelSet<T>& set_;
  const Octree& tree_;
  std::span<const Vec3> points_;
  const int order_;
  Progress& progress_;
  std::vector<FrontCurvature> found_;
  std::vector<std::uint32_t> leaf_of_;  // of points that are still to be visited
};

}  // namespace

double curvature_band(CurvatureOrder order) {
  // The farthest corner of a stencil around the foot's cell, with some room for how a surface bends.
  const int reach = points_of(static_cast<int>(order)) / 2;
  return reach * std::numbers::sqrt3 + 0.5;
}

template <class T>
std::vector<FrontCurvature> front_curvature(const BasicLevelSet<T>& level_set, std::span<const Vec3> points, CurvatureOrder order, Progress& progress) {
  return FrontCurvatures<T>(level_set, points, order, progress).run();
}

template std::vector<FrontCurvature> front_curvature(const BasicLevelSet<float>&, std::span<const Vec3>, CurvatureOrder, Progress&);
template std::vector<FrontCurvature> front_curvature(const BasicLevelSet<double>&, std::span<const Vec3>, CurvatureOrder, Progress&);

}  // namespace burnish
