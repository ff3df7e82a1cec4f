// Boxes of finer cells: where they act, what they take, how large they say that cells are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>
#include <regex>
#include <string>

#include "burnish/core/error.h"
#include "burnish/core/text.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/volume/flow_mesh.h"
#include "burnish/volume/mesh_quality.h"
#include "mesh_memory.h"
#include "mesh_refinement.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

FlowMeshOptions inside(double cell) {
  FlowMeshOptions options;
  options.cell = cell;
  return options;
}
// Sides at odd distances, so that all of them are stretched, some outwards and some inwards.
FlowMeshOptions outside(double cell) {
  FlowMeshOptions options = inside(cell);
  options.side = MeshSide::outside;
  options.domain = {{-3.123, -2.5, -2.77}, {5.01, 2.9, 3.33}};
  return options;
}

Box3 cube_about(const Vec3& middle, double half) { return {middle - Vec3{half, half, half}, middle + Vec3{half, half, half}}; }

bool overlap(const Box3& a, const Box3& b) {
  bool all = true;
  for (int i = 0; i < 3; ++i) all = all && a.lower[i] < b.upper[i] - 1e-9 && b.lower[i] < a.upper[i] - 1e-9;
  return all;
}

Error error_of(const TriangleSoup& solid, const FlowMeshOptions& options) {
  try {
    flow_mesh(solid, {}, {}, options);
  } catch (const Error& e) {
    return e;
  }
  ADD_FAILURE() << "no error";
  return {ErrorCode::bug, ""};
}

bool contains(const std::string& text, const std::string& part) { return text.find(part) != text.npos; }

std::size_t wall_faces_beyond(const VolumeMesh& volume, double x) {
  const PolyhedralMesh& mesh = volume.mesh;
  std::size_t n = 0;
  for (std::size_t f = mesh.internal_faces(); f < mesh.faces(); ++f) n += face_middle(mesh, f).x > x;
  return n;
}

TEST(FlowMeshRefinement, LeavesTheRestOfTheSurfaceAsItIs) {
  const TriangleSoup box = cube();
  FlowMeshOptions options = inside(0.04);
  const std::size_t without = wall_faces_beyond(flow_mesh(box, {}, {}, options).mesh, 0.5);
  options.refinements = {{cube_about({0.03, 0.4, 0.4}, 0.04), 0.01}};
  const FlowMesh made = flow_mesh(box, {}, {}, options);
  EXPECT_NEAR(static_cast<double>(wall_faces_beyond(made.mesh, 0.5)) / static_cast<double>(without), 1, 0.2);  // four times as many, were they as fine as where nothing is flat
  const MeshQuality q = mesh_quality(made.mesh);
  EXPECT_TRUE(q.ok);
  EXPECT_EQ(q.regions, 1u);
}

// The level set is fine in the box alone, and so is what it takes.
TEST(FlowMeshRefinement, TakesMemoryWhereItIs) {
  const TriangleSoup ball = icosphere(4);
  FlowMeshOptions options = inside(0.08);
  options.memory_bytes = 100'000'000;
  options.refinements = {{cube_about({1, 0, 0}, 0.03), 0.08 / 16}};
  const FlowMesh made = flow_mesh(ball, {}, {}, options);
  EXPECT_TRUE(mesh_quality(made.mesh).ok);
  EXPECT_NEAR(mesh_quality(made.mesh).volume, signed_volume(ball), 0.02 * signed_volume(ball));
}

