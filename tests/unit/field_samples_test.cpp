#include "field_samples.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "burnish/surface/exact_distance.h"
#include "field_output.h"
#include "support/level_sets.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

constexpr unsigned kSeed = 7;

// A level set of facets with all that samples need.
struct Built {
  TriangleSoup lattice;
  LevelSetFromTriangles from;

  Built(const TriangleSoup& soup, double cell, std::optional<double> tolerance = {}) {
    LevelSetOptions options{.band = 3, .keep_nearest = true};
    options.adaptivity.tolerance = tolerance;
    options.adaptivity.limits.coarsest_level = 2;
    const GridFrame frame = make_frame(bounding_box(soup), cell, 20);
    from = level_set_from_triangles(soup, frame, options);
    lattice = to_lattice(soup, frame);
  }

  FieldSamples samples() const { return FieldSamples(from.level_set, lattice, from.roles, from.nearest, 3); }
};

double sample_at(const FieldSamples& samples, const Vec3& p) {
  double phi = 0;
  samples.at({&p, 1}, &phi);
  return phi;
}

Vec3 random_in(std::mt19937& random, const Box3& box) {
  std::uniform_real_distribution<double> share(0, 1);
  const Vec3 size = box.upper - box.lower;
  return box.lower + Vec3{share(random) * size.x, share(random) * size.y, share(random) * size.z};
}

double in_unit_cube(const Vec3& p) {
  const Vec3 q{std::abs(p.x - 0.5) - 0.5, std::abs(p.y - 0.5) - 0.5, std::abs(p.z - 0.5) - 0.5};
  return -norm(max(q, Vec3{})) - std::min(0.0, std::max({q.x, q.y, q.z}));
}

// Anywhere, outside the domain too: within the band exactly, beyond it up to 1 % too large.
TEST(FieldSamples, AreTheSignedDistanceToFacets) {
  std::mt19937 random(kSeed);
  for (const std::optional<double> tolerance : {std::optional<double>{}, std::optional<double>(0.5)}) {
    const Built built(cube(), 0.04, tolerance);
    const FieldSamples samples = built.samples();
    ASSERT_TRUE(samples.is_exact());
    const GridFrame& frame = built.from.level_set.frame;
    for (int i = 0; i < 20000; ++i) {
      const Vec3 p = random_in(random, {{-1, -1, -1}, {2, 2, 2}});
      const double exact = in_unit_cube(p) / frame.cell, phi = sample_at(samples, frame.to_lattice(p));
      ASSERT_EQ(phi > 0, exact > 0) << "seed " << kSeed << ", " << p.x << ' ' << p.y << ' ' << p.z;
      ASSERT_GE(std::abs(phi), std::abs(exact) - 1e-10) << "seed " << kSeed;
      ASSERT_LE(std::abs(phi), (std::abs(exact) > 3 ? 1.0102 : 1) * std::abs(exact) + 1e-10) << "seed " << kSeed;
    }
  }
}

// A millionth of a cell on either side of a surface that is curved, bent sharply, and of several bodies.
TEST(FieldSamples, SignsAreRightBesideTheSurface) {
  std::mt19937 random(kSeed);
  const TriangleSoup soup = merged(icosphere(3), moved(scaled(cube(), 0.8), {0.7, -0.4, -0.4}));
  const Built built(soup, 0.06);
  const FieldSamples samples = built.samples();
  for (const double away : {1e-6, 1e-3, 0.3}) {
    std::size_t checked = 0;
    for (std::size_t f = 0; f < built.lattice.facets.size(); ++f) {
      if (built.from.roles[f] != FacetRole::boundary) continue;
      std::uniform_real_distribution<double> share(0, 1);
      double u = share(random), v = share(random);
      if (u + v > 1) u = 1 - u, v = 1 - v;
      const Vec3 a = built.lattice.corner(f, 0), b = built.lattice.corner(f, 1), c = built.lattice.corner(f, 2);
      const Vec3 n = facet_normal_2a(built.lattice, f) / norm(facet_normal_2a(built.lattice, f)), at = a + (b - a) * u + (c - a) * v;
      // Where the bodies meet the normal says nothing.
      const Vec3 model = built.from.level_set.frame.to_model(at);
      if (norm(model) < 1.1 && std::abs(in_unit_cube((model - Vec3{0.7, -0.4, -0.4}) / 0.8)) < 0.15) continue;
      ASSERT_LT(sample_at(samples, at + n * away), 0) << "facet " << f << ", seed " << kSeed;
      ASSERT_GT(sample_at(samples, at - n * away), 0) << "facet " << f << ", seed " << kSeed;
      ++checked;
    }
    EXPECT_GT(checked, 1000u);
  }
}

