#include "burnish/levelset/redistance.h"

#include <gtest/gtest.h>

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

// How far the surface moved, in cells: the largest difference, at points of the true surface, of the tricubic interpolants of phi and of the
// exact distance. Both have |grad| = 1 there. The points are the feet of nodes within one cell.
double displacement(const PlacedShape& placed, const BasicLevelSet<double>& set, const Field<double>& exact) {
  const Octree& tree = set.octree();
  std::vector<double> worst(tree.size());
  parallel_for(
      tree.size(),
      [&](std::size_t leaf) {
        if (!set.phi.stores(leaf)) return;
        const double cell = 1 << tree.level(leaf);
        std::vector<double> now(4096), then(4096);
        bool gathered = false;
        for (int n = 0; n < static_cast<int>(kBlockNodes); n += 3) {
          if (std::abs(exact.block(leaf)[n]) >= cell) continue;
          if (!gathered) {
            gather_smooth(tree, set.phi, leaf, 4, HaloOrder::cubic, now.data());
            gather_smooth(tree, exact, leaf, 4, HaloOrder::cubic, then.data());
            gathered = true;
          }
          const Vec3 foot = placed.closest(to_vec(lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64))).foot;
          const Vec3 at = (foot - to_vec(lattice_node(tree, leaf, 0, 0, 0))) / cell;
          worst[leaf] = std::max(worst[leaf], std::abs(tricubic_value(now, at) - tricubic_value(then, at)) / cell);
        }
      },
      4);
  return *std::max_element(worst.begin(), worst.end());
}

constexpr double kBand = 5;

// Largest errors: near and band in parts of the shape's size, within one and four cells of the surface; the displacement in cells.
struct Errors {
  double near = 0, band = 0, moved = 0;
};

Errors worse(const Errors& a, const Errors& b) { return {std::max(a.near, b.near), std::max(a.band, b.band), std::max(a.moved, b.moved)}; }

// Errors once (0.1 + |x - x0|^2) distance, lengths in the shape's size and x0 on the surface, was redistanced.
Errors errors_of_scaled(const AnalyticShape& shape, int cells, std::mt19937& random, bool jump) {
  const double size = (cells / 2 - 9) / shape.radius();
  const PlacedShape placed = placed_at_random(shape, size, 8, random);
  BasicLevelSet<double> set = level_set_of_shape<double>(placed, kBand, jump ? jump_through(placed) : std::function<int(const Vec3&)>{});
  const Field<double> exact = set.phi;
  const Vec3 x0 = placed.closest(placed.center + random_rotation(random)[0] * (shape.radius() * size)).foot;
  for_each_stored(set, [&](const Vec3& p, double& phi, int) { phi *= 0.1 + squared_norm((p - x0) / size); });
  redistance(set);
  Errors errors;
  errors.moved = displacement(placed, set, exact);
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

void record(const std::string& name, const Errors& e) {
  testing::Test::RecordProperty(name + "_near", std::to_string(e.near * 1e9) + "e-9");
  testing::Test::RecordProperty(name + "_band", std::to_string(e.band * 1e9) + "e-9");
  testing::Test::RecordProperty(name + "_moved_cells", std::to_string(e.moved * 1e9) + "e-9");
  if (std::getenv("BURNISH_SHOW") != nullptr) std::printf("%s near %.3g band %.3g moved %.3g\n", name.c_str(), e.near, e.band, e.moved);
}

std::vector<Errors> errors_of_scaled(const AnalyticShape& shape, std::initializer_list<int> cells, bool jump) {
  std::mt19937 random(11);
  std::vector<Errors> result;
  for (const int n : cells) {
    Errors worst;
    for (int offset = 0; offset < (n > 200 ? 1 : 4); ++offset) worst = worse(worst, errors_of_scaled(shape, n, random, jump));
    record(shape.name() + "_" + std::to_string(n), worst);
    result.push_back(worst);
  }
  return result;
}

TEST(Redistance, BadlyScaledFieldsBecomeDistancesOfFourthOrder) {
  const auto sphere = unit_sphere(), torus = unit_torus(), ellipsoid = unit_ellipsoid();
  for (const AnalyticShape* shape : {sphere.get(), torus.get(), ellipsoid.get()}) {
    SCOPED_TRACE(shape->name());
    const std::vector<Errors> e = errors_of_scaled(*shape, {32, 64, 128, 256}, false);
    for (const Errors& each : e) EXPECT_TRUE(std::isfinite(each.near) && std::isfinite(each.band));
    EXPECT_GE(order(e[2].near, e[3].near), 4);
    EXPECT_GE(order(e[2].band, e[3].band), 3);
    EXPECT_LE(e[3].moved, 1e-3);
  }
}

TEST(Redistance, AcrossLevelJumpsToo) {
  const auto sphere = unit_sphere(), torus = unit_torus();
  for (const AnalyticShape* shape : {sphere.get(), torus.get()}) {
    SCOPED_TRACE(shape->name());
    const std::vector<Errors> e = errors_of_scaled(*shape, {64, 128, 256}, true);
    EXPECT_GE(order(e[1].near, e[2].near), 2);
    EXPECT_GE(order(e[1].band, e[2].band), 2);
  }
}

}  // namespace
}  // namespace burnish
