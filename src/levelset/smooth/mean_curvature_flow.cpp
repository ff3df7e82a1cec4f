#include "burnish/levelset/smooth/mean_curvature_flow.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/levelset/redistance.h"
#include "../curvature_formula.h"

namespace burnish {
namespace {

constexpr double kLargestStep = 1.0 / 6;  // in cells squared; explicit Euler is stable up to here
constexpr int kStepsPerRedistance = 6;
constexpr double kActive = 3.5;           // cells around the surface that flow; others wait for the next redistancing
constexpr double kSteepest = 2;           // largest curvature that a lattice can show, in 1 / cell

// kappa |grad phi| by central differences; the thesis' (4.5) with phi_xx for its misprinted phi_xx^2. [T-CURV-1]
template <class At>
double curvature_speed(At&& at) {
  const double c = at(0, 0, 0);
  const double xp = at(1, 0, 0), xm = at(-1, 0, 0), yp = at(0, 1, 0), ym = at(0, -1, 0), zp = at(0, 0, 1), zm = at(0, 0, -1);
  const double x = 0.5 * (xp - xm), y = 0.5 * (yp - ym), z = 0.5 * (zp - zm);
  const double xx = xp - 2 * c + xm, yy = yp - 2 * c + ym, zz = zp - 2 * c + zm;
  const double xy = 0.25 * (at(1, 1, 0) - at(1, -1, 0) - at(-1, 1, 0) + at(-1, -1, 0));
  const double xz = 0.25 * (at(1, 0, 1) - at(1, 0, -1) - at(-1, 0, 1) + at(-1, 0, -1));
  const double yz = 0.25 * (at(0, 1, 1) - at(0, 1, -1) - at(0, -1, 1) + at(0, -1, -1));
  const double g2 = x * x + y * y + z * z;
  if (g2 < 1e-12) return 0;
  const double speed = detail::curvature_times_cube(x, y, z, xx, yy, zz, xy, xz, yz) / g2;
  const double limit = kSteepest * std::sqrt(g2);
  return std::clamp(speed, -limit, limit);
}

template <class T>
void euler_step(const BasicLevelSet<T>& set, double dt, Field<T>& next, Progress& progress) {
  constexpr int side = kBlockSide + 2;
  const double active = std::min(kActive, set.band - 1.5);
  parallel_ranges(set.octree().size(), 16, [&](std::size_t begin, std::size_t end) {
    progress.check();
    std::array<T, std::size_t{side} * side * side> dense;
    for (std::size_t leaf = begin; leaf < end; ++leaf) {
      if (set.octree().level(leaf) != 0 || !set.phi.stores(leaf)) continue;
      const T* old = set.phi.block(leaf);
      T* out = next.block(leaf);
      if (std::all_of(old, old + kBlockNodes, [&](T v) { return std::abs(v) >= active; })) {
        std::copy(old, old + kBlockNodes, out);
        continue;
      }
      gather(set.octree(), set.phi, leaf, 1, dense.data());
      for (int k = 0; k < kBlockSide; ++k)
        for (int j = 0; j < kBlockSide; ++j)
          for (int i = 0; i < kBlockSide; ++i) {
            const std::size_t n = node_index(i, j, k);
            if (std::abs(old[n]) >= active) {
              out[n] = old[n];
              continue;
            }
            const T* center = &dense[static_cast<std::size_t>((i + 1) + side * ((j + 1) + side * (k + 1)))];
            const double speed = curvature_speed(
                [&](int dx, int dy, int dz) { return static_cast<double>(center[dx + side * (dy + side * dz)]); });
            out[n] = static_cast<T>(old[n] + dt * speed);  // [T-FLOW-1]
          }
    }
  });
}

}  // namespace

template <class T>
FlowResult mean_curvature_flow(BasicLevelSet<T>& set, double time, Progress& progress, RedistanceMethod method) {
  FlowResult result;
  RedistanceOptions redistancing;
  redistancing.method = method;
  redistancing.reach = std::min(set.band, kFlowBand);
  QuietProgress part(progress);  // redistancing is part of a step
  if (time <= 0) return result;
  const int steps = static_cast<int>(std::ceil(time / kLargestStep));  // [T-FLOW-3]
  const double dt = time / steps;
  Field<T> next = set.phi;
  for (int step = 1; step <= steps; ++step) {
    progress.check();
    euler_step(set, dt, next, progress);
    std::swap(set.phi, next);
    if (step % kStepsPerRedistance == 0 || step == steps) {
      result.unsteady += !redistance(set, redistancing, part).steady;
      next = set.phi;
    }
    progress.update(static_cast<double>(step) / steps);
  }
  result.time = time;
  result.steps = steps;
  return result;
}

template FlowResult mean_curvature_flow(BasicLevelSet<float>&, double, Progress&, RedistanceMethod);
template FlowResult mean_curvature_flow(BasicLevelSet<double>&, double, Progress&, RedistanceMethod);

}  // namespace burnish
