// The Delaunay extractor: what it finds, how its facets are, and that it ends.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <limits>
#include <numbers>
#include <random>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/extract/delaunay.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/inspect.h"
#include "field_sampler.h"
#include "protected_curves.h"
#include "support/analytic_level_set.h"
#include "support/facet_angles.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

bool touches_crease(const DelaunaySurface& s, std::size_t f) {
  return std::any_of(s.soup.facets[f].begin(), s.soup.facets[f].end(), [&](std::uint32_t v) { return s.on_crease[v] != 0; });
}

double least_angle_away_from_creases(const DelaunaySurface& s) {
  double least = 180;
  for (std::size_t f = 0; f < s.soup.facets.size(); ++f)
    if (!touches_crease(s, f)) least = std::min(least, least_angle(s.soup, f));
  return least;
}

LevelSet ball(double radius) { return analytic_ball<float>(radius, {0.3, 0.1, 0.2}, 4).set; }

// How deep facets with edges of one cell lie below a convex surface with these curvatures' sum, in the mean: e^2 / 16 of it, since points are on
// the surface, and h^2 / 12 of it, since trilinear interpolation lies below a concave function.
double mean_depth(double curvature) { return curvature * (1.0 / 16 + 1.0 / 12); }

bool same_bits(const TriangleSoup& a, const TriangleSoup& b) {
  return a.points.size() == b.points.size() && a.facets == b.facets &&
         std::memcmp(a.points.data(), b.points.data(), a.points.size() * sizeof(Vec3)) == 0;
}

// A box with edges of 20 cells, and its level set from triangles; the box stands askew on the lattice as make_frame puts it.
struct Box {
  TriangleSoup lattice;
  LevelSet set;
  std::vector<std::vector<Vec3>> edges;  // lattice coordinates

  explicit Box(double side = 20) {
    TriangleSoup soup = cube();
    for (Vec3& p : soup.points) p *= side;
    const GridFrame frame = make_frame(bounding_box(soup), 1, 6);
    set = level_set_from_triangles(soup, frame).level_set;
    lattice = to_lattice(soup, frame);
    for (int axis = 0; axis < 3; ++axis)
      for (const double u : {0.0, side})
        for (const double w : {0.0, side}) {
          Vec3 a, b;
          a[(axis + 1) % 3] = b[(axis + 1) % 3] = u;
          a[(axis + 2) % 3] = b[(axis + 2) % 3] = w;
          b[axis] = side;
          edges.push_back({frame.to_lattice(a), frame.to_lattice(b)});
        }
  }
  double distance_to_edges(const Vec3& p) const {
    double least = std::numeric_limits<double>::infinity();
    for (const auto& e : edges) {
      const Vec3 d = e[1] - e[0];
      least = std::min(least, norm(p - e[0] - d * std::clamp(dot(p - e[0], d) / squared_norm(d), 0.0, 1.0)));
    }
    return least;
  }
};

TEST(Delaunay, ABallIsRoundAndItsFacetsAreWellShaped) {
  const auto [set, center] = analytic_ball<float>(12, {0.3, 0.1, 0.2}, 4);
  const DelaunaySurface s = extract_delaunay(set);
  ASSERT_EQ(s.failure, "");
  EXPECT_TRUE(inspect(s.soup).defects.valid_solid());
  EXPECT_EQ(s.attempts, 1);
  // Trilinear interpolation of the distance is off by h^2 / 8 times the sum of curvatures, 0.02 cells, and float's rounding.
  for (const Vec3& p : s.soup.points) EXPECT_NEAR(norm(p - center), 12, 0.025);
  EXPECT_GE(least_angle_away_from_creases(s), 25);
  EXPECT_NEAR(mean_edge_length(s.soup), 1, 0.1);
  EXPECT_NEAR(signed_volume(s.soup) / (4.0 / 3 * std::numbers::pi * 12 * 12 * 12), 1 - 3 * mean_depth(2.0 / 12) / 12, 0.001);
  EXPECT_NEAR(static_cast<double>(predicted_facets(set)), static_cast<double>(s.soup.facets.size()), 0.25 * static_cast<double>(s.soup.facets.size()));
}

