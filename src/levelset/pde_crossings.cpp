#include "pde_crossings.h"

#include <algorithm>
#include <cmath>
#include <cstdlib>

namespace burnish::detail {
namespace {

constexpr double kHeld = 0.05;         // cells from a crossing at which a node is held
constexpr double kFifthAgrees = 0.1;  // cells that the roots of fifth and third degree differ by at most where phi0 is smooth
constexpr double kThirdAgrees = 0.2;   // the same of third and first degree
constexpr double kNearest = 1e-6;      // cells that a crossing is away from a node, at least
constexpr int kRootSteps = 30;

// Newton's polynomial through nodes 0, 1, -1, 2, -2, 3, in this order.
struct EdgePolynomial {
  std::array<double, 6> c;

  explicit EdgePolynomial(std::array<double, 6> f) {
    constexpr std::array<double, 6> x{0, 1, -1, 2, -2, 3};
    for (std::size_t order = 1; order < 6; ++order)
      for (std::size_t i = 5; i >= order; --i) f[i] = (f[i] - f[i - 1]) / (x[i] - x[i - order]);
    c = f;
  }
  double operator()(double t, int degree) const {
    const double third = degree > 3 ? c[3] + (t - 2) * (c[4] + (t + 2) * c[5]) : c[3];
    return c[0] + t * (c[1] + (t - 1) * (c[2] + (t + 1) * third));
  }
  // Its root in (0, 1), the ends having different signs: regula falsi, the Illinois variant.
  double root(int degree) const {
    double low = 0, high = 1, at_low = c[0], at_high = c[0] + c[1];
    double t = at_low / (at_low - at_high);
    for (int step = 0; step < kRootSteps; ++step) {
      const double value = (*this)(t, degree);
      if (value == 0) return t;
      if ((value > 0) == (at_high > 0)) {
        high = t, at_high = value, at_low *= 0.5;
      } else {
        low = t, at_low = value, at_high *= 0.5;
      }
      const double next = low + (high - low) * at_low / (at_low - at_high);
      if (std::abs(next - t) < 1e-13) return next;
      t = next;
    }
    return t;
  }
};

// Where phi0 = 0 between a node and the next one, 0 to 1. [T-PDE-3]
double crossing_of_edge(const double* lower, int stride) {
  const double f0 = lower[0], f1 = lower[stride];
  if (f0 == 0) return 0;
  if (f1 == 0) return 1;
  const EdgePolynomial phi({f0, f1, lower[-stride], lower[2 * stride], lower[-2 * stride], lower[3 * stride]});
  const double linear = f0 / (f0 - f1), third = phi.root(3), fifth = phi.root(5);
  if (std::abs(fifth - third) <= kFifthAgrees) return fifth;
  return std::abs(third - linear) <= kThirdAgrees ? third : linear;
}

bool on_other_side(double phi, double other) { return phi > 0 ? other <= 0 : other >= 0; }

// From a node along -x, +x, ... +z to the surface; 0: not within a cell.
std::array<double, 6> crossings_of_node(const double* node) {
  std::array<double, 6> found{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const int stride = HaloBlock::kStride[axis];
    if (on_other_side(node[0], node[-stride])) found[2 * axis] = std::max(1 - crossing_of_edge(node - stride, stride), kNearest);
    if (on_other_side(node[0], node[stride])) found[2 * axis + 1] = std::max(crossing_of_edge(node, stride), kNearest);
  }
  return found;
}

// phi0 over its slope, no farther than the nearest crossing and no nearer than a plane could be. [T-PDE-6]
double held_distance(const double* node, double nearest) {
  double squared = 0;
  for (const int stride : HaloBlock::kStride) {
    const double slope = (8 * (node[stride] - node[-stride]) - (node[2 * stride] - node[-2 * stride])) / 12;
    squared += slope * slope;
  }
  const double low = nearest / std::sqrt(3.0);
  return squared > 0 ? std::clamp(std::abs(node[0]) / std::sqrt(squared), low, nearest) : nearest;
}

// Steps are shortened as the nearest crossings along the axes demand. [T-PDE-5]
double step_of(const std::array<double, 6>& crossing) {
  double sum = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    double nearest = 1;
    for (const double t : {crossing[2 * axis], crossing[2 * axis + 1]})
      if (t > 0) nearest = std::min(nearest, t);
    sum += 1 / (nearest * nearest);
  }
  return std::sqrt(3 / sum);
}

void append(std::vector<CutNodes>& cut, std::size_t node, const std::array<double, 6>& crossing, double step) {
  if (cut.empty() || cut.back().count == kBlockSide) cut.emplace_back();
  CutNodes& last = cut.back();
  // The lanes behind the last node repeat it.
  for (std::size_t lane = last.count; lane < kBlockSide; ++lane) {
    last.node[lane] = static_cast<std::uint16_t>(node);
    last.step[lane] = step;
    for (std::size_t side = 0; side < 6; ++side) last.crossing[side][lane] = crossing[side];
  }
  ++last.count;
}

}  // namespace

void find_crossings(const HaloBlock& phi0, BlockCrossings& crossings) {
  for (std::size_t n = 0; n < kBlockNodes; ++n) {
    const int i = static_cast<int>(n);
    const double* node = &phi0.values[HaloBlock::index(i % 8, i / 8 % 8, i / 64)];
    if (node[0] == 0 || has(crossings.still, n)) continue;
    const std::array<double, 6> found = crossings_of_node(node);
    double nearest = 2;
    for (const double t : found)
      if (t > 0) nearest = std::min(nearest, t);
    if (nearest > 1) continue;
    crossings.any = true;
    add(crossings.still, n);
    if (nearest < kHeld)
      crossings.held.push_back({static_cast<std::uint16_t>(n), held_distance(node, nearest)});
    else
      append(crossings.cut, n, found, step_of(found));
  }
}

}  // namespace burnish::detail
