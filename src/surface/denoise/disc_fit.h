// Weighted least squares of a plane or a paraboloid over a disc, many times over.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace burnish::denoising {

// Points above a plane.
struct HeightSamples {
  std::vector<double> x, y, z;        // in the frame of the plane
  std::vector<double> squared_distance;
  std::vector<double> weight;         // apart from the distance

  void resize(std::size_t n);
  std::size_t size() const { return x.size(); }
};

// Sums of weight times monomials up to degree 4, and of weight times height times monomials up to degree 2, in units of the radius.
struct DiscMoments {
  std::array<double, 15> power{};   // 1, x, y, xx, xy, yy, xxx, xxy, xyy, yyy, xxxx, xxxy, xxyy, xyyy, yyyy
  std::array<double, 6> height{};   // 1, x, y, xx, xy, yy
  double height_squared = 0;
  double radius = 0;
};

// Of the first `count` samples (a multiple of 4), with weights (1 - d^2 / radius^2)^2 inside the radius and 0 outside.
DiscMoments disc_moments(const HeightSamples& samples, std::size_t count, double radius);

// Height, slopes and second derivatives at the origin: z + slope_x x + slope_y y + xx x^2 + xy x y + yy y^2.
struct DiscFit {
  double z = 0, slope_x = 0, slope_y = 0, xx = 0, xy = 0, yy = 0;
  double error = 0;     // standard deviation of the slopes for heights with standard deviation 1
  double residual = 0;  // mean square of the heights above the fit, divided by its expected value for heights with standard deviation 1
  double explained = 0; // weighted sum of squares of heights that the fit explains
  double residual_error = 0;  // standard deviation of `residual`
  bool valid = false;
};
DiscFit fit_plane(const DiscMoments& moments);
DiscFit fit_paraboloid(const DiscMoments& moments);

}  // namespace burnish::denoising
