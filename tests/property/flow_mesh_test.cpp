// Volume meshes of random solids with random options.
#include "burnish/volume/flow_mesh.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>
#include <string>

#include "burnish/volume/mesh_quality.h"
#include "support/creased_shapes.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish {
namespace {

using namespace test;

struct Trial {
  TriangleSoup solid;
  FlowMeshOptions options;
  std::string text;
};

Trial random_trial(unsigned seed) {
  std::mt19937 engine(seed);
  const auto number = [&](double a, double b) { return a + (b - a) * static_cast<double>(engine()) / 4294967296.0; };
  const auto whole = [&](int a, int b) { return a + static_cast<int>(engine() % static_cast<unsigned>(b - a + 1)); };
  Trial t;
  const int shape = whole(0, 5);
  t.solid = shape == 0 ? icosphere(3) : shape == 1 ? torus(40, 20) : shape == 2 ? cube() : shape == 3 ? cone(24) : shape == 4 ? bracket(6) : wedge(number(35, 120));
  const double size = 2 / bounding_box(t.solid).longest_side();
  const Vec3 stretch{size * number(0.6, 1.2), size * number(0.6, 1.2), size * number(0.6, 1.2)}, by{number(-9, 9), number(-9, 9), number(-9, 9)};
  const double a = number(0, 3), b = number(0, 3);
  t.solid = mapped(t.solid, [&](const Vec3& p) {
    const Vec3 q{p.x * stretch.x, p.y * stretch.y, p.z * stretch.z};
    const Vec3 r{std::cos(a) * q.x - std::sin(a) * q.y, std::sin(a) * q.x + std::cos(a) * q.y, q.z};
    return by + Vec3{r.x, std::cos(b) * r.y - std::sin(b) * r.z, std::sin(b) * r.y + std::cos(b) * r.z};
  });
  const Box3 box = bounding_box(t.solid);
  FlowMeshOptions& o = t.options;
  o.cell = number(0.05, 0.09) * (shape == 4 ? 0.6 : 1);  // the bracket's plates are thin
  o.side = whole(0, 1) == 0 ? MeshSide::inside : MeshSide::outside;
  const double margin = number(0.4, 2);
  o.domain = {box.lower - Vec3{margin, margin * number(1, 1.5), margin}, box.upper + Vec3{margin * number(1, 1.5), margin, margin}};
  o.flavour = whole(0, 2) == 0 ? MeshFlavour::polyhedral : MeshFlavour::conforming;
  o.coarsest_level = whole(0, 6);
  o.cells_between_levels = whole(1, 4);
  o.flat_levels = whole(0, 2);
  if (whole(0, 1) == 0) {
    const Vec3 lower{number(box.lower.x, box.center().x), number(box.lower.y, box.center().y), number(box.lower.z, box.center().z)};
    o.refinements = {{{lower, lower + box.extent() * number(0.1, 0.4)}, o.cell * number(0.4, 3)}};
  }
  t.text = "seed " + std::to_string(seed) + ", shape " + std::to_string(shape) + (o.side == MeshSide::inside ? ", inside" : ", outside") + (o.flavour == MeshFlavour::polyhedral ? ", polyhedral" : "") +
           ", cell " + std::to_string(o.cell) + ", coarsest " + std::to_string(o.coarsest_level) + ", rows " + std::to_string(o.cells_between_levels) + ", flat " + std::to_string(o.flat_levels) +
           (o.refinements.empty() ? "" : ", refined to " + std::to_string(o.refinements[0].cell / o.cell));
  return t;
}

class RandomFlowMesh : public testing::TestWithParam<unsigned> {};

TEST_P(RandomFlowMesh, PassesTheCheckAndFillsTheSide) {
  const Trial t = random_trial(GetParam());
  SCOPED_TRACE(t.text);
  const FlowMesh made = flow_mesh(t.solid, {}, {}, t.options);
  const MeshQuality q = mesh_quality(made.mesh);
  const bool polyhedral = t.options.flavour == MeshFlavour::polyhedral;
  EXPECT_TRUE(polyhedral ? q.plain_ok : q.ok);
  for (const MeshCheck& c : q.checks) EXPECT_TRUE(c.passed || (polyhedral && c.all_geometry)) << c.name << ": " << c.failing << ", the worst " << c.worst;
  EXPECT_EQ(q.regions, 1u);
  const Vec3 e = t.options.domain.extent();
  const double solid = signed_volume(t.solid);
  EXPECT_NEAR(q.volume, t.options.side == MeshSide::inside ? solid : e.x * e.y * e.z - solid, 0.03 * solid);
}

INSTANTIATE_TEST_SUITE_P(Seeds, RandomFlowMesh, testing::Range(1u, 13u));

// Cells of several sizes anywhere at sharp edges and corners: of a large cell a point in the middle of an edge may be all that is inside.
class AskewRefinedFlowMesh : public testing::TestWithParam<unsigned> {};

TEST_P(AskewRefinedFlowMesh, PassesTheCheck) {
  std::mt19937 engine(GetParam());
  const auto number = [&](double a, double b) { return a + (b - a) * static_cast<double>(engine()) / 4294967296.0; };
  const double a = number(0, 3), b = number(0, 3);
  const TriangleSoup solid = mapped(GetParam() % 3 == 0 ? cone(16) : GetParam() % 3 == 1 ? cube() : wedge(number(40, 110)), [&](const Vec3& q) {
    const Vec3 r{std::cos(a) * q.x - std::sin(a) * q.y, std::sin(a) * q.x + std::cos(a) * q.y, q.z};
    return Vec3{r.x, std::cos(b) * r.y - std::sin(b) * r.z, std::sin(b) * r.y + std::cos(b) * r.z};
  });
  const Box3 box = bounding_box(solid);
  FlowMeshOptions o;
  o.cell = number(0.08, 0.2) * box.longest_side();
  const Vec3 lower{number(box.lower.x, box.upper.x), number(box.lower.y, box.upper.y), number(box.lower.z, box.upper.z)};
  o.refinements = {{{lower, lower + box.extent() * number(0.1, 0.5)}, o.cell * number(0.2, 0.9)}};
  if (engine() % 3 == 0) o.flavour = MeshFlavour::polyhedral;
  if (engine() % 2 == 1) {
    o.side = MeshSide::outside;
    const Vec3 margin{6 * o.cell, 6 * o.cell, 6 * o.cell};
    o.domain = {box.lower - margin, box.upper + margin};
  }
  const MeshQuality q = mesh_quality(flow_mesh(solid, {}, {}, o).mesh);
  EXPECT_TRUE(o.flavour == MeshFlavour::polyhedral ? q.plain_ok : q.ok) << "seed " << GetParam();
  EXPECT_EQ(q.regions, 1u) << "seed " << GetParam();
}

// Seeds 32 and 48 left holes.
INSTANTIATE_TEST_SUITE_P(Seeds, AskewRefinedFlowMesh, testing::Range(30u, 50u));

}  // namespace
}  // namespace burnish
