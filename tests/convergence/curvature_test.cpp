// Experiment T1: curvatures of analytic shapes, against exact ones at the exact feet of nodes with |phi| < h.
// With BURNISH_FULL_EXPERIMENTS=1: worst of 10 placements at R/h = 4 to 32 (64 where that is cheap); by default fewer.
#include "burnish/levelset/curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <map>

#include "support/analytic_shapes.h"
#include "support/level_sets.h"

namespace burnish {
namespace {

using namespace test;

constexpr std::size_t kSample = 2500;  // nodes per placement, evenly taken
constexpr double kBand = 8;            // cells; the stencils of order 6 reach 7.4

bool full_experiments() {
  const char* wanted = std::getenv("BURNISH_FULL_EXPERIMENTS");
  return wanted != nullptr && std::string(wanted) == "1";
}

// Errors of kappa = k1 + k2 over its rms; of k1 and k2, and of the Gaussian curvature, in units of 1/R and 1/R^2; of principal directions
// as angles where k1 - k2 > 0.3/R.
struct Errors {
  double l2 = 0, linf = 0, principal = 0, gaussian = 0, direction = 0, foot = 0;
  std::size_t unconverged = 0, lower_order = 0, points = 0;

  void include(const Errors& other) {
    for (double Errors::*e : {&Errors::l2, &Errors::linf, &Errors::principal, &Errors::gaussian, &Errors::direction, &Errors::foot})
      this->*e = std::max(this->*e, other.*e);
    unconverged += other.unconverged, lower_order += other.lower_order, points += other.points;
  }
};

// Nodes with |phi| < h that some leaf stores, h the leaf's cell.
template <class T>
std::vector<Vec3> sampled_near_nodes(const BasicLevelSet<T>& set) {
  std::vector<Vec3> all, sample;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
    if (!set.phi.stores(leaf)) continue;
    for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
      if (std::abs(set.phi.block(leaf)[n]) < (1 << set.octree().level(leaf)))
        all.push_back(to_vec(lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64)));
  }
  const std::size_t taken = std::min(kSample, all.size());
  for (std::size_t i = 0; i < taken; ++i) sample.push_back(all[i * all.size() / taken]);
  return sample;
}

Errors errors_of(const std::vector<FrontCurvature>& found, const std::vector<SurfacePoint>& exact, double size, int order) {
  Errors errors;
  errors.points = found.size();
  double squares = 0, kappa_squares = 0;
  for (std::size_t i = 0; i < found.size(); ++i) {
    const FrontCurvature& f = found[i];
    const SurfacePoint& e = exact[i];
    kappa_squares += e.mean_sum() * e.mean_sum();
    if (!f.converged) {
      ++errors.unconverged;
      continue;
    }
    errors.lower_order += f.order < order;
    const double error = std::abs(f.k1 + f.k2 - e.mean_sum());
    squares += error * error;
    errors.linf = std::max(errors.linf, error);
    errors.principal = std::max({errors.principal, size * std::abs(f.k1 - e.k1), size * std::abs(f.k2 - e.k2)});
    errors.gaussian = std::max(errors.gaussian, size * size * std::abs(f.gaussian() - e.k1 * e.k2));
    errors.foot = std::max(errors.foot, norm(f.foot - e.foot));
    if ((e.k1 - e.k2) * size > 0.3) errors.direction = std::max(errors.direction, std::asin(std::min(norm(cross(f.direction1, e.direction1)), 1.0)));
  }
  const double rms = std::sqrt(kappa_squares / static_cast<double>(found.size()));
  errors.l2 = std::sqrt(squares / static_cast<double>(found.size())) / rms;
  errors.linf /= rms;
  return errors;
}

void record(const std::string& name, double value) {
  std::array<char, 32> text;
  std::snprintf(text.data(), text.size(), "%.4e", value);
  ::testing::Test::RecordProperty(name, text.data());
}

