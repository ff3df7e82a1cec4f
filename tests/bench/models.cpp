#include "models.h"

#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/example_shapes.h"
#include "burnish/surface/weld.h"

namespace burnish::bench {

const TriangleSoup& nozzle_as_read() {
  static const TriangleSoup soup = make_example(ExampleShape::nozzle, {}).dirty;
  return soup;
}

const TriangleSoup& knot_as_read() {
  static const TriangleSoup soup = make_example(ExampleShape::knot, {}).dirty;
  return soup;
}

const TriangleSoup& nozzle() {
  static const TriangleSoup soup = weld(nozzle_as_read());
  return soup;
}

const TriangleSoup& knot() {
  static const TriangleSoup soup = weld(knot_as_read());
  return soup;
}

GridFrame knot_frame() {
  const Box3 box = bounding_box(knot());
  return make_frame(box, box.longest_side() / 256, 16);
}

const TriangleSoup& lattice_knot() {
  static const TriangleSoup soup = to_lattice(knot(), knot_frame());
  return soup;
}

}  // namespace burnish::bench
