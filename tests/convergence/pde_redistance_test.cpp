// Redistancing by the PDE: orders of convergence, what the surface moves by, and what must hold on any field.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/levelset/redistance.h"
#include "support/analytic_level_set.h"
#include "support/analytic_shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kReach = 3;  // cells
constexpr double kRoom = 4;   // cells of stored values beyond it

struct Start {
  bool frozen = false;  // exact, accepted values within two cells
  bool loose = false;   // nothing holds the surface: no node is accepted
  bool jump = false;    // the coarser half of the shape has cells of two
};

// Worst of several runs. Distances in parts of the shape's size, the movement in cells.
struct Outcome {
  double error = 0;     // of phi within the band, outside of the frozen layer
  double movement = 0;  // of the surface
  double residual = 0;
  int steps = 0;
};

template <class Visit>
void for_each_stored_node(const BasicLevelSet<double>& set, Visit&& visit) {
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    if (set.phi.stores(leaf))
      for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
        visit(leaf, static_cast<std::size_t>(n), to_vec(lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64)));
}

// Where the quintic through six nodes -2 ... 3 is 0 between nodes 0 and 1.
double quintic_root(const std::array<double, 6>& f) {
  const auto at = [&](double t) {
    double sum = 0;
    for (int i = 0; i < 6; ++i) {
      double weight = 1;
      for (int j = 0; j < 6; ++j)
        if (j != i) weight *= (t - (j - 2)) / (i - j);
      sum += weight * f[static_cast<std::size_t>(i)];
    }
    return sum;
  };
  double low = 0, high = 1;
  for (int i = 0; i < 45; ++i) {
    const double middle = 0.5 * (low + high);
    ((at(middle) > 0) == (f[3] > 0) ? high : low) = middle;
  }
  return 0.5 * (low + high);
}

// The largest distance, in cells, of crossings of lattice edges from the true surface, which is that of phi0, too.
double movement(const BasicLevelSet<double>& set, const PlacedShape& placed) {
  constexpr int side = kBlockSide + 6;
  std::vector<double> dense(side * side * side);
  double worst = 0;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    const double* block = set.phi.block(leaf);
    if (!set.phi.stores(leaf) || std::all_of(block, block + kBlockNodes, [&](double v) { return std::abs(v) > 2 << set.octree().level(leaf); })) continue;
    gather_smooth(set.octree(), set.phi, leaf, 3, HaloOrder::cubic, dense.data());
    const double cell = 1 << set.octree().level(leaf);
    for (int n = 0; n < 3 * static_cast<int>(kBlockNodes); ++n) {
      const int axis = n / 512, i = n % 8, j = n / 8 % 8, k = n / 64 % 8, step = axis == 0 ? 1 : axis == 1 ? side : side * side;
      const double* lower = &dense[static_cast<std::size_t>((i + 3) + side * ((j + 3) + side * (k + 3)))];
      if ((lower[0] > 0) == (lower[step] > 0)) continue;
      Vec3 x = to_vec(lattice_node(set.octree(), leaf, i, j, k));
      x[axis] += cell * quintic_root({lower[-2 * step], lower[-step], lower[0], lower[step], lower[2 * step], lower[3 * step]});
      worst = std::max(worst, std::abs(placed.distance(x)) / cell);
    }
  }
  return worst;
}

