// The same distances by asking CGAL's AABB tree (Alliez, Tayeb, Wormser) for every node of the band: what one would do without a
// method of one's own. Unsigned, and on one thread.
//
// Asking for all nodes would take minutes, so a sample is asked for (--sample, evenly over the nodes in Morton order) and its time is
// multiplied up: `cpu_seconds` is extrapolated, `query_ns` is measured. Building the tree is measured apart and in full.
// `max_difference` is how far Burnish's distances are from CGAL's, in cells, over the sample.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/version.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "band_request.h"
#include "burnish/levelset/distance.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/octree/grid_frame.h"

namespace burnish::bench {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Kernel::Triangle_3>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>>>;

constexpr double kMargin = 11;

Kernel::Point_3 point(const Vec3& p) { return {p.x, p.y, p.z}; }

struct Node {
  Kernel::Point_3 at;
  float distance;  // as Burnish has it
};

struct Nodes {
  std::vector<Node> sample;
  std::size_t active = 0;
};

// Of the nodes that burnish_band counts as active: how many, and a sample.
Nodes nodes_of_band(const BandRequest& request, const TriangleSoup& lattice, int depth) {
  SurfaceOctree grid = grow_uniform_band(lattice, depth, request.band);
  grid.layout.clear();  // every leaf stores its values, in order
  const Field<float> distance = exact_distances(lattice, grid, request.band).distance;
  const auto is_active = [&](float d) { return static_cast<double>(d) < request.band; };
  Nodes nodes;
  nodes.active = static_cast<std::size_t>(std::count_if(distance.values().begin(), distance.values().end(), is_active));
  const std::size_t every = std::max<std::size_t>(1, nodes.active / std::max<std::size_t>(1, request.sample));
  std::size_t n = 0;
  for (std::size_t i = 0; i < distance.values().size(); ++i) {
    if (!is_active(distance.values()[i]) || n++ % every != 0) continue;
    const int in_block = static_cast<int>(i % kBlockNodes);
    const LatticeNode node = lattice_node(grid.octree, i / kBlockNodes, in_block % kBlockSide, in_block / kBlockSide % kBlockSide,
                                          in_block / (kBlockSide * kBlockSide));
    const Vec3 at{static_cast<double>(node.x), static_cast<double>(node.y), static_cast<double>(node.z)};
    nodes.sample.push_back({point(at), distance.values()[i]});
  }
  return nodes;
}

nlohmann::ordered_json measure(const BandRequest& request, const TriangleSoup& soup) {
  const GridFrame frame = make_frame(bounding_box(soup), cell_of(request, soup), request.band + kMargin);
  const TriangleSoup lattice = to_lattice(soup, frame);
  const Nodes nodes = nodes_of_band(request, lattice, frame.depth);
  Triangles triangles;
  triangles.reserve(soup.facets.size());
  for (std::size_t f = 0; f < lattice.facets.size(); ++f)
    triangles.emplace_back(point(lattice.corner(f, 0)), point(lattice.corner(f, 1)), point(lattice.corner(f, 2)));
  forget_peak();

  StageClock clock;
  clock.begin("build");
  Tree tree(triangles.begin(), triangles.end());
  tree.accelerate_distance_queries();
  tree.build();
  clock.begin("queries");
  double worst = 0;
  for (const Node& node : nodes.sample) {
    const double distance = std::sqrt(CGAL::squared_distance(node.at, tree.closest_point(node.at)));
    worst = std::max(worst, std::abs(distance - static_cast<double>(node.distance)));
  }
  clock.end();

  std::vector<StageCost> stages = clock.stages();
  const double scale = static_cast<double>(nodes.active) / static_cast<double>(std::max<std::size_t>(1, nodes.sample.size()));
  const double query = 1e9 * stages[1].cpu_seconds * scale / static_cast<double>(std::max<std::size_t>(1, nodes.active));
  stages[1].cpu_seconds *= scale;
  stages[1].wall_seconds *= scale;
  nlohmann::ordered_json line = line_of(request, "cgal", soup);
  line["version"] = CGAL_VERSION_STR;
  line["signed"] = false;
  line["threads"] = 1;
  line["active"] = nodes.active;
  line["sample"] = nodes.sample.size();
  line["extrapolated"] = scale > 1;
  add_costs(line, stages, nodes.active);
  line["query_ns"] = std::round(query);
  line["max_difference"] = worst;
  return line;
}

}  // namespace
}  // namespace burnish::bench

int main(int argc, char** argv) { return burnish::bench::run_band_program(argc, argv, burnish::bench::measure); }
