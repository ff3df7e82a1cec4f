#include "burnish/levelset/redistance.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <memory>
#include <numbers>
#include <random>
#include <string>

#include "burnish/core/parallel.h"
#include "burnish/levelset/volume.h"
#include "support/analytic_level_set.h"
#include "support/analytic_shapes.h"
#include "support/random_octree.h"

namespace burnish {
namespace {

using namespace test;

double order(double coarse, double fine) { return std::log2(coarse / fine); }

// Calls visit(position, value, level) with all nodes of leaves that store values.
template <class T, class Visit>
void for_each_stored(BasicLevelSet<T>& set, Visit&& visit) {
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    if (!set.phi.stores(leaf)) continue;
    T* phi = set.phi.block(leaf);
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
      visit(to_vec(lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64)), phi[n], set.octree().level(leaf));
  }
}

template <class T>
bool same_bits(const Field<T>& a, const Field<T>& b) {
  return a.values().size() == b.values().size() && std::memcmp(a.values().data(), b.values().data(), a.values().size() * sizeof(T)) == 0;
}

// The cubic polynomials through nodes -1, 0, 1, 2.
std::array<double, 4> cubic(double t) {
  return {-t * (t - 1) * (t - 2) / 6, (t + 1) * (t - 1) * (t - 2) / 2, -(t + 1) * t * (t - 2) / 2, (t + 1) * t * (t - 1) / 6};
}

// The tricubic interpolant of a block with a halo of four at a point in cells of the block.
double tricubic_value(const std::vector<double>& dense, const Vec3& p) {
  const std::array<int, 3> low{static_cast<int>(std::floor(p.x)), static_cast<int>(std::floor(p.y)), static_cast<int>(std::floor(p.z))};
  const std::array<double, 4> x = cubic(p.x - low[0]), y = cubic(p.y - low[1]), z = cubic(p.z - low[2]);
  double sum = 0;
  for (int c = 0; c < 4; ++c)
    for (int b = 0; b < 4; ++b)
      for (int a = 0; a < 4; ++a)
        sum += x[static_cast<std::size_t>(a)] * y[static_cast<std::size_t>(b)] * z[static_cast<std::size_t>(c)] *
               dense[static_cast<std::size_t>((low[0] + 3 + a) + 16 * ((low[1] + 3 + b) + 16 * (low[2] + 3 + c)))];
  return sum;
}

// How far redistancing moved the surface, in cells: the largest difference, at points of the true surface, of the tricubic interpolants of
// phi and of the exact distance. Both have |grad| = 1 there. The points are the feet of nodes within one cell.
double displacement(const PlacedShape& placed, const BasicLevelSet<double>& set, const Field<double>& exact) {
  const Octree& tree = set.octree();
  std::vector<double> worst(tree.size());
  parallel_for(
      tree.size(),
      [&](std::size_t leaf) {
        if (!set.phi.stores(leaf)) return;
        const double cell = 1 << tree.level(leaf);
        std::vector<double> now(4096), ideal(4096);
        bool gathered = false;
        for (int n = 0; n < static_cast<int>(kBlockNodes); n += 3) {
          if (std::abs(exact.block(leaf)[n]) >= cell) continue;
          if (!gathered) {
            gather_smooth(tree, set.phi, leaf, 4, HaloOrder::cubic, now.data());
            gather_smooth(tree, exact, leaf, 4, HaloOrder::cubic, ideal.data());
            gathered = true;
          }
          const Vec3 at = placed.closest(to_vec(lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64))).foot;
          const Vec3 foot = (at - to_vec(lattice_node(tree, leaf, 0, 0, 0))) / cell;
          worst[leaf] = std::max(worst[leaf], std::abs(tricubic_value(now, foot) - tricubic_value(ideal, foot)) / cell);
        }
      },
      4);
  return *std::max_element(worst.begin(), worst.end());
}

constexpr double kBand = 5;
// In which phi is smooth, so that all that counts are the methods: stencils reach 5.2 cells, of coarse leaves across level jumps as well.
constexpr double kSmoothBand = 6, kSmoothBandAtJumps = 12;

// Largest errors: near and band in parts of the shape's size, within one and four cells of the surface; the displacement in cells.
struct Errors {
  double near = 0, band = 0, moved = 0;
};

Errors worse(const Errors& a, const Errors& b) { return {std::max(a.near, b.near), std::max(a.band, b.band), std::max(a.moved, b.moved)}; }