// phi0 = (0.1 + |x - x0|^2) distance, x0 on the surface, lengths in parts of the shape's size.
void run_once(RedistanceMethod method, const Start& start, const PlacedShape& placed, double steady, Outcome& worst) {
  BasicLevelSet<double> set =
      level_set_of_shape<double>(placed, kReach + (start.frozen ? kRoom : 1), start.jump ? jump_through(placed) : std::function<int(const Vec3&)>{});
  const Vec3 x0 = placed.closest(placed.center + Vec3{2.0, 0.5, 0.1} * placed.size).foot;
  Field<std::uint8_t> accepted = Field<std::uint8_t>::like(set.phi, 0, 0);
  for_each_stored_node(set, [&](std::size_t leaf, std::size_t n, const Vec3& x) {
    const double distance = placed.distance(x);
    const bool is_accepted = start.frozen && std::abs(distance) < 2 << set.octree().level(leaf);
    accepted.block(leaf)[n] = is_accepted;
    set.phi.block(leaf)[n] = is_accepted ? distance : distance * (0.1 + squared_norm(x - x0) / (placed.size * placed.size));
  });
  const BasicLevelSet<double> before = set;
  RedistanceOptions options;
  options.method = method;
  options.reach = kReach;
  options.steady = steady;
  if (start.frozen || start.loose) options.accepted = &accepted;
  const RedistanceResult result = redistance(set, options);
  worst.steps = std::max(worst.steps, result.steps);
  worst.residual = std::max(worst.residual, result.residual);
  worst.movement = std::max(worst.movement, movement(set, placed));
  int wrong = 0;
  for_each_stored_node(set, [&](std::size_t leaf, std::size_t n, const Vec3& x) {
    const double was = before.phi.block(leaf)[n], is = set.phi.block(leaf)[n], distance = placed.distance(x);
    wrong += accepted.block(leaf)[n] != 0 ? std::memcmp(&was, &is, sizeof is) != 0 : !((was > 0) == (is > 0) && std::abs(is) < 1e3);
    if (accepted.block(leaf)[n] == 0 && std::abs(distance) < kReach - 0.1)
      worst.error = std::max(worst.error, std::abs(is - distance) / placed.size);
  });
  EXPECT_EQ(wrong, 0) << "signs, accepted values, or not finite";
}

// N cells across: a quarter of them is the sphere's radius, an eighth the radius of the torus' tube.
Outcome redistanced(RedistanceMethod method, const AnalyticShape& shape, int cells, int offsets, const Start& start = {}, double steady = 1e-6) {
  Outcome worst;
  for (int i = 0; i < offsets; ++i) {
    const unsigned seed = 100 + static_cast<unsigned>(i);
    SCOPED_TRACE(shape.name() + ", cells " + std::to_string(cells) + ", seed " + std::to_string(seed));
    std::mt19937 random(seed);
    run_once(method, start, placed_at_random(shape, cells / (shape.radius() > 2 ? 8.0 : 4.0), 8, random), steady, worst);
  }
  // T3_pde-weno5_sphere_64_error and so on.
  const std::string how = start.frozen ? "-frozen" : start.loose ? "-loose" : "";
  const std::string label = fmt::format("T3_{}{}_{}{}_{}", name(method), how, shape.name(), start.jump ? "-jump" : "", cells);
  testing::Test::RecordProperty(label + "_error", fmt::format("{:.3e}", worst.error));
  testing::Test::RecordProperty(label + "_moved", fmt::format("{:.3e}", worst.movement));
  testing::Test::RecordProperty(label + "_steps", worst.steps);
  return worst;
}

double order(double coarse, double fine) { return std::log2(coarse / fine); }

constexpr auto kWeno = RedistanceMethod::pde_weno5, kFirst = RedistanceMethod::pde_first;

TEST(PdeRedistance, BadlyScaledStartsKeepTheSurface) {
  const auto sphere = unit_sphere(), torus = unit_torus();
  for (const auto& [shape, cells, offsets] : {std::tuple{sphere.get(), 32, 3}, {sphere.get(), 64, 2}, {sphere.get(), 128, 1}, {sphere.get(), 256, 1},
                                              {torus.get(), 32, 2}, {torus.get(), 64, 1}, {torus.get(), 128, 1}}) {
    const Outcome found = redistanced(kWeno, *shape, cells, offsets, {}, cells > 100 ? 1e-3 : 1e-6);
    EXPECT_LE(found.movement, 1e-2) << shape->name() << ' ' << cells;
    // The torus of 32 cells has its medial axis one cell beyond the band.
    EXPECT_LE(found.error * cells, shape == torus.get() && cells == 32 ? 0.25 : 2e-2) << shape->name() << ' ' << cells;
  }
}

// Why crossings are stencil points: without them the shift of the surface is a mode that nothing damps. [T-PDE-3]
TEST(PdeRedistance, NothingElseHoldsTheSurface) {
  const auto sphere = unit_sphere();
  for (const int cells : {32, 64}) EXPECT_GE(redistanced(kWeno, *sphere, cells, 1, {.loose = true}, 1e-3).movement, 0.1);
}

