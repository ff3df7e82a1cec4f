#include "burnish/surface/quadric_fit.h"

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>

namespace burnish {
namespace {

// Right-handed, with the normal.
struct Frame {
  Vec3 u, v, n;
};

Frame frame_of(const Vec3& normal) {
  const Vec3 n = normal / norm(normal);
  const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
  const Vec3 axis = x <= y && x <= z ? Vec3{1, 0, 0} : y <= z ? Vec3{0, 1, 0} : Vec3{0, 0, 1};
  const Vec3 across = cross(axis, n), u = across / norm(across);
  return {u, cross(n, u), n};
}

// The monomials x^i y^j up to the degree, lowest degree first: 1, x, y, x^2, x y, y^2, ...
void set_monomials(double x, double y, int degree, Eigen::Ref<Eigen::RowVectorXd> row) {
  Eigen::Index at = 0;
  for (int total = 0; total <= degree; ++total)
    for (int j = 0; j <= total; ++j) row[at++] = std::pow(x, total - j) * std::pow(y, j);
}

// The height function's derivatives at the centre.
struct Height {
  double z, x, y, xx, xy, yy;
};

// Curvatures from the first and second fundamental forms, in an orthonormal basis of the tangent plane. [T-QUADRIC-2]
void set_curvatures(const Height& h, const Frame& frame, OsculatingParaboloid& fit) {
  const double w = std::sqrt(1 + h.x * h.x + h.y * h.y), e = std::sqrt(1 + h.x * h.x);
  // Parameter directions of the basis: (1, 0) / e, and (-x y / e^2, 1) e / w, which is orthogonal to it in the first form.
  const std::array<double, 2> p{1 / e, 0}, q{-h.x * h.y / (e * w), e / w};
  const auto form = [&](const std::array<double, 2>& a, const std::array<double, 2>& b) {
    return -(h.xx * a[0] * b[0] + h.xy * (a[0] * b[1] + a[1] * b[0]) + h.yy * a[1] * b[1]) / w;
  };
  const auto in_space = [&](const std::array<double, 2>& a) { return frame.u * a[0] + frame.v * a[1] + frame.n * (h.x * a[0] + h.y * a[1]); };
  const double pp = form(p, p), pq = form(p, q), qq = form(q, q);
  const double half = std::hypot(0.5 * (pp - qq), pq), angle = 0.5 * std::atan2(2 * pq, pp - qq);
  fit.k1 = 0.5 * (pp + qq) + half;
  fit.k2 = 0.5 * (pp + qq) - half;
  fit.normal = (frame.n - frame.u * h.x - frame.v * h.y) / w;
  fit.direction1 = in_space(p) * std::cos(angle) + in_space(q) * std::sin(angle);
  fit.direction2 = cross(fit.normal, fit.direction1);
}

}  // namespace

OsculatingParaboloid osculating_paraboloid(const Vec3& center, const Vec3& normal, std::span<const Vec3> points, int degree) {
  OsculatingParaboloid fit;
  const Eigen::Index unknowns = (degree + 1) * (degree + 2) / 2, count = static_cast<Eigen::Index>(points.size());
  double size = 0;
  for (const Vec3& p : points) size = std::max(size, norm(p - center));
  if (count < unknowns || !(size > 0) || !(norm(normal) > 0)) return fit;
  const Frame frame = frame_of(normal);
  Eigen::MatrixXd matrix(count, unknowns);
  Eigen::VectorXd heights(count);
  Eigen::RowVectorXd row(unknowns);
  for (Eigen::Index i = 0; i < count; ++i) {
    const Vec3 d = (points[static_cast<std::size_t>(i)] - center) / size;  // lengths of about 1: well-conditioned
    set_monomials(dot(d, frame.u), dot(d, frame.v), degree, row);
    matrix.row(i) = row;
    heights[i] = dot(d, frame.n);
  }
  const Eigen::ColPivHouseholderQR<Eigen::MatrixXd> qr(matrix);  // [T-QUADRIC-1]
  if (qr.rank() < unknowns) return fit;
  const Eigen::VectorXd c = qr.solve(heights);
  const Height h{c[0] * size, c[1], c[2], 2 * c[3] / size, c[4] / size, 2 * c[5] / size};
  fit.foot = center + frame.n * h.z;
  fit.residual = (matrix * c - heights).norm() * size / std::sqrt(static_cast<double>(count));
  set_curvatures(h, frame, fit);
  fit.valid = true;
  return fit;
}

}  // namespace burnish
