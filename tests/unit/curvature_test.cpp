#include "burnish/levelset/curvature.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/surface/quadric_fit.h"
#include "support/level_sets.h"

namespace burnish {
namespace {

using namespace test;

// phi = value at all nodes of a domain of 64^3 cells.
template <class T = double, class Value>
BasicLevelSet<T> uniform_level_set(double band, Value&& value) {
  auto set = level_set_of<T>(Octree::build(3, all_blocks(3)), [&](const LatticeNode& n) { return std::clamp<double>(value(to_vec(n)), -band, band); });
  set.band = band;
  return set;
}

constexpr Vec3 kCenter{31.2, 32.7, 31.9};
double ball(const Vec3& p) { return 14 - norm(p - kCenter); }

std::vector<Vec3> points_around(double radius, int count) {
  std::mt19937 random(3);
  std::normal_distribution<double> any;
  std::uniform_real_distribution<double> beside(-1, 1);
  std::vector<Vec3> points;
  for (int i = 0; i < count; ++i) {
    const Vec3 d{any(random), any(random), any(random)};
    points.push_back(kCenter + d * ((radius + beside(random)) / norm(d)));
  }
  return points;
}

template <class T>
std::vector<FrontCurvature> curvatures(const BasicLevelSet<T>& set, const std::vector<Vec3>& points, CurvatureOrder order) {
  return front_curvature(set, std::span<const Vec3>(points), order);
}

TEST(FrontCurvature, PlanesHaveNone) {
  const Vec3 n{2.0 / 3, -1.0 / 3, 2.0 / 3};
  const auto set = uniform_level_set(8, [&](const Vec3& p) { return -dot(n, p - kCenter); });
  for (const CurvatureOrder order : {CurvatureOrder::second, CurvatureOrder::fourth, CurvatureOrder::sixth})
    for (const FrontCurvature& f : curvatures(set, {kCenter, kCenter + n * 0.9, kCenter + Vec3{3.1, 4.2, -0.8}}, order)) {
      ASSERT_TRUE(f.converged);
      EXPECT_EQ(f.order, static_cast<int>(order));
      EXPECT_NEAR(f.k1, 0, 1e-12);
      EXPECT_NEAR(f.k2, 0, 1e-12);
      EXPECT_NEAR(norm(f.normal - n), 0, 1e-12);
      EXPECT_NEAR(dot(n, f.foot - kCenter), 0, 1e-12);
    }
}

TEST(FrontCurvature, IsPositiveWhereTheSolidIsConvexAndNegativeInHollows) {
  const auto points = points_around(14, 200);
  for (const double sign : {1.0, -1.0}) {
    const auto set = uniform_level_set(8, [&](const Vec3& p) { return sign * ball(p); });
    for (const FrontCurvature& f : curvatures(set, points, CurvatureOrder::fourth)) {
      ASSERT_TRUE(f.converged);
      EXPECT_NEAR(f.k1 * 14, sign, 1e-4);
      EXPECT_NEAR(f.k2 * 14, sign, 1e-4);
      EXPECT_GE(f.k1, f.k2);
      EXPECT_NEAR(dot(f.normal, f.foot - kCenter), sign * 14, 1e-5);
    }
  }
}

TEST(FrontCurvature, FramesAreOrthonormalAtUmbilicsToo) {
  const auto set = uniform_level_set(8, ball);
  for (const FrontCurvature& f : curvatures(set, points_around(14, 200), CurvatureOrder::sixth)) {
    EXPECT_NEAR(norm(f.normal), 1, 1e-14);
    EXPECT_NEAR(norm(f.direction1), 1, 1e-14);
    EXPECT_NEAR(norm(cross(f.direction1, f.direction2) - f.normal), 0, 1e-14);
    EXPECT_LE(f.k1 - f.k2, 1e-5);
  }
}

// phi times a positive function has the same surface: nothing else may count. [T-CURV-2]
TEST(FrontCurvature, PhiNeedNotBeADistance) {
  const auto stretch = [](const Vec3& p) { return 1 + 0.15 * std::sin(p.x / 9 + 0.5) * std::cos(p.y / 11); };
  const auto set = uniform_level_set(12, [&](const Vec3& p) { return ball(p) * stretch(p); });
  for (const auto& [order, bar] : {std::pair{CurvatureOrder::second, 5e-3}, {CurvatureOrder::fourth, 1.5e-4}, {CurvatureOrder::sixth, 1e-5}})
    for (const FrontCurvature& f : curvatures(set, points_around(14, 300), order)) {
      ASSERT_TRUE(f.converged);
      EXPECT_NEAR(f.k1 * 14, 1, bar);
      EXPECT_NEAR(f.k2 * 14, 1, bar);
      EXPECT_NEAR(norm(f.foot - kCenter), 14, 1e-3);
    }
}

TEST(FrontCurvature, PrincipalDirectionsOfACylinder) {
  const Vec3 axis{0.48, 0.6, 0.64};
  const auto off_axis = [&](const Vec3& p) { return (p - kCenter) - axis * dot(p - kCenter, axis); };
  const auto set = uniform_level_set(8, [&](const Vec3& p) { return 10 - norm(off_axis(p)); });
  const Vec3 across = cross(axis, Vec3{1, 0, 0});
  std::vector<Vec3> points;
  for (int i = 0; i < 40; ++i) points.push_back(kCenter + axis * (0.2 * i - 4) + (across * std::cos(i) + cross(axis, across) * std::sin(i)) * (10.5 / norm(across)));
  for (const FrontCurvature& f : curvatures(set, points, CurvatureOrder::sixth)) {
    ASSERT_TRUE(f.converged);
    EXPECT_NEAR(f.k1, 0.1, 1e-6);
    EXPECT_NEAR(f.k2, 0, 1e-6);
    EXPECT_NEAR(std::abs(dot(f.direction2, axis)), 1, 1e-9);
    EXPECT_NEAR(f.mean(), 0.05, 1e-6);
    EXPECT_NEAR(f.gaussian(), 0, 1e-7);
  }
}

TEST(FrontCurvature, HasNoAnswerWhereThereIsNone) {
  const auto set = uniform_level_set(8, ball);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  // Too far, the middle, outside the domain, no point at all.
  for (const FrontCurvature& f : curvatures(set, {kCenter + Vec3{16.2, 0, 0}, kCenter + Vec3{11, 0, 0}, kCenter, {-1, 3, 3}, {64, 3, 3}, {nan, 3, 3}, {1e300, 0, 0}}, CurvatureOrder::fourth))
    EXPECT_FALSE(f.converged);
  EXPECT_TRUE(front_curvature(set, std::span<const Vec3>(), CurvatureOrder::fourth).empty());
}

TEST(FrontCurvature, KinksHaveNoAnswer) {
  const auto set = uniform_level_set(8, [](const Vec3& p) {
    const Vec3 d{12.3 - std::abs(p.x - kCenter.x), 12.3 - std::abs(p.y - kCenter.y), 12.3 - std::abs(p.z - kCenter.z)};
    const Vec3 out{std::max(-d.x, 0.0), std::max(-d.y, 0.0), std::max(-d.z, 0.0)};
    const double least = std::min({d.x, d.y, d.z});
    return least > 0 ? least : -norm(out);
  });
  for (const CurvatureOrder order : {CurvatureOrder::second, CurvatureOrder::fourth, CurvatureOrder::sixth}) {
    const auto found = curvatures(set, {kCenter + Vec3{12.3, 12.3, 12.3}, kCenter + Vec3{12, 2, 3}}, order);
    EXPECT_FALSE(found[0].converged);
    ASSERT_TRUE(found[1].converged);
    EXPECT_NEAR(found[1].k1, 0, 1e-12);
  }
}

// Narrow bands: the widest stencil that meets no clamped value is used, down to none.
TEST(FrontCurvature, FallsBackWhereStencilsMeetClampedValues) {
  const auto points = points_around(14, 300);
  for (const auto& [band, least, most] : {std::tuple{curvature_band(CurvatureOrder::sixth), 6, 6}, {curvature_band(CurvatureOrder::fourth), 4, 6},
                                          {curvature_band(CurvatureOrder::second), 2, 4}}) {
    SCOPED_TRACE(band);
    const auto set = uniform_level_set(band, ball);
    for (const FrontCurvature& f : curvatures(set, points, CurvatureOrder::sixth)) {
      ASSERT_TRUE(f.converged);
      EXPECT_GE(f.order, least);
      EXPECT_LE(f.order, most);
      EXPECT_NEAR(f.k1 * 14, 1, f.order == 2 ? 3e-3 : 1e-4);
    }
  }
  // Four nodes in a row span three cells, so one is at least 1.5 cells away.
  std::size_t converged = 0;
  for (const FrontCurvature& f : curvatures(uniform_level_set(1.4, ball), points, CurvatureOrder::sixth)) converged += f.converged;
  EXPECT_EQ(converged, 0u);
}

// Two balls 3.6 cells apart, and between them a kink of phi at x = 31.2: nodes 28 to 31 see nothing of it, 27 to 32 and 26 to 33 do. [T-CURV-7]
TEST(FrontCurvature, FallsBackBesideKinks) {
  const Vec3 apart{(14 + 3.6 + 14) / 2, 0, 0};
  const auto set = uniform_level_set(12, [&](const Vec3& p) { return std::max(ball(p + apart), ball(p - apart)); });
  const Vec3 between = kCenter - Vec3{1.8, 0, 0}, beside = kCenter - apart + Vec3{-2, 13.9, 0};
  for (const CurvatureOrder order : {CurvatureOrder::second, CurvatureOrder::fourth, CurvatureOrder::sixth}) {
    const auto found = curvatures(set, {between, beside}, order);
    ASSERT_TRUE(found[0].converged && found[1].converged);
    EXPECT_EQ(found[0].order, 2);
    EXPECT_NEAR(found[0].k1 * 14, 1, 0.01);
    EXPECT_NEAR(found[0].k2 * 14, 1, 0.01);
    EXPECT_EQ(found[1].order, static_cast<int>(order));
  }
}

TEST(FrontCurvature, FallsBackAtWalls) {
  const auto set = uniform_level_set(8, [](const Vec3& p) { return 20.3 - p.z; });
  std::vector<Vec3> points;
  for (int i = 0; i < 64; ++i) points.push_back({i + 0.25, 30, 20});
  const auto found = curvatures(set, points, CurvatureOrder::sixth);
  for (int i = 0; i < 64; ++i) {
    const FrontCurvature& f = found[static_cast<std::size_t>(i)];
    const int room = std::min(i, 62 - i);  // nodes beyond those of the cell
    EXPECT_EQ(f.converged, room >= 1) << i;
    if (f.converged) {
      EXPECT_EQ(f.order, room >= 3 ? 6 : 2 * room) << i;
    }
  }
}

bool same(const FrontCurvature& a, const FrontCurvature& b) {
  return a.foot == b.foot && a.normal == b.normal && a.k1 == b.k1 && a.k2 == b.k2 && a.direction1 == b.direction1 && a.direction2 == b.direction2 &&
         a.order == b.order && a.converged == b.converged;
}

TEST(FrontCurvature, SameBitsForAnyNumberOfThreadsAndAnyOrderOfPoints) {
  const auto set = uniform_level_set<float>(8, ball);
  auto points = points_around(14, 5000);
  const auto run = [&](int threads) {
    const ThreadLimit limit(threads);
    return std::tuple{curvatures(set, points, CurvatureOrder::fourth), nodal_curvature(set, CurvatureOrder::fourth),
                      quadric_curvature(set, std::span<const Vec3>(points))};
  };
  const auto [front1, nodal1, quadric1] = run(1);
  const auto [front4, nodal4, quadric4] = run(4);
  for (std::size_t i = 0; i < points.size(); ++i) {
    EXPECT_TRUE(same(front1[i], front4[i]));
    EXPECT_TRUE(same(quadric1[i], quadric4[i]));
  }
  EXPECT_TRUE(std::equal(nodal1.values().begin(), nodal1.values().end(), nodal4.values().begin()));
  std::reverse(points.begin(), points.end());
  auto reversed = curvatures(set, points, CurvatureOrder::fourth);
  std::reverse(reversed.begin(), reversed.end());
  for (std::size_t i = 0; i < points.size(); ++i) EXPECT_TRUE(same(front1[i], reversed[i]));
}

TEST(NodalCurvature, IsThatOfTheLevelSetThroughTheNode) {
  const auto set = uniform_level_set(6, ball);
  for (const auto& [order, bar] : {std::pair{CurvatureOrder::second, 5e-3}, {CurvatureOrder::fourth, 4e-4}}) {
    const Field<double> kappa = nodal_curvature(set, order);
    for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
      for (std::size_t n = 0; n < kBlockNodes; ++n) {
        const double phi = set.phi.block(leaf)[n], k = kappa.block(leaf)[n];
        if (std::abs(phi) >= 6) {
          EXPECT_EQ(k, 0);
        }
        if (std::abs(phi) < 2) {
          EXPECT_NEAR(k * (14 - phi) / 2, 1, bar);
        }
      }
  }
}

// --- Osculating paraboloids

struct Paraboloid {
  double a, b, c, d, e, f;
  double operator()(double x, double y) const { return a * x * x + b * x * y + c * y * y + d * x + e * y + f; }
};

// Ten points of a paraboloid in a turned frame: irregular, none symmetric.
struct TurnedPoints {
  Vec3 u{2.0 / 3, 2.0 / 3, 1.0 / 3}, v{-2.0 / 3, 1.0 / 3, 2.0 / 3}, n{1.0 / 3, -2.0 / 3, 2.0 / 3}, center{5, -3, 8};
  std::vector<Vec3> of(const Paraboloid& z) const {
    std::mt19937 random(11);
    std::uniform_real_distribution<double> any(-1, 1);
    std::vector<Vec3> points;
    for (int i = 0; i < 10; ++i) {
      const double x = i == 0 ? 0 : any(random), y = i == 0 ? 0 : any(random);
      points.push_back(center + u * x + v * y + n * z(x, y));
    }
    return points;
  }
};

TEST(OsculatingParaboloid, IsExactForParaboloidsHoweverTilted) {
  const TurnedPoints turned;
  for (const Paraboloid& z : {Paraboloid{-0.5, 0, -0.2, 0, 0, 0}, {0.3, -0.7, -0.4, 0.5, -0.3, 0.2}, {-0.4, 0, -0.4, 0, 0, 0}, {0, 0, 0, 0.4, 0.7, -0.1}}) {
    const OsculatingParaboloid fit = osculating_paraboloid(turned.center, turned.n * 3, turned.of(z));
    ASSERT_TRUE(fit.valid);
    const double w2 = 1 + z.d * z.d + z.e * z.e;
    const double gaussian = (4 * z.a * z.c - z.b * z.b) / (w2 * w2);
    const double sum = -((1 + z.e * z.e) * 2 * z.a - 2 * z.d * z.e * z.b + (1 + z.d * z.d) * 2 * z.c) / (w2 * std::sqrt(w2));
    EXPECT_NEAR(fit.k1 * fit.k2, gaussian, 1e-12);
    EXPECT_NEAR(fit.k1 + fit.k2, sum, 1e-12);
    EXPECT_GE(fit.k1, fit.k2);
    EXPECT_NEAR(fit.residual, 0, 1e-13);
    EXPECT_NEAR(norm(fit.foot - (turned.center + turned.n * z.f)), 0, 1e-12);
    EXPECT_NEAR(norm(fit.normal - (turned.n - turned.u * z.d - turned.v * z.e) / std::sqrt(w2)), 0, 1e-12);
    EXPECT_NEAR(norm(cross(fit.direction1, fit.direction2) - fit.normal), 0, 1e-12);
    EXPECT_NEAR(norm(fit.direction1), 1, 1e-12);
  }
}

TEST(OsculatingParaboloid, DirectionsAreThoseOfMostAndLeastCurvature) {
  const TurnedPoints turned;
  const OsculatingParaboloid fit = osculating_paraboloid(turned.center, turned.n, turned.of({0.1, 0, -0.6, 0, 0, 0}));
  EXPECT_NEAR(fit.k1, 1.2, 1e-12);
  EXPECT_NEAR(fit.k2, -0.2, 1e-12);
  EXPECT_NEAR(std::abs(dot(fit.direction1, turned.v)), 1, 1e-12);
  EXPECT_NEAR(std::abs(dot(fit.direction2, turned.u)), 1, 1e-12);
}

// 25 points of a unit ball, as far as s away.
TEST(OsculatingParaboloid, ConvergesOnABall) {
  const auto error = [](double s, int degree) {
    std::vector<Vec3> points;
    for (int i = 0; i < 25; ++i) {
      const double x = s * (i % 5 - 2) / 2, y = s * (i / 5 - 2) / 2;
      points.push_back({x, y, std::sqrt(1 - x * x - y * y)});
    }
    const OsculatingParaboloid fit = osculating_paraboloid({0, 0, 1}, {0.1, -0.05, 1}, points, degree);
    return std::max(std::abs(fit.k1 - 1), std::abs(fit.k2 - 1));
  };
  // The tilt of the given normal breaks the symmetry: first order for the paraboloid, third with terms of degree four.
  EXPECT_GE(std::log2(error(0.2, 2) / error(0.1, 2)), 0.9);
  EXPECT_GE(std::log2(error(0.2, 4) / error(0.1, 4)), 2.9);
  EXPECT_LE(error(0.1, 2), 0.05);
  EXPECT_LE(error(0.1, 4), 1e-3);
}

TEST(OsculatingParaboloid, RefusesPointsThatDetermineNone) {
  std::vector<Vec3> line;
  for (int i = 0; i < 10; ++i) line.push_back({0.1 * i, 0.2 * i, 0});
  EXPECT_FALSE(osculating_paraboloid({}, {0, 0, 1}, line).valid);
  EXPECT_FALSE(osculating_paraboloid({}, {0, 0, 1}, std::span(line).first(5)).valid);
  EXPECT_FALSE(osculating_paraboloid({}, {0, 0, 0}, line).valid);
  EXPECT_FALSE(osculating_paraboloid({1, 1, 1}, {0, 0, 1}, std::vector<Vec3>(10, {1, 1, 1})).valid);
}

}  // namespace
}  // namespace burnish