// E.g. T1_sphere_4_8_Linf: shape, order, R/h.
void record(const std::string& experiment, int order, int size, const Errors& e) {
  const std::string name = experiment + "_" + std::to_string(order) + "_" + std::to_string(size) + "_";
  record(name + "L2", e.l2);
  record(name + "Linf", e.linf);
  record(name + "principal_Linf", e.principal);
  record(name + "gaussian_Linf", e.gaussian);
  record(name + "direction_Linf", e.direction);
  record(name + "foot_Linf", e.foot);
  record(name + "unconverged", static_cast<double>(e.unconverged));
  record(name + "lower_order", static_cast<double>(e.lower_order));
  record(name + "points", static_cast<double>(e.points));
}

using ByOrder = std::map<int, Errors>;

// Worst errors of all three orders over random placements.
template <class T>
ByOrder worst_of(const AnalyticShape& shape, int size, int placements, double band = kBand, bool jump = false) {
  ByOrder worst;
  std::mt19937 random(5);
  for (int i = 0; i < placements; ++i) {
    const PlacedShape placed = placed_at_random(shape, size, 2 * band + 4, random);
    const BasicLevelSet<T> set = level_set_of_shape<T>(placed, band, jump ? jump_through(placed) : std::function<int(const Vec3&)>{});
    const std::vector<Vec3> points = sampled_near_nodes(set);
    std::vector<SurfacePoint> exact;
    for (const Vec3& p : points) exact.push_back(placed.closest(p));
    for (const int order : {2, 4, 6}) {
      const auto found = front_curvature(set, std::span<const Vec3>(points), static_cast<CurvatureOrder>(order));
      worst[order].include(errors_of(found, exact, size, order));
    }
  }
  return worst;
}

// Placements by default, and whether a size is part of the full experiment only.
int placements_of(const std::string& shape, int size) {
  if (full_experiments()) return size == 64 && shape != "sphere" && shape != "ellipsoid" ? 0 : size == 64 ? 2 : 10;
  if (shape == "trefoil") return size == 8 || size == 16 ? 1 : 0;
  return size == 4 || size == 8 ? (shape == "sphere" ? 10 : 4) : size == 16 ? 2 : size == 32 ? 1 : 0;
}

// Errors by R/h.
std::map<int, ByOrder> table_of(const AnalyticShape& shape) {
  std::map<int, ByOrder> table;
  for (const int size : {4, 8, 16, 32, 64}) {
    const int placements = placements_of(shape.name(), size);
    if (placements == 0) continue;
    table[size] = worst_of<double>(shape, size, placements);
    for (const auto& [order, errors] : table[size]) record("T1_" + shape.name(), order, size, errors);
  }
  return table;
}

// Observed order per halving of h, over the sizes from 8 to 32. The trefoil's strands are so near to each other that wide stencils at R/h = 8 see the
// kink between them: orders 4 and 6 there from 16 to 32, or, where 32 is too much, from 8 to 16, which flatters.
double observed(const AnalyticShape& shape, const std::map<int, ByOrder>& table, int order, double Errors::*error) {
  const int last = table.contains(32) ? 32 : 16, first = shape.name() == "trefoil" && order > 2 ? last / 2 : 8;
  return std::log2(table.at(first).at(order).*error / (table.at(last).at(order).*error)) / std::log2(last / first);
}

void expect_orders(const AnalyticShape& shape, const std::map<int, ByOrder>& table, double fourth, double sixth) {
  SCOPED_TRACE(shape.name());
  const std::map<int, double> least{{2, 1.9}, {4, fourth}, {6, sixth}};
  for (const auto& [order, bar] : least) {
    SCOPED_TRACE("order " + std::to_string(order));
    for (const auto& [name, error] : {std::pair{"kappa", &Errors::linf}, {"principal", &Errors::principal}, {"gaussian", &Errors::gaussian}}) {
      const double found = observed(shape, table, order, error);
      record("T1_" + shape.name() + "_" + std::to_string(order) + "_order_" + name, found);
      EXPECT_GE(found, bar) << name;
    }
    if (shape.name() != "sphere") {
      EXPECT_GE(observed(shape, table, order, &Errors::direction), 1.9);
    }
  }
  for (const auto& [size, by_order] : table)
    for (const auto& [order, e] : by_order) {
      EXPECT_EQ(e.unconverged, 0u) << size << ' ' << order;
      if (size >= 8 && (size > 8 || shape.name() != "trefoil")) {
        EXPECT_EQ(e.lower_order, 0u) << size << ' ' << order;
      }
    }
}

