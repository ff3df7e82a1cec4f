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

// (o, o + a, o + b): what tetrahedra of a face's both sides share. `normal` points out of the owner.
struct Triangle {
  Vec3 o, a, b, normal;
  double square;  // of the longer edge at o

  Triangle(const Vec3& p, const Vec3& q, const Vec3& r) : o(p), a(q - p), b(r - p), normal(cross(a, b)), square(std::max(squared_norm(a), squared_norm(b))) {}
};

// With an apex on the side that the normal points to (`side` 1) or on the other one (-1). Nearly all tetrahedra are far from being flat, and their sign says
// enough: with sixfold > 1e-5 L^3, where no edge at o is longer than L, the radius is below 4e5 L and the quality above 1e-23.
bool is_good(const Triangle& t, const Vec3& apex, double side) {
  const Vec3 c = apex - t.o;
  const double sixfold = side * dot(t.normal, c);
  if (sixfold <= 0) return false;
  const double square = std::max(t.square, squared_norm(c));
  if (sixfold > kRootVerySmall && sixfold * sixfold > 1e-10 * square * square * square) return true;
  return quality(sixfold, t.a, t.b, c) >= kLeastQuality;
}

// The triangles from the face's centre to its edges, with both centres.
int bad_fans(Loop loop, Points points, const Vec3& centre, const Vec3& owner, const Vec3* neighbour) {
  bool owner_is_good = true, neighbour_is_good = true;
  for (std::size_t i = 0; i < loop.size(); ++i) {
    const Triangle t(points[loop[i]], points[loop[i + 1 < loop.size() ? i + 1 : 0]], centre);
    owner_is_good = owner_is_good && is_good(t, owner, -1);
    neighbour_is_good = neighbour_is_good && (!neighbour || is_good(t, *neighbour, 1));
  }
  return (owner_is_good ? 0 : 1) + (neighbour_is_good ? 0 : 1);
}

// Those from one of the face's points to the edges that it is not on.
bool base_is_good(Loop loop, Points points, std::size_t base, const Vec3& owner, const Vec3* neighbour) {
  const auto at = [&](std::size_t k) -> const Vec3& { return points[loop[base + k < loop.size() ? base + k : base + k - loop.size()]]; };
  for (std::size_t k = 1; k + 1 < loop.size(); ++k) {
    const Triangle t(at(0), at(k), at(k + 1));
    if (!is_good(t, owner, -1) || (neighbour && !is_good(t, *neighbour, 1))) return false;
  }
  return true;
}

}  // namespace

// [T-QUAL-10]
int tetrahedra_errors(Loop loop, Points points, const Face& face, const Vec3& owner, const Vec3* neighbour) {
  const int errors = bad_fans(loop, points, face.centre, owner, neighbour);
  for (std::size_t base = 0; base < loop.size(); ++base)
    if (base_is_good(loop, points, base, owner, neighbour)) return errors;
  return errors + 1;
}

}  // namespace burnish::foam
