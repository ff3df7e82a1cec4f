// The thesis' test cases, made to order: exact facet counts, optional dirt, and the clean truth.
//
//   sphere       550 facets   25 slices x 12 stacks, radius 1, a valid solid
//   vase       1,174 facets   foot, belly, neck and lip, hollow, height 3.05: a triangulation without
//                             symmetry, densest at the neck, a valid solid
//   knot      76,428 facets   a trefoil 7.5 across: a tube of 198 sections x 193 points, its
//                             cross-section an ellipse that twists along the way, with three bumps;
//                             a valid solid of genus 1
//   nozzle   496,658 facets   an injector nozzle as x-ray tomography gives it, 6 mm long, in
//                             millimetres; closed, but staircase, speckle and fragments all over
//
// Noise and holes come on top. The nozzle is the wall of a fuel injector, open at both ends (a torus
// to a topologist): needle guide, seat, sac, and an orifice off the axis. It is extracted from grey
// values on a grid of 0.041 mm, which its voxels of 2 x 2 x 3 cells leave as a staircase, and which
// noise and bright and dark voxels speckle; 48 octahedra float around it, and a few bubbles and
// crumbs come of the noise itself. Where the scan has fewer facets than the thesis' (by up to about
// 1 %), the largest facets are split in three.
//
//   const Example knot = make_example(ExampleShape::knot, {.noise = 0.2, .holes = 5});
//   const TriangleSoup input = weld(knot.dirty);
#pragma once

#include <cstdint>
#include <string_view>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

enum class ExampleShape { sphere, vase, knot, nozzle };

struct ExampleOptions {
  // Standard deviation of the noise along the normals, in mean edges. Each point moves on its own: from
  // about 0.1 (nozzle) or 0.2 (vase) on the surface begins to intersect itself.
  double noise = 0;
  // Round holes with a radius of 3 to 6 mean edges, spread over the surface. Where that would take
  // more than a sixteenth of the surface, or does not fit side by side, they get smaller, down to the
  // facets around one point; where not even those fit there are fewer.
  int holes = 0;
  // The same seed gives the same bytes, on every machine whose sine and cosine agree to 1e-15.
  // Noise and holes draw from streams of their own: asking for holes does not change the noise.
  std::uint64_t seed = 1;
};

struct Example {
  // As an STL file would hold it: every facet with three points of its own, coordinates representable
  // in float32. Orientation is outward.
  TriangleSoup dirty;
  // The clean closed shape, points shared, coordinates representable in float32: facet for facet that
  // of `dirty` before noise and holes. For the nozzle: the exact shape finely turned, 0.0003 mm from
  // its curved walls at most, without fragments.
  TriangleSoup truth;
};

// Makes an example. Throws Error{usage} when `noise` is negative or not finite, or `holes` negative.
// The nozzle takes about half a second of CPU time, the others milliseconds.
Example make_example(ExampleShape shape, const ExampleOptions& options);

}  // namespace burnish