TEST(FlowMeshRefinement, LevelSetHasTheSameDistancesAsOneThatIsFineEverywhere) {
  const TriangleSoup ball = icosphere(3);
  const GridFrame frame = make_frame(bounding_box(ball), 0.02, 60);
  const LevelSet fine = level_set_from_triangles(ball, frame, {.band = 5, .far_field = false}).level_set;
  LevelSetOptions options{.band = 5, .far_field = false};
  options.adaptivity.limits.coarsest_level = 3;
  const Box3 box{frame.to_lattice({0.5, -0.3, -0.3}), frame.to_lattice({1.1, 0.3, 0.3})};
  options.adaptivity.limits.boxes = {{box, 0}};
  const LevelSet local = level_set_from_triangles(ball, frame, options).level_set;
  const Octree& tree = local.octree();
  std::size_t finest = 0, coarsest = 0;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
    if (!local.grid.near_surface(leaf)) continue;
    const LatticeNode c = lattice_node(tree, leaf, 0, 0, 0);
    const double side = 8 << tree.level(leaf);
    const bool meets = c.x <= box.upper.x && c.x + side >= box.lower.x && c.y <= box.upper.y && c.y + side >= box.lower.y && c.z <= box.upper.z && c.z + side >= box.lower.z;
    if (meets) {
      EXPECT_EQ(tree.level(leaf), 0);
    }
    finest += tree.level(leaf) == 0, coarsest += tree.level(leaf) == 3;
    EXPECT_LE(tree.level(leaf), 3);
    if (tree.level(leaf) != 0) continue;
    const std::uint32_t same = fine.octree().find_key(tree.key(leaf));
    ASSERT_NE(same, Octree::kNone);
    for (std::size_t n = 0; n < kBlockNodes; ++n) EXPECT_EQ(local.phi.block(leaf)[n], fine.phi.block(same)[n]);
  }
  EXPECT_GT(finest, 0u);
  EXPECT_GT(coarsest, 0u);
  EXPECT_LT(local.octree().size(), fine.octree().size() / 2);
}

// In the model, not on the lattice, which is stretched.
TEST(FlowMeshRefinement, NoCellThatMeetsTheBoxIsLarger) {
  const TriangleSoup ball = icosphere(3);
  std::mt19937 engine(7);
  const auto number = [&](double a, double b) { return a + (b - a) * static_cast<double>(engine()) / 4294967296.0; };
  FlowMeshOptions options = outside(0.2);
  const Box3& d = options.domain;
  std::vector<Box3> boxes{{d.lower - Vec3{1, 1, 1}, {d.lower.x + 1e-3, d.upper.y, d.upper.z}}, {{d.upper.x - 1e-3, d.lower.y, d.lower.z}, d.upper + Vec3{1, 1, 1}}, {d.lower, {d.upper.x, d.lower.y + 1e-3, d.upper.z}},
                          {{d.lower.x, d.upper.y - 1e-3, d.lower.z}, d.upper}, {d.lower, {d.upper.x, d.upper.y, d.lower.z + 1e-3}}, {{d.lower.x, d.lower.y, d.upper.z - 1e-3}, d.upper}};
  for (int i = 0; i < 6; ++i) {
    const Vec3 lower{number(d.lower.x, d.upper.x - 0.3), number(d.lower.y, d.upper.y - 0.3), number(d.lower.z, d.upper.z - 0.3)};
    boxes.push_back({lower, lower + Vec3{0.3, 0.3, 0.3}});
  }
  for (const Box3& box : boxes) {
    SCOPED_TRACE(text_of(box));
    options.refinements = {{box, 0.2}};
    const FlowMesh made = flow_mesh(ball, {}, {}, options);
    EXPECT_TRUE(made.notes.empty());
    const CellGeometry g = cell_geometry(made.mesh.mesh, cell_faces(made.mesh.mesh));
    double largest = 0;
    for (std::size_t c = 0; c < made.mesh.cells(); ++c)
      if (overlap(g.box[c], box)) largest = std::max(largest, g.box[c].longest_side());
    EXPECT_GT(largest, 0);
    EXPECT_LE(largest, 0.2 * 1.35);  // with the stretch, and what nodes have moved
  }
}

TEST(FlowMeshRefinement, BesideTheMeshIsDroppedAndTold) {
  const TriangleSoup ball = icosphere(3);
  for (const bool around : {false, true}) {
    FlowMeshOptions options = around ? outside(0.3) : inside(0.3);
    const FlowMesh without = flow_mesh(ball, {}, {}, options);
    options.refinements = {{{{6, -1, -1}, {8, 1, 1}}, 0.05}};
    const FlowMesh made = flow_mesh(ball, {}, {}, options);
    ASSERT_EQ(made.notes.size(), 1u);
    EXPECT_TRUE(contains(made.notes[0], text_of(options.refinements[0].box))) << made.notes[0];
    EXPECT_EQ(made.mesh.mesh.points, without.mesh.mesh.points);
    EXPECT_EQ(made.mesh.mesh.owner, without.mesh.mesh.owner);
  }
}

