#include "tetrahedron_share.h"

#include <algorithm>
#include <functional>

namespace burnish {
namespace {

// Of a tetrahedron with corners at the origin and the ends of the axes, in which phi is a[0], a[1], a[2], a[3]: where phi = 0, its polygon, corners in
// order; their number.
std::size_t zero_polygon(const std::array<double, 4>& a, std::array<Vec3, 4>& polygon) {
  constexpr std::array<Vec3, 4> kCorners{Vec3{}, Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
  std::array<std::size_t, 4> in{}, out{};
  std::size_t ins = 0, outs = 0;
  for (std::size_t i = 0; i < 4; ++i) (a[i] > 0 ? in[ins++] : out[outs++]) = i;
  const auto at = [&](std::size_t i, std::size_t o) { return kCorners[in[i]] + (kCorners[out[o]] - kCorners[in[i]]) * (a[in[i]] / (a[in[i]] - a[out[o]])); };
  if (ins == 0 || outs == 0) return 0;
  if (ins == 2) {
    polygon = {at(0, 0), at(0, 1), at(1, 1), at(1, 0)};
    return 4;
  }
  for (std::size_t i = 0; i < 3; ++i) polygon[i] = ins == 1 ? at(0, i) : at(i, 0);
  return 3;
}

// The integral over a triangle of a function that is quadratic: exactly by the middles of the sides.
template <class Value>
double integral(const Vec3& p, const Vec3& q, const Vec3& r, Value&& value) {
  return norm(cross(q - p, r - p)) / 6 * (value((p + q) * 0.5) + value((q + r) * 0.5) + value((r + p) * 0.5));
}

}  // namespace

// [T-VOF-3] Sums of products of numbers of one sign: no cancellation, however near to zero a value is.
double positive_share(double a, double b, double c, double d) {
  std::array<double, 4> v{a, b, c, d};
  std::sort(v.begin(), v.end(), std::greater<>());
  const auto part = [](double from, double to) { return from / (from - to); };  // of an edge, on the side of `from`
  if (v[0] <= 0) return 0;
  if (v[3] > 0) return 1;
  if (v[1] <= 0) return part(v[0], v[1]) * part(v[0], v[2]) * part(v[0], v[3]);
  if (v[2] > 0) return 1 - part(v[3], v[0]) * part(v[3], v[1]) * part(v[3], v[2]);
  const double ac = part(v[0], v[2]), ad = part(v[0], v[3]), bc = part(v[1], v[2]), bd = part(v[1], v[3]);
  return ac * ad + ac * (1 - ad) * bd + (1 - ac) * bc * bd;
}

double quadratic_share(const std::array<double, 10>& phi) {
  std::array<Vec3, 4> polygon;
  const std::size_t n = zero_polygon({phi[0], phi[1], phi[2], phi[3]}, polygon);
  if (n == 0) return 0;
  // phi less its linear interpolant.
  const auto bulge = [&](const Vec3& x) {
    const std::array<double, 4> weight{1 - x.x - x.y - x.z, x.x, x.y, x.z};
    double sum = 0;
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [i, j] = kTetrahedronEdges[e];
      sum += (phi[4 + e] - 0.5 * (phi[i] + phi[j])) * weight[i] * weight[j];
    }
    return 4 * sum;
  };
  double moved = 0;
  for (std::size_t i = 2; i < n; ++i) moved += integral(polygon[0], polygon[i - 1], polygon[i], bulge);
  constexpr double kVolume = 1.0 / 6;
  return moved / (kVolume * norm(Vec3{phi[1] - phi[0], phi[2] - phi[0], phi[3] - phi[0]}));
}

}  // namespace burnish
