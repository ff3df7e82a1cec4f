// The level set's distances on real models, against exact arithmetic.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <random>

#include "burnish/core/parallel.h"
#include "burnish/io/mesh_io.h"
#include "burnish/levelset/distance.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/exact_distance.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/weld.h"
#include "support/shared_data.h"

namespace burnish {
namespace {

using namespace test;

constexpr double kBand = 3;
constexpr std::size_t kNodes = 10'000;

// A node of the octree with what the kernel says of it.
struct Node {
  Vec3 at;  // integers
  double kernel = 0;
  float stored = 0;
  std::uint32_t nearest = kNoFacet;
};

// What a node is an example of: by its distance (less than half a cell, 1.5 cells, the band; beyond), and by whether
// the closest point is inside a facet, on an edge or at a corner.
constexpr std::size_t kStrata = 10;

std::size_t stratum_of(const Node& node, const TriangleSoup& soup) {
  if (node.nearest == kNoFacet) return 9;
  const std::size_t ring = node.kernel < 0.5 ? 0 : node.kernel < 1.5 ? 1 : 2;
  const Vec3 q = closest_point_on_triangle(node.at, soup.corner(node.nearest, 0), soup.corner(node.nearest, 1), soup.corner(node.nearest, 2));
  int edges = 0;
  for (int i = 0; i < 3; ++i) {
    const Vec3 &a = soup.corner(node.nearest, i), &b = soup.corner(node.nearest, (i + 1) % 3);
    edges += norm(cross(b - a, q - a)) <= 1e-9 * norm(b - a);
  }
  return 3 * ring + static_cast<std::size_t>(std::min(edges, 2));
}

// Nodes of random leaves, one for each stratum and leaf, as evenly over the strata as the model has them.
std::vector<Node> stratified_nodes(const TriangleSoup& soup, const SurfaceOctree& grid, const DistanceField& field, std::mt19937& random) {
  std::vector<std::uint32_t> leaves;
  for (std::uint32_t leaf = 0; leaf < grid.octree.size(); ++leaf)
    if (grid.near_surface(leaf)) leaves.push_back(leaf);
  std::array<double, kBlockNodes> squared;
  std::array<std::uint32_t, kBlockNodes> nearest;
  std::array<std::size_t, kStrata> taken{};
  std::vector<Node> nodes;
  for (std::size_t tries = 0; nodes.size() < kNodes && tries < kNodes; ++tries) {
    const std::uint32_t leaf = leaves[random() % leaves.size()];
    exact_squared_distances(soup, grid, leaf, kBand, {}, squared.data(), nearest.data());
    // Towards the end the rare strata have run dry; then any node will do.
    const std::size_t most = tries < kNodes / 4 ? kNodes / kStrata : kNodes;
    std::array<bool, kStrata> here{};
    const std::size_t start = random(), stride = 2 * random() + 1;  // odd: every node has its turn
    for (std::size_t i = 0; i < kBlockNodes && nodes.size() < kNodes; ++i) {
      const std::size_t n = (start + i * stride) % kBlockNodes, side = kBlockSide;
      const LatticeNode at = lattice_node(grid.octree, leaf, int(n % side), int(n / side % side), int(n / side / side));
      const Node node{{double(at.x), double(at.y), double(at.z)}, std::sqrt(squared[n]), field.distance.block(leaf)[n], nearest[n]};
      const std::size_t stratum = stratum_of(node, soup);
      if (here[stratum] || taken[stratum] >= most) continue;
      here[stratum] = true;
      ++taken[stratum];
      nodes.push_back(node);
    }
  }
  return nodes;
}

// The promise is 1e-9 of the distance and 1e-12 of the diagonal; the float is the double's nearest. Adds to `taken` how many
// nodes of each stratum there were.
void check_distances(const TriangleSoup& model, unsigned seed, std::array<std::size_t, kStrata>& taken) {
  const Box3 box = bounding_box(model);
  const GridFrame frame = make_frame(box, box.longest_side() / 100, kBand + 11);
  const TriangleSoup soup = to_lattice(model, frame);
  const SurfaceOctree grid = grow_uniform_band(soup, frame.depth, kBand);
  const DistanceField field = exact_distances(soup, grid, kBand);
  std::mt19937 random(seed);
  const std::vector<Node> nodes = stratified_nodes(soup, grid, field, random);
  ASSERT_EQ(nodes.size(), kNodes);
  for (const Node& node : nodes) ++taken[stratum_of(node, soup)];

  const ExactDistance exact(soup);
  const double diagonal = bounding_box(soup).diagonal();
  std::vector<double> wrong(nodes.size()), rounded_wrong(nodes.size());
  parallel_for(nodes.size(), [&](std::size_t i) {
    const double expected = std::min(kBand, std::sqrt(exact.squared_distance(nodes[i].at)));
    const double allowed = 1e-9 * expected + 1e-12 * diagonal;
    wrong[i] = std::abs(nodes[i].kernel - expected) / allowed;
    rounded_wrong[i] = std::abs(nodes[i].stored - expected) / (std::ldexp(expected, -24) + allowed);
  }, 64);
  const double worst = *std::max_element(wrong.begin(), wrong.end());
  EXPECT_LE(worst, 1) << "in units of 1e-9 d + 1e-12 diagonal";
  EXPECT_LE(*std::max_element(rounded_wrong.begin(), rounded_wrong.end()), 1) << "in units of half a float's last place";
  testing::Test::RecordProperty("worst_" + std::to_string(seed), std::to_string(worst));
}

TEST(SharedDistance, KernelIsExactOnRealModels) {
  constexpr std::size_t kModels = 10;
  std::vector<Row> rows;
  for (const Row& row : manifest()) {
    const std::size_t triangles = std::stoul(row.at("triangles"));
    if (row.at("class") != "f_malformed" && triangles >= 500 && triangles <= 60'000 && std::filesystem::exists(file_of(row))) rows.push_back(row);
  }
  if (rows.size() < kModels) GTEST_SKIP() << "no evaluation data at " << data_folder();
  std::stable_sort(rows.begin(), rows.end(), [](const Row& a, const Row& b) { return std::stoul(a.at("triangles")) < std::stoul(b.at("triangles")); });
  std::array<std::size_t, kStrata> taken{};
  for (unsigned i = 0; i < kModels; ++i) {
    const Row& row = rows[i * rows.size() / kModels];
    SCOPED_TRACE(testing::Message() << row.at("name") << ", seed " << i);
    check_distances(weld(read_mesh(file_of(row).string(), {.salvage = true}).soup), i, taken);
  }
  for (std::size_t i = 0; i < kStrata; ++i) EXPECT_GE(taken[i], 50u) << "nodes of stratum " << i;
}

}  // namespace
}  // namespace burnish