// Around the model there is nothing to be refined: not more cells than with a box somewhat larger than the model, and within its memory.
TEST(FlowMeshRefinement, IsCutToWhatIsMeshed) {
  const TriangleSoup box = cube();
  const Box3 around = bounding_box(box);
  FlowMeshOptions options = inside(0.2 * around.longest_side());
  const Vec3 room = Vec3{3, 3, 3} * options.cell;
  options.refinements = {{{around.lower - room, around.upper + room}, 0.25 * options.cell}};
  const FlowMesh tight = flow_mesh(box, {}, {}, options);
  const double cells = 4 / 0.2 + 2 * 2 * 4 + 4;  // along a side: the model's, the room around it, octants
  options.memory_bytes = static_cast<std::uint64_t>(1.3 * (800 * cells * cells * cells + 9000 * 7 * 400));
  for (const double far : {2.5, 1e3, 1e30}) {
    options.refinements[0].box = cube_about({0, 0, 0}, far * around.longest_side());
    const FlowMesh made = flow_mesh(box, {}, {}, options);
    EXPECT_EQ(made.mesh.cells(), tight.mesh.cells()) << far;
    EXPECT_NEAR(mesh_quality(made.mesh).volume, signed_volume(box), 0.01 * signed_volume(box));
  }
}

// The coarsest are what there is at most.
TEST(FlowMeshRefinement, OfCellsLargerThanAllDoesNothing) {
  const TriangleSoup ball = icosphere(3);
  FlowMeshOptions options = inside(0.1);
  const FlowMesh without = flow_mesh(ball, {}, {}, options);
  for (const int power : {4, 5, 33, 64, 65, 300}) {
    options.refinements = {{cube_about({0, 0, 0}, 1e30), std::ldexp(options.cell, power)}};
    EXPECT_EQ(flow_mesh(ball, {}, {}, options).mesh.mesh.points, without.mesh.mesh.points) << power;
  }
}

TEST(FlowMeshRefinement, ErrorsNameTheBoxAndWhatWouldDo) {
  const TriangleSoup ball = icosphere(3);
  const Box3 box{{0.5, 0.25, 0.125}, {0.75, 0.5, 0.5}};
  FlowMeshOptions options = inside(0.1);
  options.refinements = {{{{0, 0, 0}, {1, 1, 1}}, 0.05}, {box, 1e-4}};
  const Error fine = error_of(ball, options);
  EXPECT_EQ(fine.code(), ErrorCode::usage);
  EXPECT_TRUE(contains(fine.what(), text_of(box)) && contains(fine.what(), "0.0001") && contains(fine.what(), "0.1")) << fine.what();
  EXPECT_TRUE(contains(fine.hint(), "0.003125")) << fine.hint();
  options.refinements = {{box, 0.1 / 32}};
  options.memory_bytes = 40'000'000;
  const Error large = error_of(ball, options);
  EXPECT_EQ(large.code(), ErrorCode::memory_limit);
  EXPECT_TRUE(contains(large.what(), text_of(box)) && contains(large.what(), "0.003125")) << large.what();
  std::smatch cells;
  const std::string hint = large.hint();
  ASSERT_TRUE(std::regex_search(hint, cells, std::regex("give the box cells of ([0-9.e-]+)"))) << hint;
  options.refinements[0].cell = std::stod(cells[1]) * 1.0001;
  EXPECT_GT(flow_mesh(ball, {}, {}, options).mesh.cells(), 0u);
}

TEST(FlowMeshMemory, ACellThatWouldFitIsNamed) {
  const TriangleSoup ball = icosphere(3);
  FlowMeshOptions options = inside(0.03);
  options.memory_bytes = 10'000'000;
  const Error error = error_of(ball, options);
  EXPECT_EQ(error.code(), ErrorCode::memory_limit);
  EXPECT_TRUE(std::regex_search(std::string(error.what()), std::regex("cells of 0\\.03 takes about [0-9.]+ GB; the budget is"))) << error.what();
  std::smatch cell;
  const std::string hint = error.hint();
  ASSERT_TRUE(std::regex_search(hint, cell, std::regex("--cell ([0-9.e-]+) or larger"))) << hint;
  options.cell = std::stod(cell[1]);
  EXPECT_LT(options.cell, 0.3);
  EXPECT_GT(flow_mesh(ball, {}, {}, options).mesh.cells(), 0u);
}

