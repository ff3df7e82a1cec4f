// What the example shapes are made of. Private to src/surface/example_*.cpp.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/scramble.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish::example {

inline constexpr double kPi = 3.14159265358979323846;

// SplitMix64 (Steele, Lea and Flood, 2014). Integer and exactly rounded operations only, so that it gives
// the same numbers everywhere, which the distributions of the standard library do not promise.
class Random {
 public:
  explicit Random(std::uint64_t seed, std::uint64_t stream = 0)
      : state_(scramble(seed) + scramble(~stream)) {}

  std::uint64_t bits() { return scramble(state_ += kScrambleStep); }
  // Uniform in [0, 1).
  double uniform() { return static_cast<double>(bits() >> 11) * 0x1p-53; }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  // Uniform in 0 ... n-1.
  std::size_t below(std::size_t n) { return static_cast<std::size_t>(uniform() * static_cast<double>(n)); }
  // Mean 0, variance 1: the sum of twelve uniform numbers. Needs no logarithm, whose last bit differs
  // between systems; differs from a Gaussian beyond 3 standard deviations, and ends at 6.
  double gaussian() {
    double sum = -6;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t state_;
};

// Points on a circle about an axis parallel to z, counter-clockwise seen from above.
struct Ring {
  std::uint32_t first = 0;     // its first point in the soup; the others follow
  std::vector<double> angles;  // ascending, spanning less than a full turn, the first near 0

  std::uint32_t point(std::size_t i) const { return first + static_cast<std::uint32_t>(i % angles.size()); }
  double angle(std::size_t i) const { return i < angles.size() ? angles[i] : angles[0] + 2 * kPi; }
};

// `count` angles from 0, evenly spread.
std::vector<double> even_angles(int count);
// Adds the points of a ring about `center` to the soup.
Ring add_ring(TriangleSoup& soup, const Vec3& center, double radius, std::vector<double> angles);
// Adds the band of facets between two rings. In a drawing with z up and the axis at the left, outside is
// to the right of the way from a to b: up the outer wall of a solid, down the wall of its bore.
void join(TriangleSoup& soup, const Ring& a, const Ring& b);
// Adds the fan of facets from a pole to the ring that follows it / from a ring to the pole that ends the way.
void open_with_pole(TriangleSoup& soup, const Vec3& pole, const Ring& ring);
void close_with_pole(TriangleSoup& soup, const Ring& ring, const Vec3& pole);

TriangleSoup make_sphere();
TriangleSoup make_vase();
TriangleSoup make_knot();
TriangleSoup make_nozzle();

// Negative in the metal of the nozzle that make_nozzle() tessellates, positive outside and in the bore;
// the distance to within 5 % near the surface.
double nozzle_distance(const Vec3& p);

// The nozzle as scanned: the wall's facets come first, then those of the stray fragments.
struct Scan {
  TriangleSoup soup;
  std::size_t wall_facets = 0;
};
Scan scan_nozzle(std::uint64_t seed);

// The zero surface of values on the nodes of a regular grid, by marching tetrahedra: closed, oriented
// towards positive values, free of self-intersections. No value is zero; values on the border are positive.
struct Grid {
  std::size_t nx = 0, ny = 0, nz = 0;
  double cell = 0;
  Vec3 lower;
  std::vector<double> values;  // x fastest

  std::size_t node(std::size_t i, std::size_t j, std::size_t k) const { return (k * ny + j) * nx + i; }
  Vec3 position(std::size_t n) const {
    return lower + Vec3{static_cast<double>(n % nx), static_cast<double>(n / nx % ny),
                        static_cast<double>(n / (nx * ny))} * cell;
  }
};
TriangleSoup zero_surface(const Grid& grid);

// Moves each point along its normal by a normally distributed distance. `edges` is the standard
// deviation in mean edges. Points must be shared by their facets.
void add_noise(TriangleSoup& soup, double edges, Random random);
// Cuts round holes about points of the first `seed_facets` facets. Points must be shared by their facets.
void cut_holes(TriangleSoup& soup, int holes, std::size_t seed_facets, Random random);

// Rounds every coordinate to float32.
void round_to_float(TriangleSoup& soup);
// The soup with three points for every facet, as STL has it.
TriangleSoup unwelded(const TriangleSoup& soup);

}  // namespace burnish::example