TEST(Delaunay, EdgesHaveTheLengthThatIsAskedFor) {
  const LevelSet set = ball(24);
  for (const double edge : {1.0, 1.5, 2.0}) {
    const DelaunaySurface s = extract_delaunay(set, {.edge = edge});
    ASSERT_EQ(s.failure, "");
    EXPECT_NEAR(mean_edge_length(s.soup), edge, 0.12 * edge) << "edge " << edge;
    EXPECT_GE(least_angle_away_from_creases(s), 25);
  }
}

TEST(Delaunay, EdgesFollowTheCurvature) {
  // On a ball of radius 24 a chord of length e is e^2 / (8 R) off: 0.04 for e = 2.77.
  const DelaunaySurface s = extract_delaunay(ball(24), {.edge_tolerance = 0.04});
  ASSERT_EQ(s.failure, "");
  EXPECT_NEAR(mean_edge_length(s.soup), std::sqrt(8 * 24 * 0.04), 0.4);
  EXPECT_GE(least_angle_away_from_creases(s), 25);
}

// 21 balls of radii down to 2.5 cells, of which meshers that start from a few points find one.
TEST(Delaunay, FindsEveryComponent) {
  std::vector<std::pair<Vec3, double>> balls;
  for (int i = 0; i < 21; ++i)
    balls.push_back({Vec3{16.0 + 23 * (i % 5), 16.0 + 23 * (i / 5 % 5), 20.0 + 0.37 * i}, 2.5 + 0.35 * (i % 20)});
  const auto distance = [&](const Vec3& p) {
    double most = -1e9;
    for (const auto& [c, r] : balls) most = std::max(most, r - norm(p - c));
    return most;
  };
  const LevelSet set = analytic_level_set<float>(4, 4, distance);
  for (const double edge : {1.0, 3.0}) {
    const DelaunaySurface s = extract_delaunay(set, {.edge = edge});
    ASSERT_EQ(s.failure, "") << "edge " << edge;
    const Defects d = inspect(s.soup).defects;
    EXPECT_TRUE(d.valid_solid());
    EXPECT_EQ(d.components, 21u);
  }
}

// One inside node: what the lattice shows of a component is a drop of half a cell.
TEST(Delaunay, FindsADropOfHalfACell) {
  const LevelSet set = analytic_level_set<float>(2, 4, [](const Vec3& p) {
    return std::max(5 - norm(p - Vec3{12.2, 12.1, 12.3}), 0.6 - norm(p - Vec3{24, 24, 24}));
  });
  const DelaunaySurface s = extract_delaunay(set);
  ASSERT_EQ(s.failure, "");
  EXPECT_EQ(inspect(s.soup).defects.components, 2u);
}

TEST(Delaunay, APlateOfTwoCellsHasTwoSheets) {
  const LevelSet set = analytic_level_set<float>(3, 4, [](const Vec3& p) {
    const Vec3 q = p - Vec3{32.3, 32.1, 32.2};
    const double radial = std::hypot(q.x, q.y) - 20;
    return -std::max(radial, std::abs(q.z) - 1);
  });
  const DelaunaySurface s = extract_delaunay(set);
  ASSERT_EQ(s.failure, "");
  EXPECT_TRUE(inspect(s.soup).defects.valid_solid());
  // All that is missing is at the rim: facets of a cell cut its two edges, a quarter of a cell squared at most.
  const double missing = 2 * std::numbers::pi * 400 - signed_volume(s.soup);
  EXPECT_GE(missing, 0);
  EXPECT_LE(missing, 0.25 * 2 * (2 * std::numbers::pi * 20));
  for (const Vec3& p : s.soup.points)
    if (std::hypot(p.x - 32.3, p.y - 32.1) < 18) {
      EXPECT_NEAR(std::abs(p.z - 32.2), 1, 1e-4);
    }
}

TEST(Delaunay, KeepsHandles) {
  const LevelSet set = analytic_level_set<float>(3, 4, [](const Vec3& p) {
    const Vec3 q = p - Vec3{32.3, 32.1, 32.2};
    return 4 - std::hypot(std::hypot(q.x, q.y) - 14, q.z);
  });
  const DelaunaySurface s = extract_delaunay(set);
  ASSERT_EQ(s.failure, "");
  EXPECT_EQ(static_cast<std::int64_t>(s.soup.points.size()) - static_cast<std::int64_t>(s.soup.facets.size() / 2), 0);
  EXPECT_NEAR(signed_volume(s.soup) / (2 * std::numbers::pi * std::numbers::pi * 14 * 16), 1 - 2 * mean_depth(1.0 / 4) / 4, 0.002);
}