// What several boxes hold is there once.
TEST(FlowMeshMemory, BoxesOverOthersTakeNothingMore) {
  const TriangleSoup ball = icosphere(3);
  const Box3 box = cube_about({0, 0, 0}, 0.5);
  FlowMeshOptions options = inside(0.1);
  options.refinements = {{box, 0.025}};
  options.memory_bytes = 90'000'000;
  const FlowMesh once = flow_mesh(ball, {}, {}, options);
  const Box3 half{box.lower, {0, box.upper.y, box.upper.z}}, other{{0, box.lower.y, box.lower.z}, box.upper};
  options.refinements = {{box, 0.1}, {half, 0.025}, {box, 0.025}, {box, 0.05}, {other, 0.025}, {box, 0.025}, {cube_about({0, 0, 0}, 0.4), 0.025}};
  EXPECT_EQ(flow_mesh(ball, {}, {}, options).mesh.mesh.points, once.mesh.mesh.points);
  options.refinements = {{box, 0.1}, {box, 0.025}, {{{-0.5, -0.5, 0.2}, {0.5, 0.5, 1}}, 0.025}};
  options.memory_bytes = 60'000'000;
  const Error error = error_of(ball, options);
  EXPECT_EQ(error.code(), ErrorCode::memory_limit);
  EXPECT_TRUE(contains(error.what(), text_of(box))) << error.what();  // what is there of the third is less
}

// The level set's band is wider where flat surface may have larger cells.
TEST(FlowMeshMemory, TheBandCounts) {
  const TriangleSoup ball = icosphere(3);
  FlowMeshOptions options = inside(0.05);
  options.memory_bytes = static_cast<std::uint64_t>(1.2 * (9000 * area(ball) / (0.05 * 0.05) + 800 * 8 * 8 * 8));
  EXPECT_GT(flow_mesh(ball, {}, {}, options).mesh.cells(), 0u);
  options.flat_levels = 4;
  EXPECT_EQ(error_of(ball, options).code(), ErrorCode::memory_limit);
}

// No more than a box holds is listed before somebody looks whether there is room for it.
TEST(FlowMeshMemory, LargestCellsOfAHugeDomainCount) {
  const TriangleSoup ball = icosphere(3);
  FlowMeshOptions options = inside(0.1);
  options.side = MeshSide::outside;
  options.domain = cube_about({0, 0, 0}, 1000);
  options.coarsest_level = 0;
  options.memory_bytes = 4'000'000'000;
  const Error error = error_of(ball, options);
  EXPECT_EQ(error.code(), ErrorCode::memory_limit);
  EXPECT_TRUE(contains(error.hint(), "--coarsest")) << error.hint();
}

TEST(FlowMeshMemory, AreaWithinABox) {
  const TriangleSoup ball = icosphere(3);
  double sum = 0;
  for (int o = 0; o < 8; ++o) {
    const auto side = [&](int bit) { return o >> bit & 1 ? 2.0 : -2.0; };
    Box3 box;
    box.extend(Vec3{0.1, 0.2, -0.15});
    box.extend(Vec3{side(0), side(1), side(2)});
    sum += area_within(ball, box);
  }
  EXPECT_NEAR(sum, area(ball), 1e-12 * area(ball));
  const TriangleSoup box = cube();
  const Box3 all = bounding_box(box);
  const double a = all.longest_side();
  EXPECT_NEAR(area_within(box, {all.lower - Vec3{1, 1, 1}, {all.upper.x + 1, all.upper.y + 1, all.lower.z + 0.25 * a}}), (1 + 4 * 0.25) * a * a, 1e-12);
}