// Errors once (0.1 + |x - x0|^2) distance, lengths in the shape's size and x0 on the surface, was redistanced.
Errors errors_of_scaled(const AnalyticShape& shape, int cells, std::mt19937& random, bool jump) {
  const double size = 0.36 * cells / shape.radius();
  const PlacedShape placed = placed_at_random(shape, size, jump ? 24 : 8, random);
  const double band = jump ? kSmoothBandAtJumps : kSmoothBand;
  BasicLevelSet<double> set = level_set_of_shape<double>(placed, band, jump ? jump_through(placed) : std::function<int(const Vec3&)>{});
  const Field<double> exact = set.phi;
  const Vec3 x0 = placed.closest(placed.center + random_rotation(random)[0] * (shape.radius() * size)).foot;
  for_each_stored(set, [&](const Vec3& p, double& phi, int) { phi *= 0.1 + squared_norm((p - x0) / size); });
  redistance(set, kBand);
  Errors errors{0, 0, displacement(placed, set, exact)};
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    const double cell = 1 << set.octree().level(leaf);
    for (std::size_t n = 0; set.phi.stores(leaf) && n < kBlockNodes; ++n) {
      const double d = exact.block(leaf)[n], error = std::abs(set.phi.block(leaf)[n] - d) / size;
      EXPECT_EQ(set.phi.block(leaf)[n] >= 0, d >= 0);
      if (std::abs(d) < cell) errors.near = std::max(errors.near, error);
      if (std::abs(d) < (kBand - 1) * cell && std::abs(d) < 0.5 * size) errors.band = std::max(errors.band, error);
    }
  }
  return errors;
}

// T3_closest_sphere_64_near and so on.
void record(const std::string& name, int cells, const Errors& e) {
  for (const auto& [what, value] : {std::pair{"near", e.near}, {"band", e.band}, {"moved", e.moved}})
    testing::Test::RecordProperty(fmt::format("T3_closest_{}_{}_{}", name, cells, what), fmt::format("{:.3e}", value));
}

std::vector<Errors> errors_of_scaled(const AnalyticShape& shape, std::initializer_list<int> cells, bool jump) {
  std::mt19937 random(11);
  std::vector<Errors> result;
  for (const int n : cells) {
    Errors worst;
    for (int offset = 0; offset < (n > 200 ? 1 : n > 100 ? 2 : 4); ++offset) worst = worse(worst, errors_of_scaled(shape, n, random, jump));
    record(shape.name() + (jump ? "-jump" : ""), n, worst);
    result.push_back(worst);
  }
  return result;
}

TEST(Redistance, BadlyScaledFieldsBecomeDistancesOfSixthOrder) {
  const auto sphere = unit_sphere(), torus = unit_torus(), ellipsoid = unit_ellipsoid();
  for (const AnalyticShape* shape : {sphere.get(), torus.get(), ellipsoid.get()}) {
    SCOPED_TRACE(shape->name());
    const std::vector<Errors> e = errors_of_scaled(*shape, {32, 64, 128, 256}, false);
    for (const Errors& each : e) EXPECT_LE(each.band, 0.15);  // of the size: no blow-up, not even two cells from the torus' axis
    EXPECT_GE(order(e[1].near, e[2].near), 5);
    EXPECT_GE(order(e[2].near, e[3].near), 5);
    EXPECT_GE(order(e[2].band, e[3].band), 5);
    if (shape != torus.get()) {
      EXPECT_LE(e[0].moved, 1e-4);  // the torus' tube has a radius of 3.3 cells there
    }
    EXPECT_LE(e[1].moved, 1e-3);
    EXPECT_LE(e[2].moved, 1e-5);
    EXPECT_LE(e[3].moved, 1e-6);
  }
}

TEST(Redistance, AcrossLevelJumpsToo) {
  const auto sphere = unit_sphere(), torus = unit_torus();
  const std::vector<Errors> ball = errors_of_scaled(*sphere, {64, 128, 256}, true), ring = errors_of_scaled(*torus, {128, 256}, true);
  EXPECT_GE(order(ball[0].near, ball[1].near), 5);
  EXPECT_GE(order(ball[1].near, ball[2].near), 5);
  EXPECT_GE(order(ball[1].band, ball[2].band), 5);
  EXPECT_LE(ball[0].moved, 1e-3);
  EXPECT_GE(order(ring[0].near, ring[1].near), 5);
  EXPECT_GE(order(ring[0].band, ring[1].band), 5);
  EXPECT_LE(ring[0].moved, 1e-3);
}

