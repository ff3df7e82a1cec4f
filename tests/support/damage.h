// Ways to damage a clean shape, each as real files are damaged, each by itself and made to measure.
//
// All take a clean soup: closed, 2-manifold, oriented outwards, points shared (support/shapes.h, `weld`). Where chance has a
// part, the same seed gives the same soup on every machine. Lengths are in *local edges*: the mean edge of the facet
// concerned. Damage that needs no function is composed: `flipped`, `merged(a, a)`, `merged(a, flipped(inner))`.
#pragma once

#include <cstddef>
#include <cstdint>
#include <random>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish::test {

// The same numbers on every machine, which distributions of the standard library do not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}
  double uniform(double low, double high) { return low + (high - low) * static_cast<double>(engine_() >> 11) * 0x1p-53; }
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(engine_() % n); }
  // Uniform in the unit ball.
  Vec3 in_ball();

 private:
  std::mt19937_64 engine_;
};

// --- facets one by one ---------------------------------------------------------------------------

// Every facet by itself, each of its corners moved on its own by up to `edges` local edges: no two facets meet any more.
TriangleSoup unwelded_and_jittered(const TriangleSoup& soup, double edges, std::uint64_t seed);
// Every point moved by up to `edges` mean edges of the whole soup; facets go on sharing points.
TriangleSoup jittered(const TriangleSoup& soup, double edges, std::uint64_t seed);
// Each facet is gone, turned over, or there a second time, with the probability `share`. Copies come last.
TriangleSoup without_random_facets(const TriangleSoup& soup, double share, std::uint64_t seed);
TriangleSoup with_random_flips(TriangleSoup soup, double share, std::uint64_t seed);
TriangleSoup with_random_copies(TriangleSoup soup, double share, std::uint64_t seed);
// The same facets in another order, each beginning with any of its corners.
TriangleSoup shuffled(TriangleSoup soup, std::uint64_t seed);

// --- holes and cracks ----------------------------------------------------------------------------

// Without the facets nearest to a random facet's centre, up to `share` of the area; those that can be reached from there
// over edges within the same distance, so that a hole in a wall does not go through to its other side.
TriangleSoup with_round_hole(const TriangleSoup& soup, double share, std::uint64_t seed);
// T-junctions: a `share` of the facets is cut in two at a point on one of their edges, which the facet across does not
// have and which lies up to `off` edges beside it: the cut facet's two halves leave a crack, or overlap.
TriangleSoup with_t_junctions(TriangleSoup soup, double share, double off, std::uint64_t seed);
// `count` slits: the surface is cut along paths of `steps` edges, and the left bank drawn back by `gap` local edges.
TriangleSoup with_slits(TriangleSoup soup, int count, int steps, double gap, std::uint64_t seed);

// --- what should not be there --------------------------------------------------------------------

// A sheet without thickness stands on a path of `steps` edges, `height` mean edges high, connected to the solid.
TriangleSoup with_fin(TriangleSoup soup, int steps, double height, std::uint64_t seed);
// A `share` of the facets is cut in two at the middle m of an edge ab, and the facet across gets (a, b, m) put in between:
// closed as before, but for the middle's rounding without area. As many facets (a, b, b) are added.
TriangleSoup with_slivers(TriangleSoup soup, double share, std::uint64_t seed);

// --- paths ---------------------------------------------------------------------------------------

// A path of up to `steps` edges that begins at a random point, keeps to one random direction as well as it can, and
// meets no point twice.
std::vector<std::uint32_t> random_path(const TriangleSoup& soup, int steps, Random& random);

}  // namespace burnish::test