// As many cells as are asked for are enough, however their number is rounded; where they are not there, the side is named.
TEST(FlowMeshDomain, RoomOfExactlyFourCellsIsEnough) {
  TriangleSoup box = cube();
  const Box3 was = bounding_box(box);
  for (Vec3& p : box.points) p = (p - was.lower) / was.longest_side();
  FlowMeshOptions options = inside(0.1);
  options.side = MeshSide::outside;
  options.domain = {{-0.4, -0.4, -0.4}, {1.4, 1.4, 1.4}};  // 1.4 - 1 is less than 0.4
  const FlowMesh made = flow_mesh(box, {}, {}, options);
  EXPECT_TRUE(mesh_quality(made.mesh).ok);
  EXPECT_NEAR(mesh_quality(made.mesh).volume, 1.8 * 1.8 * 1.8 - 1, 0.01);
  options.domain.upper.y = 1.39;
  const Error near = error_of(box, options);
  EXPECT_EQ(near.code(), ErrorCode::usage);
  for (const char* part : {"too near", "yMax", "0.39", "0.4,"}) EXPECT_TRUE(contains(near.what(), part)) << near.what();
  options.domain.lower.z = 0.5;
  const Error cut = error_of(box, options);
  for (const char* part : {"cuts", "zMin", "none"}) EXPECT_TRUE(contains(cut.what(), part)) << cut.what();
}

// Asks to stop at the n-th look of a stage.
class StopInStage : public Progress {
 public:
  StopInStage(std::string stage, int n) : stage_(std::move(stage)), left_(n) {}
  void begin_stage(std::string_view name) override { is_there_ = name == stage_; }
  bool cancelled() const override { return is_there_ && left_-- <= 0; }

 private:
  std::string stage_;
  bool is_there_ = false;
  mutable int left_;
};

TEST(FlowMeshRefinement, CanBeStoppedWhileItsCellsAreListed) {
  const TriangleSoup ball = icosphere(2);
  FlowMeshOptions options = inside(0.25);
  options.refinements = {{cube_about({0, 0, 0}, 1), 0.25 / 16}};
  StopInStage stop("cells", 1000);
  try {
    flow_mesh(ball, {}, {}, options, stop);
    ADD_FAILURE() << "was not stopped";
  } catch (const Error& e) {
    EXPECT_EQ(e.code(), ErrorCode::interrupted);
  }
}

TEST(FlowMeshRefinement, StretchIsInvertible) {
  const DomainStretch s{{{10, 11, 12}, {20, 21, 22}}, {{0, 0, 0}, {32, 32, 32}}, {{-1.5, 0.75, 0}, {33.25, 31, 32}}};
  for (double x = 0; x <= 32; x += 0.5) {
    const Vec3 q{x, 32 - x, x / 2}, r = s.to_domain(q);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(s.to_lattice(r)[a], q[a], 1e-12);
    if (x >= 10 && x <= 20) {
      EXPECT_EQ(r.x, x);
    }
  }
  EXPECT_EQ(s.to_domain({0, 0, 0}).x, -1.5);
  EXPECT_EQ(s.to_domain({32, 32, 32}).x, 33.25);
}

// Sizes tell of the mesh, not of the octree, which is larger.
TEST(FlowMeshLevels, CountCellsOfTheMesh) {
  const TriangleSoup ball = icosphere(3);
  for (const bool around : {false, true})
    for (const double finer : {1.0, 0.25}) {
      FlowMeshOptions options = around ? outside(0.2) : inside(0.1);
      if (finer < 1) options.refinements = {{cube_about({0, 0, 1}, 0.2), finer * options.cell}};
      const FlowMesh made = flow_mesh(ball, {}, {}, options);
      std::uint64_t sum = 0;
      for (const std::uint64_t n : made.cells_of_level) sum += n;
      EXPECT_EQ(sum, made.mesh.cells());
      EXPECT_NEAR(2 * made.frame.cell, finer * options.cell, 1e-12);
      if (around) continue;  // stretched
      // Cubes are cells of the octree as they are.
      const CellGeometry g = cell_geometry(made.mesh.mesh, cell_faces(made.mesh.mesh));
      std::vector<std::uint64_t> cubes(made.cells_of_level.size(), 0);
      for (std::size_t c = 0; c < made.mesh.cells(); ++c) {
        const double level = std::log2(g.box[c].longest_side() / (2 * made.frame.cell));
        if (made.mesh.shape[c] == CellShape::hexahedron && std::abs(level - std::round(level)) < 1e-9) ++cubes.at(static_cast<std::size_t>(std::lround(level)));
      }
      for (std::size_t l = 0; l < cubes.size(); ++l) EXPECT_GE(made.cells_of_level[l], cubes[l]) << l;
      if (finer < 1) {
        EXPECT_GT(made.cells_of_level.front(), 0u);
      }
    }
}

}  // namespace
}  // namespace burnish
