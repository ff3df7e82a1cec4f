// The thesis' test cases, made to order: exact facet counts, optional dirt, and the clean truth.
#pragma once

#include <cstdint>
#include <string_view>

#include "burnish/surface/triangle_soup.h"

namespace burnish {

enum class ExampleShape { sphere, vase, knot, nozzle };

struct ExampleOptions {
  double noise = 0;        // standard deviation of the noise along the normals, in mean edges
  int holes = 0;           // round holes of a few edges' radius, spread over the surface
  std::uint64_t seed = 1;  // the same seed gives the same bytes, everywhere
};

struct Example {
  TriangleSoup dirty;  // unwelded, coordinates representable in float32
  TriangleSoup truth;  // the clean closed shape with the same facet layout (nozzle: the smooth shape)
};

// sphere: 25 slices x 12 stacks, 550 facets. vase: 1174 facets, a closed vase without symmetry in its
// triangulation. knot: 76,428 facets, a twisted knotted tube of 198 x 193 with three protrusions.
// nozzle: 496,658 facets before holes, an injector nozzle as x-ray tomography gives it: staircase and
// speckle noise, stray fragments.
Example make_example(ExampleShape shape, const ExampleOptions& options);

}  // namespace burnish