TEST(Delaunay, CreasesAreEdgesOfTheResult) {
  const Box box;
  DelaunayOptions options;
  options.creases = box.edges;
  const DelaunaySurface s = extract_delaunay(box.set, options);
  ASSERT_EQ(s.failure, "");
  EXPECT_TRUE(inspect(s.soup).defects.valid_solid());
  EXPECT_GE(least_angle_away_from_creases(s), 25);
  std::size_t on_crease = 0;
  for (std::size_t v = 0; v < s.soup.points.size(); ++v) {
    if (!s.on_crease[v]) continue;
    ++on_crease;
    EXPECT_LE(box.distance_to_edges(s.soup.points[v]), 1e-9);
  }
  EXPECT_GE(on_crease, 12u * 18u);
  // Away from creases facets lie in the box' sides. Interpolation rounds within a cell of an edge, and there facets have one point off.
  const Box3 sides = bounding_box(box.lattice);
  for (std::size_t f = 0; f < s.soup.facets.size(); ++f) {
    const Vec3 middle = (s.soup.corner(f, 0) + s.soup.corner(f, 1) + s.soup.corner(f, 2)) / 3;
    if (box.distance_to_edges(middle) < 2.5) continue;
    double off = 1;
    for (int a = 0; a < 3; ++a) off = std::min({off, std::abs(middle[a] - sides.lower[a]), std::abs(middle[a] - sides.upper[a])});
    EXPECT_LE(off, 1e-3);
  }
  EXPECT_NEAR(signed_volume(s.soup) / 8000, 1, 0.005);
  // Without creases corners are cut.
  EXPECT_LT(std::abs(signed_volume(s.soup) - 8000), std::abs(signed_volume(extract_delaunay(box.set).soup) - 8000));
}

// Polylines that no mesher can protect: jagged, crossing, nearly parallel, sharp angles, tiny loops, repeated points, not finite.
TEST(Delaunay, EndsWithConflictingCreases) {
  const Box box;
  const Vec3 a = box.edges[0][0], b = box.edges[0][1], along = (b - a) / norm(b - a);
  const Vec3 side = std::abs(along.x) > 0.5 ? Vec3{0, 1, 0} : Vec3{1, 0, 0};
  DelaunayOptions options;
  options.creases = box.edges;
  options.creases.push_back({a + side * 0.01, b + side * 0.01});
  options.creases.push_back({a, b + side * 0.5});
  options.creases.push_back({a + side * 0.3, b - side * 0.3});
  options.creases.push_back({a, a + side * 1e-3, a + along * 1e-3, a});
  options.creases.push_back({b, b, b});
  options.creases.push_back({a, {std::numeric_limits<double>::quiet_NaN(), 0, 0}, b});
  std::vector<Vec3> jagged;
  for (int i = 0; i <= 200; ++i) jagged.push_back(a + along * (0.1 * i) + side * (4 + (i % 2 ? 0.2 : 0)));
  options.creases.push_back(jagged);
  const DelaunaySurface s = extract_delaunay(box.set, options);
  ASSERT_EQ(s.failure, "");
  EXPECT_TRUE(inspect(s.soup).defects.valid_solid());
  EXPECT_LE(s.soup.facets.size(), 4 * predicted_facets(box.set));
}

TEST(Delaunay, LimitsAreFailuresAndNotMeshes) {
  const LevelSet set = ball(12);
  for (const DelaunayOptions& options : {DelaunayOptions{.max_points = 50}, DelaunayOptions{.max_oracle_calls = 1000}}) {
    const DelaunaySurface s = extract_delaunay(set, options);
    EXPECT_NE(s.failure, "");
    EXPECT_TRUE(s.soup.facets.empty());
    EXPECT_EQ(s.attempts, 1);
  }
}

TEST(Delaunay, NothingAndNonsense) {
  const DelaunaySurface nothing = extract_delaunay(analytic_level_set<float>(2, 4, [](const Vec3&) { return -3.0; }));
  EXPECT_TRUE(nothing.soup.facets.empty());
  EXPECT_EQ(nothing.failure, "");
  // Values that are no numbers, in the middle and on the surface.
  LevelSet set = ball(12);
  int n = 0;
  for_each_near_node(set, [&](const Vec3&, float& value) {
    if (++n % 211 == 0) value = std::numeric_limits<float>::quiet_NaN();
  });
  const DelaunaySurface s = extract_delaunay(set);
  EXPECT_EQ(s.failure.empty(), !s.soup.facets.empty());
  if (s.failure.empty()) {
    const Defects d = inspect(s.soup).defects;
    EXPECT_TRUE(d.closed_manifold()) << d.degenerate_facets << " degenerate facets, " << d.duplicate_facets << " duplicate, " << d.open_edges << " open edges, "
                                     << d.non_manifold_edges + d.non_manifold_points << " non-manifold, " << d.misoriented_edges << " misoriented";
  }
}

