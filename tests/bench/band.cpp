// What the octree and the exact signed distances of one model cost, as one line of JSON: beside the line of a peer
// (peers/) it is a comparison. scripts/run_peers runs them all.
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

#include "band_request.h"
#include "burnish/core/parallel.h"
#include "burnish/levelset/crossings.h"
#include "burnish/levelset/distance.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/levelset/sign.h"
#include "burnish/octree/grid_frame.h"
#include "burnish/surface/triangle_index.h"

namespace burnish::bench {
namespace {

constexpr double kMargin = 11;  // cells between the band and the walls, as in a run of the program

struct Band {
  SurfaceOctree grid;
  Field<float> phi;  // unsigned, or signed; only |phi| is looked at
};

// The steps of level_set_from_triangles, one by one, up to the sides of facets.
Band by_stages(const BandRequest& request, const TriangleSoup& soup, const GridFrame& frame, StageClock& clock) {
  clock.begin("lattice");
  const TriangleSoup lattice = to_lattice(soup, frame);
  clock.begin("grow");
  SurfaceOctree grid = grow_uniform_band(lattice, frame.depth, request.band);
  clock.begin("distances");
  DistanceField field = exact_distances(lattice, grid, request.band, {}, no_progress(), KeepNearest::no);
  if (request.is_signed) {
    clock.begin("crossings");
    const Field<std::uint8_t> crossed = crossed_edges(lattice, grid);
    clock.begin("classify");
    const InsideField classified = classify_nodes(grid, field.distance, crossed, lattice);
    clock.begin("sides");
    facet_sides(lattice, grid, classified.inside, facets_across_idle_edges(lattice, grid, crossed, classified.inside));
  }
  clock.end();
  return {std::move(grid), std::move(field.distance)};
}

Band at_once(const BandRequest& request, const TriangleSoup& soup, const GridFrame& frame, StageClock& clock) {
  clock.begin("band");
  LevelSet set = level_set_from_triangles(soup, frame, {.band = request.band, .room = 0, .far_field = false}).level_set;
  clock.end();
  return {std::move(set.grid), std::move(set.phi)};
}

nlohmann::ordered_json measure(const BandRequest& request, const TriangleSoup& soup) {
  const GridFrame frame = make_frame(bounding_box(soup), cell_of(request, soup), request.band + kMargin);
  StageClock clock;
  const bool is_whole = request.is_signed && !request.by_stages;
  const Band band = (is_whole ? at_once : by_stages)(request, soup, frame, clock);

  nlohmann::ordered_json line = line_of(request, "burnish", soup);
  std::size_t near = 0, active = 0;
  for (std::size_t leaf = 0; leaf < band.grid.octree.size(); ++leaf) near += band.grid.near_surface(leaf);
  for (const float phi : band.phi.values()) active += std::abs(static_cast<double>(phi)) < request.band;
  line["blocks"] = band.grid.octree.size();
  line["near_nodes"] = near * kBlockNodes;
  line["active"] = active;
  add_costs(line, clock.stages(), active);
  line["result_mb"] = std::round(1e-5 * static_cast<double>(band.grid.bytes() + band.phi.bytes())) / 10;
  return line;
}

}  // namespace
}  // namespace burnish::bench

int main(int argc, char** argv) { return burnish::bench::run_band_program(argc, argv, burnish::bench::measure); }
