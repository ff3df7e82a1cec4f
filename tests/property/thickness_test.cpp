// Thickness on shapes whose thickness is known, and how it converges to that of the smooth shape as triangles get smaller. [T-THICK-2]
#include "burnish/surface/thickness.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <numbers>
#include <vector>

#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kInner = 0.75, kOuter = 1, kLength = 2;

// A tube along z with prisms of n sides inscribed in both cylinders, those of the inner one turned by `turn` of a side against the outer one's.
TriangleSoup tube(int n, double turn) {
  const auto ring = [&](double radius, double z, double by) {
    std::vector<Vec3> points;
    for (int i = 0; i < n; ++i) {
      const double angle = 2 * std::numbers::pi * (i + by) / n;
      points.push_back({radius * std::cos(angle), radius * std::sin(angle), z});
    }
    return points;
  };
  TriangleSoup soup;
  for (const auto& points : {ring(kOuter, 0, 0), ring(kOuter, kLength, 0), ring(kInner, kLength, turn), ring(kInner, 0, turn)})
    soup.points.insert(soup.points.end(), points.begin(), points.end());
  const auto point = [&](int ring_number, int i) { return static_cast<std::uint32_t>(ring_number % 4 * n + i % n); };
  for (int r = 0; r < 4; ++r)
    for (int i = 0; i < n; ++i) {
      soup.facets.push_back({point(r, i), point(r, i + 1), point(r + 1, i + 1)});
      soup.facets.push_back({point(r, i), point(r + 1, i + 1), point(r + 1, i)});
    }
  return soup;
}

struct Error {
  double largest = 0, rms = 0;
};

// Of the samples that `counts` takes, from what is expected there.
Error error_of(const std::vector<ThicknessSample>& samples, const std::function<double(const ThicknessSample&)>& expected) {
  Error error;
  double area = 0;
  for (const ThicknessSample& s : samples) {
    const double wanted = expected(s);
    if (std::isnan(wanted)) continue;
    error.largest = std::max(error.largest, std::abs(s.thickness - wanted));
    error.rms += s.area * (s.thickness - wanted) * (s.thickness - wanted);
    area += s.area;
  }
  error.rms = std::sqrt(error.rms / area);
  return error;
}

double wall(const ThicknessSample& s) { return s.at.z > 1e-9 && s.at.z < kLength - 1e-9 ? kOuter - kInner : kLength; }

// What prisms are off their cylinders, R (1 - cos(pi / n)), the thickness is off at most; the ends are as thick as the tube is long.
TEST(ThicknessMap, OfATubeIsTheDifferenceOfRadiiBetterThanItsFacets) {
  for (const double turn : {0.0, 0.3, 0.5}) {
    double coarser = 0;
    for (const int n : {32, 64, 128}) {
      const Error error = error_of(thickness_samples(tube(n, turn), 4000), wall);
      EXPECT_LT(error.largest, kOuter * (1 - std::cos(std::numbers::pi / n))) << n << ", turned by " << turn;
      if (coarser > 0) {
        EXPECT_NEAR(std::log2(coarser / error.rms), 2, 0.15) << n << ", turned by " << turn;
      }
      coarser = error.rms;
    }
  }
}

// Edges half as long, errors a quarter: order 2.
TEST(ThicknessMap, OfASphericalShellConvergesWithOrderTwo) {
  const auto error = [](int level) {
    const TriangleSoup shell = merged(icosphere(level), flipped(scaled(icosphere(level), 0.7)));
    return error_of(thickness_samples(shell, 2000), [](const ThicknessSample&) { return 0.3; });
  };
  const Error coarse = error(2), middle = error(3), fine = error(4);
  EXPECT_NEAR(std::log2(coarse.rms / middle.rms), 2, 0.25);
  EXPECT_NEAR(std::log2(middle.rms / fine.rms), 2, 0.25);
  EXPECT_LT(fine.largest, 4e-4);
}

// The largest ball inside a ball touches it everywhere. A facet's normal misses the centre by as much as the facet is wide, which takes as much off the
// largest ball that touches the facet; once that is less than the first ball may be off (1 % of its radius), what is left is what facets are off the sphere, on both sides.
TEST(ThicknessMap, OfASolidBallIsItsDiameter) {
  const auto error = [](int level) { return error_of(thickness_samples(icosphere(level), 1000), [](const ThicknessSample&) { return 2.0; }); };
  EXPECT_LT(error(2).largest, 0.25);    // 320 facets, edges of 0.3
  EXPECT_LT(error(4).largest, 0.0025);  // 5120 facets, edges of 0.075 and up to 0.0012 off
}

// Where walls are flat, triangles do not matter at all.
TEST(ThicknessMap, OfASolidBoxDoesNotDependOnItsTriangles) {
  for (const int n : {1, 3, 12}) {
    const Error error = error_of(thickness_samples(box({1, 2, 0.25}, n, 2 * n, n), 1000), [](const ThicknessSample& s) {
      const auto at = [](double x, double side) { return x < 1e-12 || x > side - 1e-12; };
      return at(s.at.x, 1) ? 1 : at(s.at.y, 2) ? 2 : 0.25;
    });
    EXPECT_LT(error.largest, 1e-8) << n;
  }
}

// A plate that gets thicker from 0.2 to 0.6 over a length of 2: floor and roof meet at x = -1. A ball that touches both has its contacts at one distance
// from there, s, and the diameter 2 s tan(a / 2). From above within 1 %, and for small triangles as for large ones.
TEST(ThicknessMap, OfAPlateThatIsAWedgeGrowsWithItsLength) {
  const double angle = std::atan(0.2);
  for (const int n : {1, 4, 16}) {
    const TriangleSoup plate = mapped(box({2, 1, 1}, n, n, n), [](const Vec3& p) { return Vec3{p.x, p.y, p.z * (0.2 + 0.2 * p.x)}; });
    std::size_t seen = 0;
    for (const ThicknessSample& s : thickness_samples(plate, 2000)) {
      const double from_edge = std::hypot(s.at.x + 1, s.at.z);
      const bool on_floor = s.at.z < 1e-9, on_roof = std::abs(s.at.z - 0.2 * (s.at.x + 1)) < 1e-9;
      if (!(on_floor || on_roof) || s.at.x < 0.1 || s.at.x > 1.8 || s.at.y < 0.05 || s.at.y > 0.95) continue;
      const double expected = 2 * from_edge * std::tan(angle / 2);
      EXPECT_GT(s.thickness, expected * (1 - 1e-9)) << n << " at " << s.at.x;
      EXPECT_LT(s.thickness, expected * 1.01) << n << " at " << s.at.x;
      ++seen;
    }
    EXPECT_GT(seen, 500u);
  }
}

}  // namespace
}  // namespace burnish
