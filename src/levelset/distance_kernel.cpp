#include "distance_kernel.h"

#include <algorithm>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
#define BURNISH_DISPATCH __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define BURNISH_DISPATCH
#endif

namespace burnish::detail {
namespace {

// Slivers below this sine of the smallest angle have no reliable plane; their edges serve.
constexpr double kFlat = 1e-20;

double inverse_or_zero(double v) { return v > 0 ? 1 / v : 0; }

}  // namespace

PreparedTriangle prepare(const Vec3& a, const Vec3& b, const Vec3& c) {
  PreparedTriangle t{};
  t.a = a;
  t.b = b;
  t.c = c;
  t.ab = b - a;
  t.bc = c - b;
  t.ca = a - c;
  t.inverse_ab = inverse_or_zero(squared_norm(t.ab));
  t.inverse_bc = inverse_or_zero(squared_norm(t.bc));
  t.inverse_ca = inverse_or_zero(squared_norm(t.ca));
  t.n = cross(t.ab, c - a);
  const double n2 = squared_norm(t.n);
  const double longest2 = std::max({squared_norm(t.ab), squared_norm(t.bc), squared_norm(t.ca)});
  t.inverse_n = n2 > kFlat * longest2 * longest2 ? 1 / n2 : 0;
  t.n_ab = cross(t.n, t.ab);
  t.n_bc = cross(t.n, t.bc);
  t.n_ca = cross(t.n, t.ca);
  return t;
}

BURNISH_DISPATCH
void update_row(const PreparedTriangle& t, double facet, double y, double z, double* squared, double* id) {
  const double ay = y - t.a.y, az = z - t.a.z, by = y - t.b.y, bz = z - t.b.z, cy = y - t.c.y, cz = z - t.c.z;
  double d2[kRow];
  for (int i = 0; i < kRow; ++i) {
    const double px = i;
    const double ax = px - t.a.x, bx = px - t.b.x, cx = px - t.c.x;

    double s = (ax * t.ab.x + ay * t.ab.y + az * t.ab.z) * t.inverse_ab;
    s = s < 0 ? 0 : s;
    s = s > 1 ? 1 : s;
    double u = ax - s * t.ab.x, v = ay - s * t.ab.y, w = az - s * t.ab.z;
    double best = u * u + v * v + w * w;

    s = (bx * t.bc.x + by * t.bc.y + bz * t.bc.z) * t.inverse_bc;
    s = s < 0 ? 0 : s;
    s = s > 1 ? 1 : s;
    u = bx - s * t.bc.x, v = by - s * t.bc.y, w = bz - s * t.bc.z;
    double next = u * u + v * v + w * w;
    best = next < best ? next : best;

    s = (cx * t.ca.x + cy * t.ca.y + cz * t.ca.z) * t.inverse_ca;
    s = s < 0 ? 0 : s;
    s = s > 1 ? 1 : s;
    u = cx - s * t.ca.x, v = cy - s * t.ca.y, w = cz - s * t.ca.z;
    next = u * u + v * v + w * w;
    best = next < best ? next : best;

    // The least of the three says whether the projection is inside all edges.
    const double in_ab = ax * t.n_ab.x + ay * t.n_ab.y + az * t.n_ab.z;
    const double in_bc = bx * t.n_bc.x + by * t.n_bc.y + bz * t.n_bc.z;
    const double in_ca = cx * t.n_ca.x + cy * t.n_ca.y + cz * t.n_ca.z;
    double inside = in_ab < in_bc ? in_ab : in_bc;
    inside = in_ca < inside ? in_ca : inside;
    inside = t.inverse_n > 0 ? inside : -1;
    const double height = ax * t.n.x + ay * t.n.y + az * t.n.z;
    const double plane = height * height * t.inverse_n;
    d2[i] = inside >= 0 ? plane : best;
  }
  for (int i = 0; i < kRow; ++i) {
    const bool closer = d2[i] < squared[i];
    squared[i] = closer ? d2[i] : squared[i];
    id[i] = closer ? facet : id[i];
  }
}

}  // namespace burnish::detail
