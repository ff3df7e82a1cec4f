#include "burnish/levelset/redistance.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <numbers>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/levelset/volume.h"
#include "support/analytic_level_set.h"

namespace burnish {
namespace {

using namespace test;

// Largest errors after redistancing, in parts of the shape's size.
struct Errors {
  double near = 0;       // nodes within one cell of the surface
  double band = 0;       // all nodes within the band but its last cell
  double surface = 0;    // distance of the zero crossings of lattice edges from the true surface
};

// `distance` (positive inside) times 1 + 0.3 sin of what varies over the shape, redistanced once.
template <class T, class Distance>
Errors redistanced(int depth, double size, double band, const Distance& distance) {
  const auto stretch = [&](const Vec3& p) {
    return 1 + 0.3 * std::sin(3 * p.x / size + 0.5) * std::cos(2 * p.y / size) + 0.1 * std::sin(2 * p.z / size);
  };
  BasicLevelSet<T> set = analytic_level_set<T>(depth, band, distance);
  for_each_near_node(set, [&](const Vec3& p, T& phi) { phi = static_cast<T>(distance(p) * stretch(p)); });
  redistance(set);
  Errors errors;
  for_each_near_node(set, [&](const Vec3& p, T& phi) {
    const double d = distance(p), error = std::abs(phi - d) / size;
    if (std::abs(d) < 1) errors.near = std::max(errors.near, error);
    if (std::abs(d) < band - 1) errors.band = std::max(errors.band, error);
  });
  for (const Vec3& x : edge_crossings(set)) errors.surface = std::max(errors.surface, std::abs(distance(x)) / size);
  return errors;
}

double order(double coarse, double fine) { return std::log2(coarse / fine); }

Errors worst_ball(double radius, int offsets) {
  std::mt19937 random(4);
  Errors worst;
  for (int i = 0; i < offsets; ++i) {
    int depth = 0;
    while (8 << depth < 2 * radius + 30) ++depth;
    const double middle = (8 << depth) / 2.0;
    const Vec3 center = Vec3{middle, middle, middle} + random_offset(random);
    const Errors e = redistanced<double>(depth, radius, 4, [=](const Vec3& p) { return radius - norm(p - center); });
    worst = {std::max(worst.near, e.near), std::max(worst.band, e.band), std::max(worst.surface, e.surface)};
  }
  return worst;
}

TEST(Redistance, BallsConvergeWithSecondOrderBesideTheSurface) {
  const Errors e8 = worst_ball(8, 5), e16 = worst_ball(16, 5), e32 = worst_ball(32, 2);
  for (const auto& [name, value] : {std::pair{"near_32", e32.near}, {"band_32", e32.band}, {"surface_32", e32.surface},
                                    {"order_near", order(e16.near, e32.near)}})
    RecordProperty(name, std::to_string(value));
  EXPECT_GE(order(e8.near, e16.near), 2) << e8.near << " -> " << e16.near;
  EXPECT_GE(order(e16.near, e32.near), 2) << e16.near << " -> " << e32.near;
  // Farther out a node has a neighbour's closest point, beside its own: in cells the error stays what it is.
  EXPECT_LE(e8.band * 8, 0.25);
  EXPECT_LE(e16.band * 16, 0.2);
  EXPECT_LE(e32.band * 32, 0.2);
  // In cells: phi at the surface's nodes, and by how much edges' crossings are off (which are linear: h^2 kappa / 8).
  EXPECT_LE(e16.near * 16, 1e-3);
  EXPECT_LE(e32.near * 32, 1e-4);
  EXPECT_LE(e16.surface * 16, 2.5e-2);
}

TEST(Redistance, ToriToo) {
  const auto torus_errors = [](double radius, int depth) {
    const double middle = (8 << depth) / 2.0;
    const Vec3 center{middle + 0.3, middle + 0.1, middle - 0.2};
    return redistanced<double>(depth, radius, 4, [=](const Vec3& p) {
      const Vec3 q = p - center;
      return 0.5 * radius - std::hypot(std::hypot(q.x, q.y) - radius, q.z);
    });
  };
  const Errors coarse = torus_errors(16, 4), fine = torus_errors(32, 4);
  RecordProperty("order_near", std::to_string(order(coarse.near, fine.near)));
  EXPECT_GE(order(coarse.near, fine.near), 2) << coarse.near << " -> " << fine.near;
  EXPECT_LE(fine.band * 32, 0.2);
}

// Again and again: what moves is far below a cell, in float too.
template <class T>
double drift_after(double radius, int times) {
  auto [set, center] = analytic_ball<T>(radius, {0.31, 0.77, 0.13}, 4);
  const double before = enclosed_volume(set);
  for (int i = 0; i < times; ++i) redistance(set);
  return (enclosed_volume(set) - before) / (4 * std::numbers::pi * radius * radius);  // mean displacement, in cells
}

TEST(Redistance, RepeatedItLeavesTheSurfaceWhereItIs) {
  const double coarse = drift_after<double>(8, 10), fine = drift_after<double>(16, 10);
  RecordProperty("cells_8", std::to_string(coarse));
  RecordProperty("cells_16", std::to_string(fine));
  EXPECT_LE(std::abs(fine), 2e-3);
  EXPECT_LE(std::abs(drift_after<float>(16, 10)), 2e-3);
  EXPECT_GE(order(std::abs(coarse / 8), std::abs(fine / 16)), 1.8);
}

TEST(Redistance, PlanesComeBack) {
  const Vec3 n = Vec3{0.36, 0.48, 0.8};
  auto distance = [=](const Vec3& p) { return dot(n, p - Vec3{32.2, 31.9, 32.4}); };
  BasicLevelSet<double> set = analytic_level_set<double>(3, 4, distance);
  for_each_near_node(set, [&](const Vec3& p, double& phi) { phi = 0.7 * distance(p); });
  redistance(set);
  double worst_near = 0, worst_far = 0;
  for_each_near_node(set, [&](const Vec3& p, double& phi) {
    const bool inner = std::min({p.x, p.y, p.z}) > 12 && std::max({p.x, p.y, p.z}) < 51;
    double& worst = std::abs(distance(p)) < 1 ? worst_near : worst_far;
    if (inner && std::abs(distance(p)) < 4) worst = std::max(worst, std::abs(phi - distance(p)));
  });
  EXPECT_LE(worst_near, 1e-6);
  EXPECT_LE(worst_far, 0.1);
}

TEST(Redistance, ClampsToTheBandAndKeepsSigns) {
  auto [set, center] = analytic_ball<float>(10, {0.2, 0.4, 0.6}, 3);
  for_each_near_node(set, [](const Vec3& p, float& phi) { phi *= 1 + 0.2f * static_cast<float>(std::sin(p.x)); });
  const Field<float> before = set.phi;
  redistance(set);
  for (std::size_t i = 0; i < before.values().size(); ++i) {
    ASSERT_EQ(set.phi.values()[i] >= 0, before.values()[i] >= 0);
    ASSERT_LE(std::abs(set.phi.values()[i]), 3);
  }
}

TEST(Redistance, SameBitsForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    auto ball = analytic_ball<float>(20, {0.2, 0.4, 0.6}, 4);
    for_each_near_node(ball.set, [](const Vec3& p, float& phi) { phi *= 1 + 0.2f * static_cast<float>(std::sin(p.x)); });
    redistance(ball.set);
    return ball.set.phi.values();
  };
  const LargeArray<float> one = run(1), four = run(4);
  EXPECT_EQ(std::memcmp(one.data(), four.data(), one.size() * sizeof(float)), 0);
}

}  // namespace
}  // namespace burnish
