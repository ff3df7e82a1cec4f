#include "distance_kernel.h"

#include <cstring>

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
#define BURNISH_DISPATCH __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define BURNISH_DISPATCH
#endif

namespace burnish::detail {
namespace {

// Slivers whose height over their longest side is below the root of this have no reliable plane; their edges serve.
constexpr double kFlat = 1e-22;

// Eight doubles in vector registers of whatever width the processor has (GCC's and Clang's vector extension: loops of
// eight are unrolled before they are vectorised).
typedef double Row __attribute__((vector_size(kRow * sizeof(double))));

double inverse_or_zero(double v) { return v > 0 ? 1 / v : 0; }

}  // namespace

PreparedTriangle prepare(const Vec3& a, const Vec3& b, const Vec3& c) {
  const double ab2 = squared_norm(b - a), bc2 = squared_norm(c - b), ca2 = squared_norm(a - c);
  // The longest edge is to be ca: see `height` below.
  if (ab2 > ca2 && ab2 >= bc2) return prepare(b, c, a);
  if (bc2 > ca2) return prepare(c, a, b);
  PreparedTriangle t{};
  t.a = a;
  t.b = b;
  t.c = c;
  t.ab = b - a;
  t.bc = c - b;
  t.ca = a - c;
  t.inverse_ab = inverse_or_zero(ab2);
  t.inverse_bc = inverse_or_zero(bc2);
  t.inverse_ca = inverse_or_zero(ca2);
  t.n = cross(t.ab, c - a);
  const double n2 = squared_norm(t.n);
  t.inverse_n = n2 > kFlat * ca2 * ca2 ? 1 / n2 : 0;  // [T-DIST-2]
  t.n_ab = cross(t.n, t.ab);
  t.n_bc = cross(t.n, t.bc);
  t.n_ca = cross(t.n, t.ca);
  return t;
}

BURNISH_DISPATCH
void update_row(const PreparedTriangle& t, double facet, double y, double z, double* squared, double* id) {
  const Row kOnes = {1, 1, 1, 1, 1, 1, 1, 1};
  const Row kZeros = kOnes - kOnes;
  const Row px = {0, 1, 2, 3, 4, 5, 6, 7};
  const Row ax = px - t.a.x, bx = px - t.b.x, cx = px - t.c.x;
  const double ay = y - t.a.y, az = z - t.a.z, by = y - t.b.y, bz = z - t.b.z, cy = y - t.c.y, cz = z - t.c.z;

  // The closest point of each edge, by its parameter clamped to [0, 1]. [T-DIST-1]
  Row s = (ax * t.ab.x + (ay * t.ab.y + az * t.ab.z)) * t.inverse_ab;
  s = s < kZeros ? kZeros : s;
  s = s > kOnes ? kOnes : s;
  Row u = ax - s * t.ab.x, v = ay - s * t.ab.y, w = az - s * t.ab.z;
  Row best = u * u + v * v + w * w;

  s = (bx * t.bc.x + (by * t.bc.y + bz * t.bc.z)) * t.inverse_bc;
  s = s < kZeros ? kZeros : s;
  s = s > kOnes ? kOnes : s;
  u = bx - s * t.bc.x, v = by - s * t.bc.y, w = bz - s * t.bc.z;
  Row next = u * u + v * v + w * w;
  best = next < best ? next : best;

  s = (cx * t.ca.x + (cy * t.ca.y + cz * t.ca.z)) * t.inverse_ca;
  s = s < kZeros ? kZeros : s;
  s = s > kOnes ? kOnes : s;
  u = cx - s * t.ca.x, v = cy - s * t.ca.y, w = cz - s * t.ca.z;
  next = u * u + v * v + w * w;
  best = next < best ? next : best;

  // The plane's distance where the projection falls inside all three edges.
  if (t.inverse_n > 0) {
    const Row in_ab = ax * t.n_ab.x + (ay * t.n_ab.y + az * t.n_ab.z);
    const Row in_bc = bx * t.n_bc.x + (by * t.n_bc.y + bz * t.n_bc.z);
    const Row in_ca = cx * t.n_ca.x + (cy * t.n_ca.y + cz * t.n_ca.z);
    Row inside = in_ab < in_bc ? in_ab : in_bc;
    inside = in_ca < inside ? in_ca : inside;
    // Measured from the closest point of the longest edge: nothing inside a sliver is far from it, so that the error of
    // a sliver's normal does no harm.
    const Row height = u * t.n.x + (v * t.n.y + w * t.n.z);
    best = inside >= kZeros ? height * height * t.inverse_n : best;
  }
  Row old, ids;
  std::memcpy(&old, squared, sizeof old);
  std::memcpy(&ids, id, sizeof ids);
  ids = best < old ? kZeros + facet : ids;
  old = best < old ? best : old;
  std::memcpy(squared, &old, sizeof old);
  std::memcpy(id, &ids, sizeof ids);
}

}  // namespace burnish::detail