TEST(PdeRedistance, Weno5ConvergesFromAcceptedValues) {
  const auto sphere = unit_sphere(), torus = unit_torus();
  const Start frozen{.frozen = true};
  for (const auto& [shape, first, offsets] : {std::tuple{sphere.get(), 32, 3}, {sphere.get(), 64, 1}, {torus.get(), 64, 1}}) {
    const Outcome coarse = redistanced(kWeno, *shape, first, offsets, frozen, 1e-8), fine = redistanced(kWeno, *shape, 2 * first, offsets, frozen, 1e-8);
    RecordProperty(shape->name() + "_order_" + std::to_string(first), std::to_string(order(coarse.error, fine.error)));
    EXPECT_GE(order(coarse.error, fine.error), 2.9) << shape->name() << ": " << coarse.error << " -> " << fine.error;
  }
}

TEST(PdeRedistance, Weno5ConvergesAcrossALevelJumpThroughTheSurface) {
  const auto sphere = unit_sphere(), torus = unit_torus();
  for (const auto& [shape, first] : {std::pair{sphere.get(), 64}, {torus.get(), 64}}) {
    const Start start{.frozen = true, .jump = true};
    const Outcome coarse = redistanced(kWeno, *shape, first, 1, start, 1e-7), fine = redistanced(kWeno, *shape, 2 * first, 1, start, 1e-7);
    RecordProperty(shape->name() + "_order", std::to_string(order(coarse.error, fine.error)));
    EXPECT_GE(order(coarse.error, fine.error), 2) << shape->name() << ": " << coarse.error << " -> " << fine.error;
  }
}

TEST(PdeRedistance, FirstOrderConverges) {
  const auto sphere = unit_sphere();
  const Outcome coarse = redistanced(kFirst, *sphere, 32, 3), middle = redistanced(kFirst, *sphere, 64, 3), fine = redistanced(kFirst, *sphere, 128, 1);
  // In parts of a band that shrinks with the cells: one order more than at a fixed distance.
  EXPECT_GE(order(coarse.error, middle.error), 1.8);
  EXPECT_GE(order(middle.error, fine.error), 1.8);
  EXPECT_LE(fine.movement, 1e-2);
}

// All leaves store values, the far ones coarse, and all that is known is a band.
Ball<double> ball_in_a_whole_domain() {
  return analytic_ball<double>(14, {0.31, 0.77, 0.13}, 3);
}

TEST(PdeRedistance, WholeDomainsWithACoarseFarFieldBecomeSteady) {
  for (const RedistanceMethod method : {kFirst, kWeno}) {
    SCOPED_TRACE(name(method));
    auto [set, center] = ball_in_a_whole_domain();
    RedistanceOptions options;
    options.method = method;
    options.steady = 1e-4;
    const RedistanceResult result = redistance(set, options);
    RecordProperty(std::string(name(method)) + "_steps", result.steps);
    RecordProperty(std::string(name(method)) + "_residual", std::to_string(result.residual));
    EXPECT_TRUE(result.steady) << result.residual;
    double worst = 0;
    for_each_stored_node(set, [&](std::size_t leaf, std::size_t n, const Vec3& x) {
      const double distance = 14 - norm(x - center), cell = 1 << set.octree().level(leaf);
      if (distance < 7) worst = std::max(worst, std::abs(set.phi.block(leaf)[n] - distance) / cell);
    });
    RecordProperty(std::string(name(method)) + "_worst_cells", std::to_string(worst));
    EXPECT_LE(worst, method == kFirst ? 1.0 : 0.1);
  }
}

// First order is monotone: larger phi0 on the same surface gives nowhere less.
TEST(PdeRedistance, FirstOrderIsMonotone) {
  auto [low, center] = analytic_ball<double>(12, {0.3, 0.1, 0.7}, 4);
  auto high = low;
  Field<std::uint8_t> accepted(low.octree().size(), 0);
  std::mt19937 random(5);
  std::uniform_real_distribution<double> any(0, 1);
  for_each_stored_node(low, [&](std::size_t leaf, std::size_t n, const Vec3&) {
    double& phi = low.phi.block(leaf)[n];
    accepted.block(leaf)[n] = std::abs(phi) < 2;
    if (std::abs(phi) < 2) return;
    high.phi.block(leaf)[n] = phi + std::abs(phi) * 0.9 * any(random);
    if (phi < 0) high.phi.block(leaf)[n] = phi * (1 - 0.9 * any(random));
  });
  RedistanceOptions options;
  options.method = kFirst;
  options.accepted = &accepted;
  options.most_steps = 5;
  redistance(low, options);
  redistance(high, options);
  for (std::size_t i = 0; i < low.phi.values().size(); ++i) ASSERT_LE(low.phi.values()[i], high.phi.values()[i] + 1e-12);
}