TEST(FrontCurvatureT1, Sphere) {
  const auto shape = unit_sphere();
  const auto table = table_of(*shape);
  expect_orders(*shape, table, 3.7, 5.5);
  EXPECT_LE(table.at(8).at(4).l2, 4e-4);
  EXPECT_LE(table.at(8).at(4).linf, 1e-3);
  EXPECT_LE(table.at(8).at(2).linf, 5.5e-3);
}

TEST(FrontCurvatureT1, Torus) {
  const auto shape = unit_torus();
  expect_orders(*shape, table_of(*shape), 3.5, 5);
}

TEST(FrontCurvatureT1, Ellipsoid) {
  const auto shape = unit_ellipsoid();
  expect_orders(*shape, table_of(*shape), 3.5, 5);
}

TEST(FrontCurvatureT1, Trefoil) {
  const auto shape = unit_trefoil();
  expect_orders(*shape, table_of(*shape), 2, 2);
}

// Values are rounded at 2^-24 of up to `kBand` cells; second differences are of size 1/R: a relative error of about 1e-7 R at best.
TEST(FrontCurvatureT1, SinglePrecisionHasAFloor) {
  const auto shape = unit_sphere();
  for (const int size : {8, 16, 32, 64}) {
    const int placements = full_experiments() ? size == 64 ? 2 : 10 : 1;
    const ByOrder in_float = worst_of<float>(*shape, size, placements), in_double = worst_of<double>(*shape, size, placements);
    for (const auto& [order, e] : in_float) {
      record("T1_float_sphere", order, size, e);
      EXPECT_LE(e.linf, in_double.at(order).linf * 1.05 + 1.5e-6 * size) << order << ' ' << size;
      EXPECT_LE(e.l2, in_double.at(order).l2 * 1.05 + 3e-7 * size) << order << ' ' << size;
      EXPECT_EQ(e.unconverged, 0u);
    }
  }
}

// Where levels meet on the surface; sizes are in finest cells, half of them in the cells of the coarser side.
TEST(FrontCurvatureT1, LevelJumpsThroughTheSurface) {
  for (const auto& shape : {unit_sphere(), unit_torus()}) {
    SCOPED_TRACE(shape->name());
    std::map<int, ByOrder> table;
    for (const int size : {16, 32, 64}) {
      if (size == 64 && shape->name() != "sphere" && !full_experiments()) continue;
      table[size] = worst_of<double>(*shape, size, full_experiments() ? 4 : 1, 12, true);
      for (const auto& [order, e] : table[size]) {
        record("T1_jump_" + shape->name(), order, size, e);
        EXPECT_EQ(e.unconverged, 0u) << order << ' ' << size;
        if (order <= 4) {
          EXPECT_EQ(e.lower_order, 0u) << order << ' ' << size;
        }
      }
    }
    const int last = table.contains(64) ? 64 : 32;
    for (const int order : {2, 4, 6})
      EXPECT_GE(std::log2(table[16][order].linf / table[last][order].linf) / std::log2(last / 16.0), order == 2 ? 1.9 : 2) << order;
  }
}

// What a band for levels without jumps costs beside them: a lower order there, nothing elsewhere.
TEST(FrontCurvatureT1, NarrowBandsLowerTheOrderAtLevelJumps) {
  const auto shape = unit_sphere();
  const ByOrder found = worst_of<double>(*shape, 32, 1, 7, true);
  record("T1_narrow_sphere", 4, 32, found.at(4));
  EXPECT_EQ(found.at(4).unconverged, 0u);
  EXPECT_GT(found.at(4).lower_order, 0u);
  EXPECT_LT(found.at(4).lower_order, found.at(4).points / 3);
}

