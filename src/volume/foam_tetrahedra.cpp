// The decompositions of faces and cells into tetrahedra that OpenFOAM tracks particles in.
#include <algorithm>

#include "foam_geometry.h"

namespace burnish::foam {
namespace {

constexpr double kLeastQuality = kSmall * kSmall;

// Volume over that of the regular tetrahedron with the same circumscribed sphere, with sign.
double quality(double sixfold, const Vec3& a, const Vec3& b, const Vec3& c) {
  const double lambda = squared_norm(c) - dot(a, c), mu = squared_norm(b) - dot(a, b);
  const Vec3 ba = cross(b, a), ca = cross(c, a);
  const double denominator = dot(c, ba);
  const double radius = std::fabs(denominator) < kRootVerySmall ? kGreat : std::min(kGreat, norm(0.5 * (a + (lambda * ba - mu * ca) / denominator)));
  return sixfold / 6 / (8 / (9 * std::sqrt(3.0)) * radius * radius * radius + kRootVerySmall);
}

// The tetrahedron (o, o + a, o + b, o + c). Nearly all are far from being flat, and their sign says enough: with sixfold > 1e-5 L^3, where no
// edge at o is longer than L, the radius is below 4e5 L and the quality above 1e-23.
bool is_good(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double sixfold = dot(cross(a, b), c);
  if (sixfold <= 0) return false;
  const double square = std::max({squared_norm(a), squared_norm(b), squared_norm(c)});
  if (sixfold > kRootVerySmall && sixfold * sixfold > 1e-10 * square * square * square) return true;
  return quality(sixfold, a, b, c) >= kLeastQuality;
}

// (a, b, face centre, apex) for all edges; `from_owner`: they have the other orientation.
bool fans_are_good(Loop loop, Points points, const Vec3& centre, const Vec3& apex, bool from_owner) {
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Vec3 &p = points[loop[i]], &q = points[loop[i + 1 < loop.size() ? i + 1 : 0]];
    const Vec3 a = q - p, b = centre - p, c = apex - p;
    if (from_owner ? !is_good(b, a, c) : !is_good(a, b, c)) return false;
  }
  return true;
}

bool base_is_good(Loop loop, Points points, std::size_t base, const Vec3& owner, const Vec3* neighbour) {
  const Vec3& o = points[loop[base]];
  const auto at = [&](std::size_t k) -> const Vec3& { return points[loop[base + k < loop.size() ? base + k : base + k - loop.size()]]; };
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
    const Vec3 &p = at(k), &q = at(k + 1);
    if (!is_good(o - owner, p - owner, q - owner)) return false;
    if (neighbour && !is_good(o - *neighbour, q - *neighbour, p - *neighbour)) return false;
  }
  return true;
}

}  // namespace

// [T-QUAL-10]
int tetrahedra_errors(Loop loop, Points points, const Face& face, const Vec3& owner, const Vec3* neighbour) {
  int errors = fans_are_good(loop, points, face.centre, owner, true) ? 0 : 1;
  if (neighbour && !fans_are_good(loop, points, face.centre, *neighbour, false)) ++errors;
  for (std::size_t base = 0; base < loop.size(); ++base)
    if (base_is_good(loop, points, base, owner, neighbour)) return errors;
  return errors + 1;
}

}  // namespace burnish::foam