template <class T>
LargeArray<T> run_with(int threads, RedistanceMethod method) {
  const ThreadLimit limit(threads);
  std::mt19937 random(3);
  const auto shape = unit_sphere();
  BasicLevelSet<T> set = level_set_of_shape<T>(placed_at_random(*shape, 16, 8, random), 4, [](const Vec3& p) { return p.x < 30 ? 0 : 1; });
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    if (set.phi.stores(leaf))
      for (std::size_t n = 0; n < kBlockNodes; ++n) set.phi.block(leaf)[n] *= static_cast<T>(1 + 0.5 * std::sin(0.3 * static_cast<double>(n)));
  RedistanceOptions options;
  options.method = method;
  options.reach = 4;
  options.steady = 1e-2;
  redistance(set, options);
  return set.phi.values();
}

TEST(PdeRedistance, SameBitsForAnyNumberOfThreads) {
  for (const RedistanceMethod method : {kFirst, kWeno}) {
    const auto one = run_with<double>(1, method), four = run_with<double>(4, method);
    EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(double)), 0);
    const auto floats = run_with<float>(1, method), more = run_with<float>(4, method);
    EXPECT_EQ(std::memcmp(floats.data(), more.data(), floats.size() * sizeof(float)), 0);
    double apart = 0;
    for (std::size_t i = 0; i < one.size(); ++i) apart = std::max(apart, std::abs(one[i] - static_cast<double>(floats[i])));
    RecordProperty(std::string(name(method)) + "_float_apart_cells", std::to_string(apart));
  }
}

// Whatever the field: numbers, their signs, their zeros.
template <class T, class Value>
void check_robust(RedistanceMethod method, int most_steps, Value&& value, const char* what) {
  SCOPED_TRACE(std::string(name(method)) + ", " + what);
  auto [set, center] = analytic_ball<T>(6, {0.2, 0.4, 0.6}, 3);
  for (T& phi : set.phi.values()) phi = static_cast<T>(value(static_cast<double>(phi)));
  const Field<T> before = set.phi;
  RedistanceOptions options;
  options.method = method;
  options.reach = 5;
  options.most_steps = most_steps;
  options.steady = 0.05;
  redistance(set, options);
  int wrong = 0;
  for (std::size_t i = 0; i < before.values().size(); ++i) {
    const T was = before.values()[i], is = set.phi.values()[i];
    wrong += !((was > 0) == (is > 0) && (was < 0) == (is < 0) && std::abs(is) <= 5 * (1 << 6));
  }
  EXPECT_EQ(wrong, 0);
}

TEST(PdeRedistance, AnyFieldKeepsItsSignsAndStaysFinite) {
  std::mt19937 random(11);
  std::uniform_real_distribution<double> any(-1, 1);
  const auto noise = [&](double) { return 3 * any(random); };
  const auto huge = [&](double) { return 1e12 * any(random); };
  const auto tiny = [&](double) { return 1e-12 * any(random); };
  const auto holes = [&](double phi) { return any(random) < -0.8 ? 0.0 : phi; };
  const auto lopsided = [&](double phi) { return phi > 0 ? 1e9 : -1e-9; };
  for (const RedistanceMethod method : {kFirst, kWeno}) {
    check_robust<double>(method, 0, noise, "noise");
    check_robust<float>(method, 9, noise, "noise, float");
    check_robust<float>(method, 9, huge, "huge, float");
    check_robust<double>(method, 9, tiny, "tiny");
    check_robust<double>(method, 9, holes, "holes");
    check_robust<float>(method, 9, lopsided, "lopsided, float");
  }
}

}  // namespace
}  // namespace burnish
