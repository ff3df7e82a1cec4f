#include "field_sampler.h"

#include <algorithm>
#include <cmath>
#include <iterator>
#include <utility>

namespace burnish::detail {
namespace {

constexpr double kZero = 1e-5;          // of phi, and of a bracket's length
constexpr double kLinear = 3;           // cells: brackets longer than that are halved, as phi may be clamped in them
constexpr std::size_t kCallsPerCheck = 1u << 14;
constexpr int kMostRepeats = 8;
constexpr double kStep = 0.05;  // cells, of differences

double lerp(double a, double b, double t) { return a + t * (b - a); }

}  // namespace

FieldSampler::FieldSampler(const LevelSet& level_set, Progress& progress)
    : set_(level_set),
      progress_(progress),
      side_(static_cast<std::int32_t>(level_set.octree().side()) * kBlockSide),
      slot_(level_set.octree().size(), Octree::kNone) {}

void FieldSampler::check() {
  if (calls_ > limit_) throw TooManyCalls{};
  if (calls_ % kCallsPerCheck == 0) progress_.check();
}

void FieldSampler::load(std::uint32_t leaf) {
  constexpr int wide = kBlockSide + 2;
  std::array<float, wide * wide * wide> dense;
  gather(set_.octree(), set_.phi, leaf, 1, dense.data());
  slot_[leaf] = static_cast<std::uint32_t>(values_.size() / kValues);
  for (int k = 0; k < kSide; ++k)
    for (int j = 0; j < kSide; ++j) {
      const float* row = dense.data() + 1 + wide * (j + 1 + wide * (k + 1));
      std::transform(row, row + kSide, std::back_inserter(values_), [](float v) { return std::isnan(v) ? static_cast<float>(kOutside) : v; });
    }
}

void FieldSampler::enter_leaf(const std::array<std::int32_t, 3>& at) {
  const Octree& tree = set_.octree();
  const auto block = [&](std::size_t a) { return static_cast<std::uint32_t>(at[a]) / kBlockSide; };
  leaf_ = tree.find_near(leaf_, {block(0), block(1), block(2)});
  const morton::Position c = tree.corner(leaf_);
  corner_ = {static_cast<std::int32_t>(c.x) * kBlockSide, static_cast<std::int32_t>(c.y) * kBlockSide, static_cast<std::int32_t>(c.z) * kBlockSide};
  extent_ = kBlockSide << tree.level(leaf_);
  per_cell_ = 1.0 / (1 << tree.level(leaf_));
  if (slot_[leaf_] == Octree::kNone) load(leaf_);
  first_ = slot_[leaf_] * kValues;
}

double FieldSampler::operator()(const Vec3& p) {
  ++calls_;
  if (calls_ > limit_ || calls_ % kCallsPerCheck == 0) check();
  const double side = side_;
  if (!(p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x < side && p.y < side && p.z < side)) return kOutside;
  const std::array<std::int32_t, 3> at{static_cast<std::int32_t>(p.x), static_cast<std::int32_t>(p.y), static_cast<std::int32_t>(p.z)};
  const auto within = [&](std::size_t a) { return static_cast<std::uint32_t>(at[a] - corner_[a]) < static_cast<std::uint32_t>(extent_); };
  if (!(within(0) && within(1) && within(2))) enter_leaf(at);
  const double x = (p.x - corner_[0]) * per_cell_, y = (p.y - corner_[1]) * per_cell_, z = (p.z - corner_[2]) * per_cell_;
  const int i = static_cast<int>(x), j = static_cast<int>(y), k = static_cast<int>(z);
  const double tx = x - i, ty = y - j, tz = z - k;
  const float* v = values_.data() + first_ + static_cast<std::size_t>(i + kSide * (j + kSide * k));
  const auto plane = [&](const float* w) { return lerp(lerp(w[0], w[1], tx), lerp(w[kSide], w[kSide + 1], tx), ty); };
  return lerp(plane(v), plane(v + kSide * kSide), tz);
}

// A triangulation's dual edges end anywhere: circumcentres of flat tetrahedra are 1e15 cells away, and points of such an edge are only accurate if they are
// reckoned from its end in the domain. The other end is moved to the domain's wall.
bool FieldSampler::clip(Vec3& a, Vec3& b) const {
  const auto is_within = [&](const Vec3& p) {
    return p.x >= 0 && p.y >= 0 && p.z >= 0 && p.x <= side_ && p.y <= side_ && p.z <= side_;
  };
  if (!is_within(a)) std::swap(a, b);
  if (!is_within(a) || !is_finite(b)) return false;
  if (is_within(b)) return true;
  double most = 1;
  const Vec3 d = b - a;
  for (int axis = 0; axis < 3; ++axis) {
    if (b[axis] > side_) most = std::min(most, (side_ - a[axis]) / d[axis]);
    if (b[axis] < 0) most = std::min(most, -a[axis] / d[axis]);
  }
  b = a + d * most;
  return true;
}

std::optional<Vec3> FieldSampler::crossing(Vec3 a, Vec3 b) {
  if (a == last_ends_[0] && b == last_ends_[1]) {
    if (++repeats_ > kMostRepeats) return std::nullopt;
  } else {
    last_ends_ = {a, b};
    repeats_ = 0;
  }
  ++calls_;
  check();
  if (!clip(a, b)) return std::nullopt;
  double low = 0, high = 1, at_low = (*this)(a), at_high = (*this)(b);
  if ((at_low >= 0) == (at_high >= 0)) return std::nullopt;
  const bool low_inside = at_low >= 0;
  const Vec3 whole = b - a;
  const double length = norm(whole);
  double t = 0.5;
  int last_side = 0;
  for (int i = 0; i < 100 && (high - low) * length > kZero; ++i) {
    // Illinois: a bracket's end that stays counts half. [T-DELAUNAY-1]
    const bool halve = (high - low) * length > kLinear || i % 4 == 3;
    t = halve ? 0.5 * (low + high) : low + (high - low) * at_low / (at_low - at_high);
    const double here = (*this)(a + whole * t);
    if (std::abs(here) < kZero) break;
    const int side = (here >= 0) == low_inside ? -1 : 1;
    (side < 0 ? low : high) = t;
    (side < 0 ? at_low : at_high) = here;
    if (side == last_side) (side < 0 ? at_high : at_low) *= 0.5;
    last_side = halve ? 0 : side;
  }
  return a + whole * t;
}

Vec3 FieldSampler::gradient(const Vec3& p) {
  Vec3 g;
  for (int axis = 0; axis < 3; ++axis) {
    Vec3 step;
    step[axis] = kStep;
    g[axis] = ((*this)(p + step) - (*this)(p - step)) / (2 * kStep);
  }
  return g;
}

Vec3 FieldSampler::projected(const Vec3& p, double reach) {
  Vec3 q = p;
  for (int i = 0; i < 8; ++i) {
    const double phi = (*this)(q);
    if (std::abs(phi) < kZero) return q;
    const Vec3 g = gradient(q);
    const double size = squared_norm(g);
    if (!(size > 1e-3)) return p;
    q -= g * (phi / size);
    if (!(squared_norm(q - p) <= reach * reach)) return p;
  }
  return q;
}

}  // namespace burnish::detail