// A shape's level set in which every leaf stores values, from distances in a band only.
BasicLevelSet<double> dense_level_set(const PlacedShape& placed, bool jump) {
  const double band = jump ? kSmoothBandAtJumps : kSmoothBand;
  BasicLevelSet<double> set = level_set_of_shape<double>(placed, band, jump ? jump_through(placed) : std::function<int(const Vec3&)>{});
  set.phi.make_dense(set.octree().size());
  return set;
}

struct FarErrors {
  double worst = 0, rms = 0;  // in parts of the size
};

// At nodes farther than 0.3 sizes from the surface, inside not farther than 0.5.
FarErrors far_errors(const AnalyticShape& shape, int cells, RedistanceMethod method, bool jump, std::mt19937& random) {
  const double size = 0.16 * cells / shape.radius();
  const PlacedShape placed = placed_at_random(shape, size, cells / 4 + 6, random);
  BasicLevelSet<double> set = dense_level_set(placed, jump);
  redistance(set, {.method = method});
  FarErrors errors;
  double sum = 0, count = 0;
  for_each_stored(set, [&](const Vec3& p, double& phi, int) {
    const double d = placed.distance(p), error = std::abs(phi - d);
    if (d > 0.5 * size || std::abs(d) < 0.3 * size) return;
    errors.worst = std::max(errors.worst, error / size);
    sum += error * error;
    ++count;
  });
  errors.rms = std::sqrt(sum / count) / size;
  return errors;
}

FarErrors worst_far_errors(const AnalyticShape& shape, int cells, RedistanceMethod method, bool jump) {
  std::mt19937 random(5);
  FarErrors worst;
  for (int offset = 0; offset < (cells > 100 ? 1 : 3); ++offset) {
    const FarErrors e = far_errors(shape, cells, method, jump, random);
    worst = {std::max(worst.worst, e.worst), std::max(worst.rms, e.rms)};
  }
  const std::string label = std::string(name(method)) + "_" + shape.name() + (jump ? "_jump_" : "_") + std::to_string(cells);
  testing::Test::RecordProperty(label + "_worst", std::to_string(worst.worst * 1e9) + "e-9");
  testing::Test::RecordProperty(label + "_rms", std::to_string(worst.rms * 1e9) + "e-9");
  return worst;
}

TEST(Redistance, ClosestPointsAreOfHighOrderThroughTheDomain) {
  const auto sphere = unit_sphere(), ellipsoid = unit_ellipsoid();
  for (const RedistanceMethod method : {RedistanceMethod::closest, RedistanceMethod::fmm})
    for (const AnalyticShape* shape : {sphere.get(), ellipsoid.get()})
      for (const bool jump : {false, true}) {
        SCOPED_TRACE(std::string(name(method)) + " " + shape->name() + (jump ? " with a jump" : ""));
        const FarErrors coarse = worst_far_errors(*shape, 64, method, jump), fine = worst_far_errors(*shape, 128, method, jump);
        EXPECT_GE(order(coarse.worst, fine.worst), 5);
      }
}

// Again and again: what moves is far below a cell, in float too.
template <class T>
double drift_after(double radius, int times) {
  auto [set, center] = analytic_ball<T>(radius, {0.31, 0.77, 0.13}, kSmoothBand);
  const double before = enclosed_volume(set);
  for (int i = 0; i < times; ++i) redistance(set);
  return (enclosed_volume(set) - before) / (4 * std::numbers::pi * radius * radius);  // mean displacement, in cells
}

TEST(Redistance, RepeatedItLeavesTheSurfaceWhereItIs) {
  const double coarse = drift_after<double>(8, 10), fine = drift_after<double>(16, 10), single = drift_after<float>(16, 10);
  RecordProperty("cells_8", fmt::format("{:.2e}", coarse));
  RecordProperty("cells_16", fmt::format("{:.2e}", fine));
  EXPECT_LE(std::abs(coarse), 1e-5);
  EXPECT_LE(std::abs(fine), 1e-6);
  EXPECT_LE(std::abs(single), 1e-4);
  EXPECT_GE(order(std::abs(coarse / 8), std::abs(fine / 16)), 3);
}

TEST(Redistance, PlanesComeBackToRounding) {
  const Vec3 n = Vec3{0.36, 0.48, 0.8};
  auto distance = [=](const Vec3& p) { return dot(n, p - Vec3{32.2, 31.9, 32.4}); };
  BasicLevelSet<double> set = analytic_level_set<double>(3, kSmoothBand, distance);
  for_each_near_node(set, [&](const Vec3& p, double& phi) { phi = 0.7 * distance(p); });
  redistance(set, 4);
  double worst = 0;
  for_each_near_node(set, [&](const Vec3& p, double& phi) {
    const bool inner = std::min({p.x, p.y, p.z}) > 12 && std::max({p.x, p.y, p.z}) < 51;
    if (inner && std::abs(distance(p)) < 4) worst = std::max(worst, std::abs(phi - distance(p)));
  });
  RecordProperty("worst", std::to_string(worst * 1e15) + "e-15");
  EXPECT_LE(worst, 1e-12);
}

