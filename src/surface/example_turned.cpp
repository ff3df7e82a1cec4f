// Shapes turned on a lathe, ring by ring: the sphere and the vase.
#include <array>
#include <cmath>
#include <utility>

#include "example_parts.h"

namespace burnish::example {

std::vector<double> even_angles(int count) {
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) angles.push_back(2 * kPi * i / count);
  return angles;
}

Ring add_ring(TriangleSoup& soup, const Vec3& center, double radius, std::vector<double> angles) {
  Ring ring{static_cast<std::uint32_t>(soup.points.size()), std::move(angles)};
  for (const double a : ring.angles)
    soup.points.push_back(center + Vec3{radius * std::cos(a), radius * std::sin(a), 0});
  return ring;
}

void join(TriangleSoup& soup, const Ring& a, const Ring& b) {
  std::size_t i = 0, j = 0;
  while (i < a.angles.size() || j < b.angles.size()) {
    const bool step_on_a =
        j == b.angles.size() || (i < a.angles.size() && a.angle(i + 1) <= b.angle(j + 1));
    if (step_on_a) {
      soup.facets.push_back({a.point(i), a.point(i + 1), b.point(j)});
      ++i;
    } else {
      soup.facets.push_back({a.point(i), b.point(j + 1), b.point(j)});
      ++j;
    }
  }
}

void open_with_pole(TriangleSoup& soup, const Vec3& pole, const Ring& ring) {
  const auto center = static_cast<std::uint32_t>(soup.points.size());
  soup.points.push_back(pole);
  for (std::size_t i = 0; i < ring.angles.size(); ++i)
    soup.facets.push_back({center, ring.point(i + 1), ring.point(i)});
}

void close_with_pole(TriangleSoup& soup, const Ring& ring, const Vec3& pole) {
  const auto center = static_cast<std::uint32_t>(soup.points.size());
  soup.points.push_back(pole);
  for (std::size_t i = 0; i < ring.angles.size(); ++i)
    soup.facets.push_back({ring.point(i), ring.point(i + 1), center});
}

TriangleSoup make_sphere() {
  constexpr int kSlices = 25;
  constexpr int kStacks = 12;
  TriangleSoup soup;
  Ring below;
  for (int stack = 1; stack < kStacks; ++stack) {
    const double latitude = kPi * stack / kStacks - kPi / 2;
    Ring ring = add_ring(soup, {0, 0, std::sin(latitude)}, std::cos(latitude), even_angles(kSlices));
    if (stack == 1) open_with_pole(soup, {0, 0, -1}, ring);
    else join(soup, below, ring);
    below = std::move(ring);
  }
  close_with_pole(soup, below, {0, 0, 1});
  return soup;
}

namespace {

// Radius of the vase's outside at height z: a belly, a wide lip and a foot added to a slender neck.
double vase_radius(double z) {
  const auto bump = [z](double height, double width) {
    const double d = (z - height) / width;
    return std::exp(-d * d);
  };
  return 0.34 + 0.68 * bump(1.0, 0.62) + 0.33 * bump(3.0, 0.35) + 0.25 * bump(0, 0.18);
}

constexpr double kVaseWall = 0.12;

struct VaseRing {
  double z;
  double inset;  // how far inside of the outside
  int points;
};

// Up the outside, over the rim, down the inside. Neighbours have different numbers of points, and a
// closed surface of rings has twice as many facets as its rings have points: 2 x 587 = 1174.
constexpr std::array<VaseRing, 33> kVaseRings{{
    {0.00, 0, 14},  {0.06, 0, 15},  {0.20, 0, 15},  {0.40, 0, 16},  {0.65, 0, 17},  {0.95, 0, 18},
    {1.25, 0, 18},  {1.52, 0, 17},  {1.74, 0, 18},  {1.90, 0, 20},  {2.02, 0, 22},  {2.12, 0, 23},
    {2.22, 0, 24},  {2.32, 0, 23},  {2.42, 0, 22},  {2.54, 0, 21},  {2.68, 0, 20},  {2.84, 0, 20},
    {3.00, 0, 20},  {3.05, kVaseWall / 2, 19},
    {2.98, kVaseWall, 18}, {2.80, kVaseWall, 17}, {2.62, kVaseWall, 17}, {2.46, kVaseWall, 18},
    {2.32, kVaseWall, 18}, {2.18, kVaseWall, 18}, {2.02, kVaseWall, 17}, {1.80, kVaseWall, 16},
    {1.50, kVaseWall, 15}, {1.10, kVaseWall, 14}, {0.75, kVaseWall, 13}, {0.45, kVaseWall, 12},
    {0.25, kVaseWall, 12},
}};

// Angles with gaps of 0.6 to 1.4 of their mean, so that no two rings' triangles line up.
std::vector<double> uneven_angles(int count, Random& random) {
  std::vector<double> angles;
  angles.reserve(static_cast<std::size_t>(count));
  for (int i = 0; i < count; ++i) angles.push_back(2 * kPi * (i + random.uniform(-0.2, 0.2)) / count);
  return angles;
}

}  // namespace

TriangleSoup make_vase() {
  Random random(1174);
  TriangleSoup soup;
  Ring previous;
  for (const VaseRing& r : kVaseRings) {
    const double radius = vase_radius(r.z) - r.inset;
    Ring ring = add_ring(soup, {0, 0, r.z}, radius, uneven_angles(r.points, random));
    if (previous.angles.empty()) open_with_pole(soup, {0, 0, r.z}, ring);
    else join(soup, previous, ring);
    previous = std::move(ring);
  }
  close_with_pole(soup, previous, {0, 0, 0.23});
  return soup;
}

}  // namespace burnish::example
