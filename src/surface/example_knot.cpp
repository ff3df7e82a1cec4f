// The knot: a trefoil tube, elliptic, twisted, with three bumps.
#include <array>
#include <cmath>

#include "example_parts.h"

namespace burnish::example {
namespace {

constexpr int kSections = 198;
constexpr int kAround = 193;

// The trefoil winds twice about the z axis and three times about the core circle of a torus with an
// elliptic cross-section.
constexpr double kCore = 2.2;     // radius of the core circle
constexpr double kRadial = 1.05;  // the torus' half axes: in the plane of the core circle,
constexpr double kAxial = 1.2;    // and across

constexpr double kLongAxis = 0.64;   // half axes of the tube's cross-section
constexpr double kShortAxis = 0.34;
constexpr int kTwists = 6;           // turns of the cross-section in a round

constexpr double kBumpHeight = 0.40;
constexpr double kBumpWidth = 0.75;

// A place on the knot's centre line and the frame there: `out` is the torus' normal, which is always
// perpendicular to a curve on the torus, and comes back to itself where the knot closes.
struct Frame {
  Vec3 center, out, side;
};

Vec3 unit(const Vec3& v) { return v / norm(v); }

Frame frame_at(double t) {
  const double c2 = std::cos(2 * t), s2 = std::sin(2 * t), c3 = std::cos(3 * t), s3 = std::sin(3 * t);
  const double r = kCore + kRadial * c3;
  const double dr = -3 * kRadial * s3;
  const Vec3 tangent{dr * c2 - 2 * r * s2, dr * s2 + 2 * r * c2, 3 * kAxial * c3};
  const Vec3 out = unit({kAxial * c3 * c2, kAxial * c3 * s2, kRadial * s3});
  return {{r * c2, r * s2, kAxial * s3}, out, cross(unit(tangent), out)};
}

struct Bump {
  Vec3 tip, direction;
};

// The bumps sit where the knot is farthest from the z axis and nothing is near.
std::array<Bump, 3> bumps() {
  std::array<Bump, 3> result;
  for (int i = 0; i < 3; ++i) {
    const Frame f = frame_at(2 * kPi * i / 3);
    result[static_cast<std::size_t>(i)] = {f.center + kLongAxis * f.out, f.out};
  }
  return result;
}

// Zero with its first two derivatives at the bump's edge, so that other strands stay as they are.
Vec3 raised(Vec3 p, const std::array<Bump, 3>& all) {
  Vec3 shift;
  for (const Bump& bump : all) {
    const double q = 1 - squared_norm(p - bump.tip) / (kBumpWidth * kBumpWidth);
    if (q > 0) shift += kBumpHeight * q * q * q * bump.direction;
  }
  return p + shift;
}

void add_section(TriangleSoup& soup, double t, const std::array<Bump, 3>& all) {
  const Frame f = frame_at(t);
  const double c = std::cos(kTwists * t), s = std::sin(kTwists * t);
  const Vec3 along = kLongAxis * (c * f.out + s * f.side);
  const Vec3 across = kShortAxis * (c * f.side - s * f.out);
  for (int j = 0; j < kAround; ++j) {
    const double a = 2 * kPi * j / kAround;
    soup.points.push_back(raised(f.center + std::cos(a) * along + std::sin(a) * across, all));
  }
}

}  // namespace

TriangleSoup make_knot() {
  TriangleSoup soup;
  const std::array<Bump, 3> all = bumps();
  for (int i = 0; i < kSections; ++i) {
    const double u = 2 * kPi * i / kSections;
    // Sections are three times as dense at the bumps as half way between.
    add_section(soup, u - std::sin(3 * u) / 6, all);
  }
  const auto point = [](int i, int j) {
    return static_cast<std::uint32_t>(i % kSections * kAround + j % kAround);
  };
  for (int i = 0; i < kSections; ++i)
    for (int j = 0; j < kAround; ++j) {
      soup.facets.push_back({point(i, j), point(i, j + 1), point(i + 1, j + 1)});
      soup.facets.push_back({point(i, j), point(i + 1, j + 1), point(i + 1, j)});
    }
  return soup;
}

}  // namespace burnish::example
