// --adapt, from file to file.
#include <gtest/gtest.h>

#include "burnish/surface/example_shapes.h"
#include "support/options_fixture.h"
#include "support/parts.h"

namespace burnish {
namespace {

using namespace test;

class Adaptive : public PipelineOptions {
 protected:
  // Without and with coarser cells.
  std::pair<RepairReport, RepairReport> run_both(const TriangleSoup& soup, CleanOptions options) {
    options.method = Method::level_set;
    RepairReport fine = run(soup, options);
    options.adapt = Length{0.1, LengthUnit::cells};
    return {std::move(fine), run(soup, options, "adapted.stl")};
  }
};

CleanOptions at_resolution(int n) {
  CleanOptions options;
  options.resolution = n;
  return options;
}

TEST_F(Adaptive, TakesFewerBlocksForTheSameSurface) {
  for (const TriangleSoup& part : {weld(moved(bracket(5), {0.1, 0.2, 0.3})), icosphere(4)}) {
    const auto [fine, adapted] = run_both(part, at_resolution(150));
    expect_solid(adapted, fine.after.volume, 1, 1e-3);
    EXPECT_LT(adapted.grid.finest_blocks, fine.grid.finest_blocks);
    EXPECT_LT(adapted.after.facets, fine.after.facets);
    EXPECT_LE(adapted.deviation.output_to_input.rms, fine.deviation.output_to_input.rms + 0.1 * fine.options.cell);
    EXPECT_NEAR(*adapted.options.adapt, 0.1 * adapted.options.cell, 1e-12);
    EXPECT_EQ(adapted.options.coarsest_level, 3);
  }
}

TEST_F(Adaptive, CoarsensWhatHasBeenSmoothed) {
  CleanOptions options = at_resolution(100);
  options.smooth = {3, LengthUnit::cells};
  const auto [fine, adapted] = run_both(icosphere(4), options);
  expect_solid(adapted, fine.after.volume, 1, 2e-3);
  EXPECT_LT(adapted.grid.finest_blocks, fine.grid.finest_blocks);
}

TEST_F(Adaptive, CoarsensShells) {
  CleanOptions options = at_resolution(120);
  options.thicken = model_length(0.1);
  const auto [fine, adapted] = run_both(icosphere(4), options);
  expect_solid(adapted, fine.after.volume, fine.after.components, 5e-3);
  EXPECT_LT(adapted.grid.finest_blocks, fine.grid.finest_blocks);
}

TEST_F(Adaptive, HoleIsClosedAndOverlapUnited) {
  const TriangleSoup two = merged(without_facets(icosphere(4), {3, 4, 5, 100}), moved(icosphere(4), {0.9, 0.2, 0.1}));
  const auto [fine, adapted] = run_both(weld(two), at_resolution(120));
  expect_solid(adapted, fine.after.volume, 1, 2e-3);
}

// So far from the origin that float32 has steps of a few percent of a cell: facets at cells of two levels collapse, and are mended where they are.
TEST_F(Adaptive, IsMendedBesideLevelJumps) {
  const TriangleSoup far = weld(moved(make_example(ExampleShape::vase, {}).dirty, {5117, 0, 0}));
  CleanOptions options = at_resolution(150);
  options.adapt = Length{0.3, LengthUnit::cells};
  options.surface = Extractor::tetrahedra;
  const RepairReport report = run(far, options);
  expect_solid(report, signed_volume(far), 1, 0.02);
  EXPECT_TRUE(report.options.adapt);
}

TEST_F(Adaptive, CellMaxBoundsTheLevels) {
  CleanOptions options = at_resolution(200);
  options.method = Method::level_set;
  options.adapt = Length{0.5, LengthUnit::cells};
  options.cell_max = Length{1, LengthUnit::cells};
  const RepairReport finest = run(cube(), options);
  EXPECT_EQ(finest.options.coarsest_level, 0);
  options.cell_max = Length{4.5, LengthUnit::cells};
  const RepairReport coarser = run(cube(), options, "coarser.stl");
  EXPECT_EQ(coarser.options.coarsest_level, 2);
  EXPECT_LT(coarser.grid.finest_blocks, finest.grid.finest_blocks);
  options.cell_max = Length{0.5, LengthUnit::cells};
  EXPECT_THROW(run(cube(), options, "none.stl"), Error);
}

}  // namespace
}  // namespace burnish
