#include "burnish/levelset/curvature.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>

#include "burnish/core/parallel.h"
#include "curvature_kernel.h"
#include "point_groups.h"
#include "shape_operator.h"

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
  void visit_groups(bool may_move) {
    const PointGroups groups(leaf_of_, tree_.size());
    parallel_ranges(groups.leaves.size(), kGrain, [&](std::size_t begin, std::size_t end) {
      progress_.check();
      std::array<T, kJetNodes> values;
      JetBlock block;
      for (std::size_t g = begin; g < end; ++g) {
        const std::uint32_t leaf = groups.leaves[g];
        gather_smooth(tree_, set_.phi, leaf, kJetWidth, order_ == 2 ? HaloOrder::cubic : HaloOrder::quintic, values.data());
        fill(values.data(), 1.0 / (1 << tree_.level(leaf)), limits_of(leaf), block);
        for (std::size_t n = groups.first[g]; n < groups.first[g + 1]; ++n) visit_point(leaf, block, groups.order[n], may_move);
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

  void visit_point(std::uint32_t leaf, const JetBlock& block, std::uint32_t i, bool may_move) {
    FrontCurvature& found = found_[i];
    const Vec3 x = to_array(tree_, leaf, kJetWidth, points_[i]);
    Vec3 y = to_array(tree_, leaf, kJetWidth, found.foot);
    leaf_of_[i] = Octree::kNone;
    if (!find_foot(block, x, y)) return;
    if (may_move && !serves(leaf, y)) {
      found.foot = to_lattice(tree_, leaf, kJetWidth, y);
      leaf_of_[i] = storing_leaf(tree_, set_.phi, found.foot, leaf);
      return;
    }
    Jet jet;
    found.order = find_jet(block, x, y, jet);
    if (found.order == 0) return;
    found.foot = to_lattice(tree_, leaf, kJetWidth, y);
    set_curvatures(jet, 1.0 / (1 << tree_.level(leaf)), found);
  }

  // [T-REDIST-1] Closest point to x on the tricubic interpolant's zero surface, from y on.
  bool find_foot(const JetBlock& block, const Vec3& x, Vec3& y) const {
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
      if (!(squared_norm(y - x) <= 2 * kReach * kReach)) return false;
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
      const Vec3 move = newton_move(ShapeOperator(jet, length), jet.value / length, x - y);
      y += move;
      const double longest = step + 1 < kFineSteps ? 1 : kUnsettled;
      if (!(squared_norm(move) < longest * longest)) return 0;
      if (squared_norm(move) < fine * fine) break;
    }
    return order;
  }

  // [T-CURV-5] `inside`: distance from the level set to the surface, outwards positive.
  static Vec3 newton_move(const ShapeOperator& s, double inside, const Vec3& along) {
    const double out = dot(along, s.frame.normal), a = dot(along, s.frame.u), b = dot(along, s.frame.v);
    const double uu = 1 + out * s.uu, uv = out * s.uv, vv = 1 + out * s.vv;
    const double determinant = std::max(uu * vv - uv * uv, 0.1);
    return s.frame.normal * inside + s.frame.u * ((vv * a - uv * b) / determinant) + s.frame.v * ((uu * b - uv * a) / determinant);
  }

  static void set_curvatures(const Jet& jet, double per_cell, FrontCurvature& found) {
    const ShapeOperator s(jet, norm(jet.gradient));
    const double half = s.half_difference();
    found.normal = s.frame.normal;
    found.k1 = (s.mean() + half) * per_cell;
    found.k2 = (s.mean() - half) * per_cell;
    found.direction1 = s.direction1();
    found.direction2 = cross(found.normal, found.direction1);
    found.converged = std::abs(s.mean()) + half <= kSharpest;
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
  return points_of(static_cast<int>(order)) / 2 * std::numbers::sqrt3 + 0.5;
}

template <class T>
std::vector<FrontCurvature> front_curvature(const BasicLevelSet<T>& level_set, std::span<const Vec3> points, CurvatureOrder order, Progress& progress) {
  return FrontCurvatures<T>(level_set, points, order, progress).run();
}

template std::vector<FrontCurvature> front_curvature(const BasicLevelSet<float>&, std::span<const Vec3>, CurvatureOrder, Progress&);
template std::vector<FrontCurvature> front_curvature(const BasicLevelSet<double>&, std::span<const Vec3>, CurvatureOrder, Progress&);

}  // namespace burnish