TEST(Redistance, ClampsToTheReachOfEachLevelAndKeepsSigns) {
  const auto torus = unit_torus();
  std::mt19937 random(2);
  const PlacedShape placed = placed_at_random(*torus, 12, 8, random);
  BasicLevelSet<float> set = level_set_of_shape<float>(placed, 5, jump_through(placed));
  for_each_stored(set, [](const Vec3& p, float& phi, int) { phi *= 1 + 0.2f * static_cast<float>(std::sin(p.x)); });
  const Field<float> before = set.phi;
  redistance(set, 3);
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    if (!set.phi.stores(leaf)) continue;
    for (std::size_t n = 0; n < kBlockNodes; ++n) {
      ASSERT_EQ(set.phi.block(leaf)[n] >= 0, before.block(leaf)[n] >= 0);
      ASSERT_LE(std::abs(set.phi.block(leaf)[n]), 3 * (1 << set.octree().level(leaf)));
    }
  }
}

// A square sheet between nodes: no sign changes, all that is known of it are accepted values.
TEST(Redistance, AcceptedValuesAreSourcesWithoutASignChange) {
  const auto distance = [](const Vec3& p) {
    const double x = std::max({20.3 - p.x, p.x - 44.6, 0.0}), y = std::max({21.1 - p.y, p.y - 43.2, 0.0});
    return -std::hypot(std::hypot(x, y), p.z - 31.37);
  };
  for (const RedistanceMethod method : {RedistanceMethod::closest, RedistanceMethod::fmm}) {
    SCOPED_TRACE(name(method));
    BasicLevelSet<double> set = level_set_of(Octree::build(3, all_blocks(3)), [&](const LatticeNode& n) { return std::max(distance(to_vec(n)), -3.5); });
    set.band = 3.5;
    Field<std::uint8_t> accepted = Field<std::uint8_t>::like(set.phi, 0, 0);
    for (std::size_t i = 0; i < set.phi.values().size(); ++i) accepted.values()[i] = set.phi.values()[i] > -3.5;
    redistance(set, {.method = method, .accepted = &accepted});
    double worst = 0;
    for_each_stored(set, [&](const Vec3& p, double& phi, int) { worst = std::max(worst, std::abs(phi - distance(p))); });
    RecordProperty(std::string(name(method)) + "_cells", fmt::format("{:.3f}", worst));
    EXPECT_LE(worst, 0.75);  // cells; without the sources some 27
  }
}

// Nothing to find: nothing may be invented, whatever memory held before.
TEST(Redistance, FieldsWithoutASurfaceKeepTheirSizes) {
  const Vec3 middle{32.2, 31.9, 32.4};
  BasicLevelSet<float> set = level_set_of<float>(Octree::build(3, {0, 511}), [&](const LatticeNode& n) { return norm(to_vec(n) - middle) + 1; });
  const Field<float> before = set.phi;
  for (const RedistanceMethod method : {RedistanceMethod::closest, RedistanceMethod::fmm}) {
    redistance(set, {.method = method});
    EXPECT_TRUE(same_bits(set.phi, before)) << name(method);
  }
}

TEST(Redistance, AcceptedNodesStay) {
  for (const RedistanceMethod method : {RedistanceMethod::closest, RedistanceMethod::fmm}) {
    auto [set, center] = analytic_ball<double>(10, {0.2, 0.4, 0.6}, 4);
    Field<std::uint8_t> accepted = Field<std::uint8_t>::like(set.phi, 0, 0);
    for (std::size_t i = 0; i < set.phi.values().size(); ++i) {
      if (std::abs(set.phi.values()[i]) < 1) accepted.values()[i] = 1;
      set.phi.values()[i] *= 1.25;
    }
    const Field<double> before = set.phi;
    redistance(set, {.method = method, .reach = 4, .accepted = &accepted});
    for (std::size_t i = 0; i < before.values().size(); ++i)
      if (accepted.values()[i] != 0) {
        ASSERT_EQ(set.phi.values()[i], before.values()[i]);
      }
  }
}

