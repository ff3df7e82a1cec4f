// Layers of flat cells at the wall of a flow mesh: the wall stays, heights are those asked for, the mesh passes checkMesh.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <set>
#include <string>
#include <tuple>
#include <vector>

#include "../support/shapes.h"
#include "burnish/core/parallel.h"
#include "burnish/volume/flow_mesh.h"
#include "burnish/volume/mesh_quality.h"

namespace burnish {
namespace {

using test::cube, test::icosphere, test::torus;

constexpr double kCell = 0.1;

FlowMesh meshed(const TriangleSoup& surface, MeshSide side, const WallLayers& layers) {
  FlowMeshOptions options;
  options.cell = kCell;
  options.side = side;
  options.domain = {{-2, -2, -2}, {2, 2, 2}};
  options.layers = layers;
  return flow_mesh(surface, {}, {}, options);
}

using Place = std::tuple<double, double, double>;

std::set<Place> wall_places(const FlowMesh& flow) {
  const PolyhedralMesh& mesh = flow.mesh.mesh;
  std::set<Place> places;
  for (std::size_t f = mesh.patches[0].first_face; f < mesh.patches[0].first_face + mesh.patches[0].faces; ++f)
    for (const std::uint32_t p : mesh.face(f)) places.insert({mesh.points[p].x, mesh.points[p].y, mesh.points[p].z});
  return places;
}

double volume_of(const FlowMesh& flow) {
  double sum = 0;
  for (const double v : cell_geometry(flow.mesh.mesh, cell_faces(flow.mesh.mesh)).volume) sum += v;
  return sum;
}

// The volumes of the prisms behind a face of the wall, from the wall inwards; of each the next one is across the face that has no point of the last.
std::vector<double> column_volumes(const FlowMesh& flow, const CellFaces& faces, const CellGeometry& geometry, std::size_t face, int count) {
  const PolyhedralMesh& mesh = flow.mesh.mesh;
  std::vector<double> volumes;
  std::uint32_t cell = mesh.owner[face];
  for (int k = 0; k < count; ++k) {
    volumes.push_back(geometry.volume[cell]);
    const auto last = mesh.face(face);
    for (const std::uint32_t f : faces[cell]) {
      const auto points = mesh.face(f);
      if (points.size() != last.size() || std::any_of(points.begin(), points.end(), [&](std::uint32_t p) { return std::find(last.begin(), last.end(), p) != last.end(); })) continue;
      face = f;
      break;
    }
    cell = mesh.owner[face] == cell ? (face < mesh.internal_faces() ? mesh.neighbour[face] : cell) : mesh.owner[face];
  }
  return volumes;
}

class LayersOf : public testing::TestWithParam<std::tuple<std::string, MeshSide>> {
 protected:
  static TriangleSoup surface() {
    const std::string& name = std::get<0>(GetParam());
    return name == "sphere" ? icosphere(4) : name == "torus" ? torus(96, 48) : cube();
  }
  static bool has_creases() { return std::string(std::get<0>(GetParam())) == "cube"; }
  static MeshSide side() { return std::get<1>(GetParam()); }
};

TEST_P(LayersOf, KeepTheWallTheVolumeAndPassCheckMesh) {
  const WallLayers layers{3, 0.015, 1.2};
  const FlowMesh with = meshed(surface(), side(), layers), without = meshed(surface(), side(), {});
  EXPECT_EQ(wall_places(with), wall_places(without));
  EXPECT_NEAR(volume_of(with) / volume_of(without), 1, 1e-10);
  EXPECT_TRUE(mesh_quality(with.mesh).ok);
  EXPECT_NEAR(with.layers.wall_area / area(surface()), 1, 0.02);
  if (!has_creases()) {
    EXPECT_GE(with.layers.covered_area / with.layers.wall_area, 0.95);
  }
  EXPECT_LT(with.layers.greatest_first, 1.5 * layers.first);
  EXPECT_EQ(without.layers.wall_area, 0);
}

INSTANTIATE_TEST_SUITE_P(Shapes, LayersOf, testing::Combine(testing::Values(std::string("sphere"), std::string("torus"), std::string("cube")), testing::Values(MeshSide::inside, MeshSide::outside)));

// [T-LAYER-1] Outside a sphere of radius 1 a column's volume grows with (1 + d)^3, d the distance.
TEST(WallLayers, HeightsGrowByTheRatio) {
  const WallLayers layers{4, 0.008, 1.3};
  const FlowMesh flow = meshed(icosphere(4), MeshSide::outside, layers);
  const PolyhedralMesh& mesh = flow.mesh.mesh;
  const CellFaces faces = cell_faces(mesh);
  const CellGeometry geometry = cell_geometry(mesh, faces);
  std::vector<double> sums(4, 0);
  for (std::size_t f = mesh.patches[0].first_face; f < mesh.patches[0].first_face + mesh.patches[0].faces; ++f) {
    const std::vector<double> v = column_volumes(flow, faces, geometry, f, 4);
    for (std::size_t k = 0; k < 4; ++k) sums[k] += v[k];
  }
  ASSERT_GT(flow.layers.covered_area / flow.layers.wall_area, 0.99);
  double d = 0, height = layers.first;
  for (std::size_t k = 0; k < 4; ++k) {
    const double exact = 4 * 3.14159265358979 / 3 * (std::pow(1 + d + height, 3) - std::pow(1 + d, 3));
    EXPECT_NEAR(sums[k] / exact, 1, 0.03) << "layer " << k;
    d += height, height *= layers.ratio;
  }
}

TEST(WallLayers, MoreThanAGapHasRoomForGoesUnlayeredOrLow) {
  // A plate three cells thick: layers of a cell on both sides leave it one.
  TriangleSoup plate = cube();
  for (Vec3& p : plate.points) p.z *= 3 * kCell;
  const FlowMesh flow = meshed(plate, MeshSide::inside, {2, 0.5 * kCell, 1});
  EXPECT_TRUE(mesh_quality(flow.mesh).ok);
  EXPECT_NEAR(volume_of(flow) / (3 * kCell), 1, 0.02);
}

// What has no layers passes; with them it has to as well, with fewer columns.
TEST(WallLayers, NeverMakeAMeshFail) {
  for (const double angle : {0.7, 1.1}) {
    const Vec3 axis = Vec3{1, 2, 3} / std::sqrt(14.0);
    const TriangleSoup box = test::mapped(cube(), [&](const Vec3& p) { return p * std::cos(angle) + cross(axis, p) * std::sin(angle) + axis * (dot(axis, p) * (1 - std::cos(angle))); });
    for (const int count : {2, 4}) {
      FlowMeshOptions options;
      options.cell = 0.4;
      options.layers = {.count = count, .first = 0.09, .ratio = 1.2};
      const FlowMesh flow = flow_mesh(box, {}, {}, options);
      EXPECT_TRUE(mesh_quality(flow.mesh).ok) << angle << ", " << count;
    }
  }
}

TEST(WallLayers, SameBitsForAnyNumberOfThreads) {
  const auto run = [](int threads) {
    const ThreadLimit limit(threads);
    return meshed(torus(64, 32), MeshSide::outside, {3, 0.015, 1.2});
  };
  const FlowMesh one = run(1), three = run(3);
  ASSERT_EQ(one.mesh.mesh.points.size(), three.mesh.mesh.points.size());
  EXPECT_TRUE(one.mesh.mesh.points == three.mesh.mesh.points);
  EXPECT_EQ(one.mesh.mesh.face_points, three.mesh.mesh.face_points);
  EXPECT_EQ(one.mesh.mesh.owner, three.mesh.mesh.owner);
}

}  // namespace
}  // namespace burnish
