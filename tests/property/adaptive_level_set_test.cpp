// Level sets on octrees with leaves of several levels at the surface: signs, distances and surfaces beside those of uniform ones.
#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/levelset/volume.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/level_sets.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

struct Model {
  const char* name;
  TriangleSoup soup;
  double cell;
};

std::vector<Model> models() {
  const TriangleSoup ball = icosphere(4);
  std::vector<Model> all;
  all.push_back({"ball", ball, 0.02});
  all.push_back({"torus", torus(120, 60), 0.02});
  all.push_back({"cube", moved(cube(), {0.1, 0.2, 0.3}), 0.013});
  all.push_back({"cavity", merged(scaled(ball, 2), flipped(ball)), 0.04});
  all.push_back({"overlap", merged(ball, moved(ball, {0.8, 0.3, 0.1})), 0.03});
  all.push_back({"bracket", weld(bracket(5)), 0.02});
  return all;
}

LevelSetOptions adaptive(double tolerance, bool far_field, int coarsest = 3) {
  LevelSetOptions options{.band = 3, .far_field = far_field};
  options.adaptivity.tolerance = tolerance;
  options.adaptivity.limits.coarsest_level = coarsest;
  return options;
}

GridFrame frame_for(const Model& model) { return make_frame(bounding_box(model.soup), model.cell, 24); }

// The highest level of leaves that facets are near to.
int coarsest_near(const LevelSet& set) {
  int level = 0;
  for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
    if (set.grid.near_surface(leaf)) level = std::max(level, set.octree().level(leaf));
  return level;
}

TriangleSoup boundary_of(const LevelSetFromTriangles& built, const TriangleSoup& soup) {
  TriangleSoup boundary{soup.points, {}, {}};
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (built.roles[f] == FacetRole::boundary) boundary.facets.push_back(soup.facets[f]);
  return boundary;
}

TEST(AdaptiveLevelSet, NodesHaveTheSignsOfTheUniformOne) {
  for (const Model& model : models())
    for (const bool far_field : {false, true}) {
      SCOPED_TRACE(testing::Message() << model.name << (far_field ? ", everywhere" : ", band"));
      const GridFrame frame = frame_for(model);
      const LevelSet uniform = level_set_from_triangles(model.soup, frame, {.band = 3, .far_field = false}).level_set;
      const LevelSet set = level_set_from_triangles(model.soup, frame, adaptive(0.1, far_field)).level_set;
      EXPECT_GE(coarsest_near(set), 1);
      std::size_t wrong = 0;
      for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf)
        for (int n = 0; n < static_cast<int>(kBlockNodes); ++n) {
          const LatticeNode at = lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64);
          const double expected = node_value(uniform.octree(), uniform.phi, at);
          if (std::abs(expected) > 1e-3) wrong += (set.phi.block(leaf)[n] > 0) != (expected > 0);
        }
      EXPECT_EQ(wrong, 0u);
    }
}

TEST(AdaptiveLevelSet, DistancesAreExactWithinTheBandOfEachLevel) {
  for (const Model& model : models()) {
    SCOPED_TRACE(model.name);
    const LevelSetFromTriangles built = level_set_from_triangles(model.soup, frame_for(model), adaptive(0.1, false));
    const LevelSet& set = built.level_set;
    const TriangleIndex index(to_lattice(boundary_of(built, model.soup), set.frame));
    double worst = 0;
    std::size_t within = 0;
    for (std::size_t leaf = 0; leaf < set.octree().size(); ++leaf) {
      if (!set.grid.near_surface(leaf)) continue;
      const double band = 3.0 * (1 << set.octree().level(leaf));
      for (int n = static_cast<int>(leaf % 7); n < static_cast<int>(kBlockNodes); n += 7) {
        const double d = std::sqrt(index.closest(to_vec(lattice_node(set.octree(), leaf, n % 8, n / 8 % 8, n / 64))).squared_distance);
        const double phi = std::abs(static_cast<double>(set.phi.block(leaf)[n]));
        if (d < band) {
          worst = std::max(worst, std::abs(phi - d) / (6e-8 * d + 1e-12));
          ++within;
        } else {
          ASSERT_NEAR(phi, band, 1e-5);
        }
      }
    }
    EXPECT_GT(within, 500u);
    EXPECT_LE(worst, 1) << "in units of 6e-8 d + 1e-12 cells";
  }
}

TEST(AdaptiveLevelSet, SurfacesAreSolidsOfTheSameVolume) {
  std::size_t transition_cells = 0;
  for (const Model& model : models()) {
    SCOPED_TRACE(model.name);
    const GridFrame frame = frame_for(model);
    const LevelSet uniform = level_set_from_triangles(model.soup, frame, {.band = 3, .far_field = false}).level_set;
    for (const double tolerance : {0.05, 0.3}) {
      const LevelSet set = level_set_from_triangles(model.soup, frame, adaptive(tolerance, false, 2)).level_set;
      EXPECT_LT(set.octree().size(), uniform.octree().size());
      const ExtractedSurface surface = extract_surface(set);
      transition_cells += surface.transition_cells;
      const Defects defects = inspect(surface.soup).defects;
      EXPECT_TRUE(defects.valid_solid()) << defects.self_intersecting_pairs << " self-intersections, " << defects.open_edges << " open edges";
      EXPECT_EQ(defects.components, inspect(extract_surface(uniform).soup).defects.components);
      // No part of the surface is off by more than the tolerance.
      EXPECT_LE(std::abs(enclosed_volume(set) - enclosed_volume(uniform)), 1.1 * tolerance * area(surface.soup));
    }
  }
  EXPECT_GT(transition_cells, 1000u);
}

TEST(AdaptiveLevelSet, SameBitsForAnyNumberOfThreads) {
  const Model model = models()[4];
  const auto build = [&](int threads) {
    const ThreadLimit limit(threads);
    return level_set_from_triangles(model.soup, frame_for(model), adaptive(0.1, false)).level_set;
  };
  const LevelSet one = build(1), four = build(4);
  ASSERT_EQ(one.octree().size(), four.octree().size());
  EXPECT_EQ(one.phi.layout(), four.phi.layout());
  EXPECT_EQ(one.phi.values(), four.phi.values());
}

// The thesis' criteria instead of an error: finer where facets are small.
TEST(AdaptiveLevelSet, CriteriaOfTheThesisMakeLevels) {
  LevelSetOptions options{.band = 3, .far_field = false};
  options.adaptivity.limits.max_face_limit = 2;
  options.adaptivity.limits.coarsest_level = 4;
  const Model model{"torus", torus(120, 60), 0.005};
  const LevelSetFromTriangles built = level_set_from_triangles(model.soup, make_frame(bounding_box(model.soup), model.cell, 48), options);
  EXPECT_GE(coarsest_near(built.level_set), 1);
  ASSERT_EQ(built.growth.divided_by.size(), 1u);
  EXPECT_GT(built.growth.divided_by[0], 0u);
  EXPECT_TRUE(inspect(extract_surface(built.level_set).soup).defects.valid_solid());
}

}  // namespace
}  // namespace burnish