// A plane through the lattice's nodes: seeds on it would be on common circles.
TEST(Delaunay, FlatSidesOnTheLattice) {
  const LevelSet set = analytic_level_set<float>(3, 4, [](const Vec3& p) {
    const Vec3 q = p - Vec3{32, 32, 32};
    return 14 - std::max({std::abs(q.x), std::abs(q.y), std::abs(q.z)});
  });
  for (const double edge : {0.7, 1.0, 4.0}) {
    const DelaunaySurface s = extract_delaunay(set, {.edge = edge});
    EXPECT_EQ(s.failure, "") << "edge " << edge;
    EXPECT_TRUE(inspect(s.soup).defects.valid_solid());
  }
}

TEST(Delaunay, SameBitsAgain) {
  const Box box;
  DelaunayOptions options;
  options.creases = box.edges;
  EXPECT_TRUE(same_bits(extract_delaunay(box.set, options).soup, extract_delaunay(box.set, options).soup));
}

struct Interrupted : Progress {
  bool cancelled() const override { return true; }
};

TEST(Delaunay, CanBeInterrupted) {
  Interrupted progress;
  EXPECT_THROW(extract_delaunay(ball(12), {}, progress), Error);
}

TEST(FieldSampler, IsTheInterpolant) {
  const LevelSet set = ball(12);
  detail::FieldSampler field(set, no_progress());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> any(0, 8.0 * set.octree().side() - 1);
  for (int i = 0; i < 2000; ++i) {
    const Vec3 p{any(random), any(random), any(random)};
    EXPECT_NEAR(field(p), sample(set.octree(), set.phi, p.x, p.y, p.z), 1e-5);
  }
  EXPECT_EQ(field({-1, 3, 3}), detail::FieldSampler::kOutside);
  EXPECT_EQ(field({std::numeric_limits<double>::quiet_NaN(), 3, 3}), detail::FieldSampler::kOutside);
}

TEST(FieldSampler, FindsCrossingsFromFarAway) {
  const auto [set, center] = analytic_ball<float>(12, {0.3, 0.1, 0.2}, 4);
  detail::FieldSampler field(set, no_progress());
  for (const double far : {20.0, 1e3, 1e9, 1e15}) {
    const auto p = field.crossing(center + Vec3{far, far / 3, -far / 7}, center);
    ASSERT_TRUE(p);
    EXPECT_NEAR(field(*p), 0, 1e-4);
    EXPECT_LE(norm(cross(*p - center, Vec3{1, 1.0 / 3, -1.0 / 7})), 1e-8) << far;
  }
  EXPECT_FALSE(field.crossing(center, center + Vec3{1, 0, 0}));
}

TEST(ProtectedCurves, MeetInCommonEndsOnly) {
  const std::vector<std::vector<Vec3>> cross{{{0, 0, 0}, {10, 0, 0}}, {{5, 0.1, 0}, {5, 10, 0}}};
  const auto curves = detail::separated_curves(cross, 1);
  ASSERT_EQ(curves.size(), 3u);  // the first is divided where the second ends
  for (const auto& c : curves) EXPECT_TRUE(c.front() == Vec3(5, 0.1, 0) || c.back() == Vec3(5, 0.1, 0));
  // Of two parallel ones nearer than half an edge one stays.
  EXPECT_EQ(detail::separated_curves({{{0, 0, 0}, {10, 0, 0}}, {{0, 0.4, 0}, {10, 0.4, 0}}}, 1).size(), 1u);
  EXPECT_EQ(detail::separated_curves({{{0, 0, 0}, {10, 0, 0}}, {{0, 0.6, 0}, {10, 0.6, 0}}}, 1).size(), 2u);
  EXPECT_TRUE(detail::separated_curves({{{0, 0, 0}, {0.2, 0, 0}}}, 1).empty());
}

}  // namespace
}  // namespace burnish
