#include "burnish/surface/example_shapes.h"

#include <cmath>
#include <utility>

#include "burnish/core/error.h"
#include "example_parts.h"

namespace burnish {
namespace {

using example::Scan;

enum Stream : std::uint64_t { kNoise = 1, kHoles = 2 };

void check(const ExampleOptions& options) {
  if (!(options.noise >= 0) || !std::isfinite(options.noise))
    throw Error(ErrorCode::usage, "noise of an example must be a finite number, 0 or more", "0.3 is that of a scan");
  if (options.holes < 0) throw Error(ErrorCode::usage, "number of holes of an example must be 0 or more", "0 leaves the shape closed");
}

TriangleSoup clean_shape(ExampleShape shape) {
  switch (shape) {
    case ExampleShape::sphere: return example::make_sphere();
    case ExampleShape::vase: return example::make_vase();
    case ExampleShape::knot: return example::make_knot();
    case ExampleShape::nozzle: return example::make_nozzle();
  }
  throw Error(ErrorCode::usage, "no such example shape", "sphere, vase, knot and nozzle are the shapes");
}

}  // namespace

Example make_example(ExampleShape shape, const ExampleOptions& options) {
  check(options);
  Example result;
  result.truth = clean_shape(shape);
  Scan scan = shape == ExampleShape::nozzle ? example::scan_nozzle(options.seed)
                                            : Scan{result.truth, result.truth.facets.size()};
  if (options.noise > 0) example::add_noise(scan.soup, options.noise, example::Random(options.seed, kNoise));
  if (options.holes > 0)
    example::cut_holes(scan.soup, options.holes, scan.wall_facets, example::Random(options.seed, kHoles));
  example::round_to_float(scan.soup);
  example::round_to_float(result.truth);
  result.dirty = example::unwelded(scan.soup);
  return result;
}

namespace example {

void round_to_float(TriangleSoup& soup) {
  for (Vec3& p : soup.points)
    for (int axis = 0; axis < 3; ++axis) {
      // Through memory: GCC 12 drops both conversions when it packs x and y into one vector at -O2.
      const volatile float rounded = static_cast<float>(p[axis]);
      p[axis] = static_cast<double>(rounded);
    }
}

TriangleSoup unwelded(const TriangleSoup& soup) {
  TriangleSoup result;
  result.points.reserve(3 * soup.facets.size());
  result.facets.reserve(soup.facets.size());
  for (const Facet& facet : soup.facets) {
    const auto first = static_cast<std::uint32_t>(result.points.size());
    for (const std::uint32_t p : facet) result.points.push_back(soup.points[p]);
    result.facets.push_back({first, first + 1, first + 2});
  }
  return result;
}

}  // namespace example
}  // namespace burnish