// The curvature of level sets through nodes is off by phi/R, of first order, however good the differences are.
TEST(NodalCurvatureT1, IsOfFirstOrder) {
  const auto shape = unit_sphere();
  for (const int order : {2, 4}) {
    std::map<int, double> surface, own;
    for (const int size : {8, 16, 32}) {
      std::mt19937 random(6);
      const PlacedShape placed = placed_at_random(*shape, size, 10, random);
      const BasicLevelSet<double> set = level_set_of_shape<double>(placed, 5);
      const Field<double> kappa = nodal_curvature(set, static_cast<CurvatureOrder>(order));
      double squares = 0;
      std::size_t count = 0;
      for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
        for (std::size_t n = 0; set.phi.stores(leaf) && n < kBlockNodes; ++n) {
          const double phi = set.phi.block(leaf)[n], k = kappa.block(leaf)[n];
          if (std::abs(phi) >= 5 * (1 << set.octree().level(leaf))) {
            EXPECT_EQ(k, 0);
          }
          if (!(std::abs(phi) < 1)) continue;
          surface[size] = std::max(surface[size], std::abs(k * size / 2 - 1));
          own[size] = std::max(own[size], std::abs(k * (size - phi) / 2 - 1));
          squares += (k * size / 2 - 1) * (k * size / 2 - 1), ++count;
        }
      const std::string name = "T1_nodal_sphere_" + std::to_string(order) + "_" + std::to_string(size);
      record(name + "_L2", std::sqrt(squares / static_cast<double>(count)));
      record(name + "_Linf", surface[size]);
      record(name + "_own_level_Linf", own[size]);
    }
    EXPECT_NEAR(std::log2(surface[8] / surface[32]) / 2, 1, 0.2);
    EXPECT_GE(std::log2(own[8] / own[32]) / 2, order == 2 ? 1.9 : 3.7);
  }
}

// Stencils and fits share no code: both are right, or wrong in the same way by chance.
TEST(QuadricCurvatureT1, AgreesWithTheStencils) {
  for (const auto& shape : analytic_shapes()) {
    if (shape->name() == "trefoil" && !full_experiments()) continue;
    SCOPED_TRACE(shape->name());
    std::map<int, Errors> errors;
    const int first = shape->name() == "trefoil" ? 16 : 8;  // at 8 stencils see the kink between its strands
    for (const int size : {first, 2 * first}) {
      std::mt19937 random(8);
      const PlacedShape placed = placed_at_random(*shape, size, 12, random);
      const BasicLevelSet<double> set = level_set_of_shape<double>(placed, kBand);
      std::vector<Vec3> points = sampled_near_nodes(set);
      points.resize(std::min<std::size_t>(points.size(), 1200));
      std::vector<SurfacePoint> exact;
      for (const Vec3& p : points) exact.push_back(placed.closest(p));
      const auto fits = quadric_curvature(set, std::span<const Vec3>(points));
      const auto stencils = front_curvature(set, std::span<const Vec3>(points), CurvatureOrder::sixth);
      errors[size] = errors_of(fits, exact, size, 2);
      record("T1_quadric_" + shape->name(), 2, size, errors[size]);
      EXPECT_EQ(errors[size].unconverged, 0u);
      for (std::size_t i = 0; i < fits.size(); ++i) {
        EXPECT_NEAR(fits[i].k1 * size, stencils[i].k1 * size, 0.012 * 64 / (size * size));
        EXPECT_NEAR(fits[i].k2 * size, stencils[i].k2 * size, 0.012 * 64 / (size * size));
        EXPECT_LE(norm(fits[i].foot - stencils[i].foot), 0.02 * 64 / (size * size));
      }
    }
    EXPECT_GE(std::log2(errors[first].principal / errors[2 * first].principal), 1.7);
  }
}

}  // namespace
}  // namespace burnish