template <class T>
void expect_same_bits(RedistanceMethod method) {
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    const auto torus = unit_torus();
    std::mt19937 random(3);
    const PlacedShape placed = placed_at_random(*torus, 8, 8, random);
    BasicLevelSet<T> set = level_set_of_shape<T>(placed, 5, jump_through(placed));
    set.phi.make_dense(set.octree().size());
    for_each_stored(set, [](const Vec3& p, T& phi, int) { phi *= 1 + static_cast<T>(0.5 * std::sin(p.x + 2 * p.y)); });
    redistance(set, {.method = method});
    return set.phi;
  };
  EXPECT_TRUE(same_bits(run(1), run(4))) << name(method);
}

TEST(Redistance, SameBitsForAnyNumberOfThreads) {
  for (const RedistanceMethod method : {RedistanceMethod::closest, RedistanceMethod::fmm}) {
    expect_same_bits<float>(method);
    expect_same_bits<double>(method);
  }
}

// Edges and corners, crests and creases: the interpolant rounds them by less than a cell.
TEST(Redistance, KinksStayBounded) {
  const auto cube = [](const Vec3& p) {
    const Vec3 q{std::abs(p.x - 24.3) - 9, std::abs(p.y - 23.8) - 9, std::abs(p.z - 24.1) - 9};
    return -(norm(max(q, Vec3{})) + std::min(std::max({q.x, q.y, q.z}), 0.0));
  };
  // Two plates that cross: exact outside.
  const auto plates = [](const Vec3& p) { return std::max(2.1 - std::abs(p.x - 24.3), 2.1 - std::abs(0.6 * (p.x - 24) + 0.8 * (p.y - 23.8))); };
  for (const RedistanceMethod method : {RedistanceMethod::closest, RedistanceMethod::fmm}) {
    BasicLevelSet<double> set = analytic_level_set<double>(3, 5, cube);
    for_each_near_node(set, [](const Vec3& p, double& phi) { phi *= 1 + 0.5 * std::sin(p.x + p.y); });
    redistance(set, {.method = method, .reach = 5});
    double worst = 0;
    for_each_near_node(set, [&](const Vec3& p, double& phi) { worst = std::max(worst, std::abs(phi - std::clamp(cube(p), -5.0, 5.0))); });
    RecordProperty(std::string(name(method)) + "_cube", std::to_string(worst));
    EXPECT_LE(worst, 0.5);
    set = analytic_level_set<double>(3, 5, plates);
    redistance(set, {.method = method, .reach = 5});
    worst = 0;
    for_each_near_node(set, [&](const Vec3& p, double& phi) {
      EXPECT_LE(std::abs(phi), 5);
      if (plates(p) < 0 && std::min({p.x, p.y, p.z}) > 12 && std::max({p.x, p.y, p.z}) < 40)
        worst = std::max(worst, std::abs(phi - std::max(plates(p), -5.0)));
    });
    RecordProperty(std::string(name(method)) + "_plates", std::to_string(worst));
    EXPECT_LE(worst, 0.5);
  }
}

// Noise on any octree: finite, signs kept, and no node farther from the surface than along an edge that crosses it.
TEST(Redistance, NoiseGivesDistancesToo) {
  std::mt19937 random(17);
  std::uniform_real_distribution<double> any(-1, 1);
  for (int round = 0; round < 12; ++round) {
    SCOPED_TRACE(round);
    BasicLevelSet<float> set = level_set_of<float>(random_octree(random, 3, 40), [&](const LatticeNode&) { return any(random); });
    if (round % 3 == 1)
      for (float& v : set.phi.values()) v = v * v * v * 1e-12f;
    if (round % 3 == 2)
      for (float& v : set.phi.values()) v = v > 0.9f ? 1e15f : v > 0 ? 0.0f : -1e-30f;
    const Field<float> before = set.phi;
    redistance(set, {.method = round % 2 == 0 ? RedistanceMethod::closest : RedistanceMethod::fmm});
    for (std::size_t i = 0; i < before.values().size(); ++i) {
      ASSERT_TRUE(std::isfinite(set.phi.values()[i]));
      ASSERT_EQ(set.phi.values()[i] >= 0, before.values()[i] >= 0);
    }
    for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
      for (int n = 0; n < static_cast<int>(kBlockNodes) - 1; ++n) {
        if (n % 8 == 7) continue;
        const float p = before.block(leaf)[n], q = before.block(leaf)[n + 1];
        if ((p >= 0) != (q >= 0)) {
          ASSERT_LE(std::abs(set.phi.block(leaf)[n]), 1.9 * (1 << set.octree().level(leaf)));
        }
      }
  }
}

}  // namespace
}  // namespace burnish