// Without facets: the interpolant's error falls with h^4. In cells, as here, that is a factor of 8 from one radius to twice it.
TEST(FieldSamples, InterpolateByTheFourthOrder) {
  std::array<double, 2> worst{};
  for (std::size_t r = 0; r < 2; ++r) {
    const double radius = r == 0 ? 6 : 12;
    const Vec3 center{32.3, 31.8, 32.1};
    LevelSet set = level_set_of<float>(Octree::build(3, all_blocks(3)), [&](const LatticeNode& n) { return radius - norm(to_vec(n) - center); });
    const FieldSamples samples(set);
    EXPECT_FALSE(samples.is_exact());
    std::mt19937 random(kSeed);
    for (int i = 0; i < 5000; ++i) {
      const Vec3 reach{1.4 * radius, 1.4 * radius, 1.4 * radius}, p = random_in(random, {center - reach, center + reach});
      const double exact = radius - norm(p - center);
      if (std::abs(exact) < radius / 3) worst[r] = std::max(worst[r], std::abs(sample_at(samples, p) - exact));
    }
    // Beyond the walls the distance to where the gradient leads.
    EXPECT_NEAR(sample_at(samples, {-20, 30, 40}), radius - norm(Vec3{-20, 30, 40} - center), 0.2);
    EXPECT_NEAR(sample_at(samples, {100, 80, -9}), radius - norm(Vec3{100, 80, -9} - center), 0.5);
  }
  EXPECT_LT(worst[1], 5e-4);
  EXPECT_LT(6 * worst[1], worst[0]);
}

TEST(FieldSamples, GridsCoverTheBoxAndBeginInItsCorner) {
  const Box3 model{{0, 0, 0}, {2, 1, 1}};
  SampleGrid grid = sample_grid({}, model, 0.05);
  EXPECT_EQ(grid.nodes, (std::array<std::uint32_t, 3>{45, 25, 25}));
  EXPECT_NEAR(grid.origin.x, -0.1, 1e-15);
  FieldContent content;
  content.box = Box3{{0, 0, 0}, {3, 2, 1}};
  content.samples = 31;
  grid = sample_grid(content, model, 0.05);
  EXPECT_DOUBLE_EQ(grid.spacing, 0.1);
  EXPECT_EQ(grid.nodes, (std::array<std::uint32_t, 3>{31, 21, 11}));
  EXPECT_EQ(grid.origin, Vec3{});
  content.samples.reset();
  content.spacing = Length{0.7, LengthUnit::model};
  EXPECT_EQ(sample_grid(content, model, 0.05).nodes, (std::array<std::uint32_t, 3>{6, 4, 3}));
  content.spacing = Length{1e-9, LengthUnit::model};
  EXPECT_THROW(sample_grid(content, model, 0.05), Error);
  // Few enough in all, and too many along one axis for their number.
  content.box = Box3{{0, 0, 0}, {8e9, 0, 0}};
  content.spacing = Length{1, LengthUnit::model};
  EXPECT_THROW(sample_grid(content, model, 0.05), Error);
  content = {};
  content.box = Box3{{1, 1, 1}, {1, 1, 1}};
  content.samples = 5;
  EXPECT_THROW(sample_grid(content, model, 0.05), Error);
}

}  // namespace
}  // namespace burnish
