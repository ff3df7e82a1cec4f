// Certified closest facets: a search in floating point, with bounds on its errors, and a decision in CGAL's rationals.
#include "burnish/surface/exact_distance.h"

#include <CGAL/Exact_rational.h>
#include <CGAL/Simple_cartesian.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <utility>
#include <vector>

#include "burnish/surface/triangle_index.h"

namespace burnish {
namespace {

using Rational = CGAL::Exact_rational;
// Not a filtered or lazy kernel: numbers belong to one query, so that threads have nothing in common.
using Kernel = CGAL::Simple_cartesian<Rational>;

constexpr double kInfinity = std::numeric_limits<double>::infinity();

Kernel::Point_3 to_cgal(const Vec3& p) { return {Rational(p.x), Rational(p.y), Rational(p.z)}; }

double max_norm(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

Rational squared_distance_to_segment(const Kernel::Point_3& p, const Kernel::Point_3& a, const Kernel::Point_3& b) {
  return a == b ? CGAL::squared_distance(p, a) : CGAL::squared_distance(p, Kernel::Segment_3(a, b));
}

Rational squared_distance_to_facet(const Kernel::Point_3& p, const TriangleSoup& soup, std::uint32_t f) {
  const Kernel::Point_3 a = to_cgal(soup.corner(f, 0)), b = to_cgal(soup.corner(f, 1)), c = to_cgal(soup.corner(f, 2));
  if (!CGAL::collinear(a, b, c)) return CGAL::squared_distance(p, Kernel::Triangle_3(a, b, c));
  const Rational ab = squared_distance_to_segment(p, a, b), bc = squared_distance_to_segment(p, b, c),
                 ca = squared_distance_to_segment(p, c, a);
  return std::min({ab, bc, ca});
}

// The doubles next to x >= 0 on either side of it; twice x itself if it is one.
std::array<double, 2> enclosing_doubles(const Rational& x) {
  double low = CGAL::to_double(x);
  if (!std::isfinite(low)) return {std::numeric_limits<double>::max(), kInfinity};
  while (Rational(low) > x) low = std::nextafter(low, 0.0);
  double high = low;
  while (Rational(high) < x) high = std::nextafter(high, kInfinity);
  return {low, high};
}

double nearest_double(const Rational& x) {
  const auto [low, high] = enclosing_doubles(x);
  return !std::isfinite(high) || Rational(low) + Rational(high) < x + x ? high : low;
}

// True if facet f is farther from p than the root of `squared` for certain. All of it lies behind a plane across the
// direction to its closest point, as far as its closest corner; that direction need not be accurate for this to be a
// bound. A dot product of differences is off by less than 12 * 2^-53 of the product of the max norms. [T-SELF-1]
bool surely_farther(const Vec3& p, const TriangleSoup& soup, std::uint32_t f, double squared) {
  const Vec3 a = soup.corner(f, 0) - p, b = soup.corner(f, 1) - p, c = soup.corner(f, 2) - p;
  const Vec3 toward = closest_point_on_triangle(p, soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2)) - p;
  const double length = max_norm(toward), reach = std::max({max_norm(a), max_norm(b), max_norm(c)});
  // Otherwise products may overflow, or lose bits to underflow.
  if (!(length > 1e-60) || !(reach < 1e60)) return false;
  const double low = std::min({dot(toward, a), dot(toward, b), dot(toward, c)}) - 1e-14 * length * reach;
  return low > 1e-130 && low * low > squared * squared_norm(toward) * (1 + 1e-14);
}

}  // namespace

ExactDistance::ExactDistance(const TriangleSoup& soup)
    : soup_(soup), own_(std::make_unique<TriangleIndex>(soup)), index_(*own_) {}

ExactDistance::ExactDistance(const TriangleSoup& soup, const TriangleIndex& index) : soup_(soup), index_(index) {}

ExactDistance::~ExactDistance() = default;

ExactDistance::Closest ExactDistance::closest(const Vec3& p) const {
  const std::uint32_t guess = index_.closest(p).facet;
  if (guess == kNoFacet) return {};
  const Kernel::Point_3 exact_p = to_cgal(p);
  Closest best;
  best.facet = guess;
  Rational least = squared_distance_to_facet(exact_p, soup_, guess);
  double bound = enclosing_doubles(least)[1];
  // The index rounds the squared distance to a box by less than 10 * 2^-53 of it, or, where squares underflow, by less than
  // the smallest normal double: no facet in the ball is passed over.
  std::vector<std::uint32_t> facets;
  index_.facets_near(p, bound * (1 + 1e-14) + std::numeric_limits<double>::min(), facets);
  for (const std::uint32_t f : facets) {
    if (f == guess || surely_farther(p, soup_, f, bound)) continue;
    Rational squared = squared_distance_to_facet(exact_p, soup_, f);
    if (squared > least || (squared == least && f > best.facet)) continue;
    best.facet = f;
    least = std::move(squared);
    bound = enclosing_doubles(least)[1];
  }
  best.squared_distance = nearest_double(least);
  best.point = closest_point_on_triangle(p, soup_.corner(best.facet, 0), soup_.corner(best.facet, 1), soup_.corner(best.facet, 2));
  return best;
}

}  // namespace burnish
