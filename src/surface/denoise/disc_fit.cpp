#include "disc_fit.h"

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>

namespace burnish::denoising {
namespace {

using Lanes = Eigen::Array<double, 4, 1>;

// The least pivot, relative to the sum of weights, of a fit that is determined: discs that are seen by a sliver only have less.
constexpr double kLeastPivot = 1e-4;
// Weights w = (1 - r^2)^2 over a full disc: the variance of slopes is sigma^2 sum(w^2 x^2) / sum(w x^2)^2, and sum(w^2 x^2) / sum(w x^2) = B(2,5) / B(2,3).
constexpr double kSquaredWeights = 0.4;

template <int N>
DiscFit solve(const Eigen::Matrix<double, N, N>& m, const Eigen::Matrix<double, N, 1>& b, const DiscMoments& d) {
  const double radius = d.radius;
  const Eigen::LDLT<Eigen::Matrix<double, N, N>> solver(m);
  if (solver.info() != Eigen::Success || solver.vectorD().minCoeff() < kLeastPivot * m(0, 0)) return {};
  const Eigen::Matrix<double, N, 1> c = solver.solve(b);
  Eigen::Matrix<double, N, 2> axes = Eigen::Matrix<double, N, 2>::Zero();
  axes(1, 0) = axes(2, 1) = 1;
  const Eigen::Matrix<double, N, 2> inverse = solver.solve(axes);
  DiscFit fit{c[0] * radius, c[1], c[2]};
  if constexpr (N == 6) fit.xx = c[3] / radius, fit.xy = c[4] / radius, fit.yy = c[5] / radius;
  fit.error = std::sqrt(kSquaredWeights * (inverse(1, 0) + inverse(2, 1))) / radius;
  // A full disc: the mean weight is 1/3, the mean square of weights 1/5 and of residuals' correlations as many parameters as N.
  const double effective = m(0, 0) * (5.0 / 3.0) , freedom = std::max(effective - N, 0.25 * effective) / effective;
  fit.residual = std::max(0.0, d.height_squared - c.dot(b)) * radius * radius / (m(0, 0) * freedom);
  fit.explained = c.dot(b) * radius * radius;
  fit.residual_error = std::sqrt(2.0 / (effective * freedom));
  fit.valid = true;
  return fit;
}

}  // namespace

void HeightSamples::resize(std::size_t n) {
  for (std::vector<double>* v : {&x, &y, &z, &squared_distance, &weight}) v->resize(n);
}

DiscMoments disc_moments(const HeightSamples& s, std::size_t count, double radius) {
  std::array<Lanes, 15> power;
  std::array<Lanes, 6> height;
  Lanes square = Lanes::Zero();
  power.fill(Lanes::Zero());
  height.fill(Lanes::Zero());
  const double per_radius = 1 / radius, per_square = per_radius * per_radius;
  const auto load = [](const std::vector<double>& v, std::size_t i) { return Lanes(Eigen::Map<const Lanes>(v.data() + i)); };
  for (std::size_t i = 0; i < count; i += 4) {
    const Lanes x = load(s.x, i) * per_radius, y = load(s.y, i) * per_radius, z = load(s.z, i) * per_radius;
    const Lanes q = (1 - load(s.squared_distance, i) * per_square).max(0.0), w = load(s.weight, i) * q * q;
    const Lanes wx = w * x, wy = w * y, wxx = wx * x, wxy = wx * y, wyy = wy * y, xx = x * x, yy = y * y, xy = x * y;
    power[0] += w;
    power[1] += wx;
    power[2] += wy;
    power[3] += wxx;
    power[4] += wxy;
    power[5] += wyy;
    power[6] += wxx * x;
    power[7] += wxx * y;
    power[8] += wyy * x;
    power[9] += wyy * y;
    power[10] += wxx * xx;
    power[11] += wxx * xy;
    power[12] += wxx * yy;
    power[13] += wyy * xy;
    power[14] += wyy * yy;
    const Lanes wz = w * z;
    square += wz * z;
    height[0] += wz;
    height[1] += wx * z;
    height[2] += wy * z;
    height[3] += wxx * z;
    height[4] += wxy * z;
    height[5] += wyy * z;
  }
  DiscMoments moments;
  moments.radius = radius;
  moments.height_squared = square.sum();
  for (std::size_t k = 0; k < power.size(); ++k) moments.power[k] = power[k].sum();
  for (std::size_t k = 0; k < height.size(); ++k) moments.height[k] = height[k].sum();
  return moments;
}

DiscFit fit_plane(const DiscMoments& d) {
  const auto& p = d.power;
  Eigen::Matrix3d m;
  m << p[0], p[1], p[2], p[1], p[3], p[4], p[2], p[4], p[5];
  return solve<3>(m, {d.height[0], d.height[1], d.height[2]}, d);
}

DiscFit fit_paraboloid(const DiscMoments& d) {
  const auto& p = d.power;
  Eigen::Matrix<double, 6, 6> m;
  m << p[0], p[1], p[2], p[3], p[4], p[5],        //
      p[1], p[3], p[4], p[6], p[7], p[8],         //
      p[2], p[4], p[5], p[7], p[8], p[9],         //
      p[3], p[6], p[7], p[10], p[11], p[12],      //
      p[4], p[7], p[8], p[11], p[12], p[13],      //
      p[5], p[8], p[9], p[12], p[13], p[14];
  return solve<6>(m, Eigen::Map<const Eigen::Matrix<double, 6, 1>>(d.height.data()), d);
}

}  // namespace burnish::denoising
