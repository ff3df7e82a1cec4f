// Shapes whose distances, closest points and curvatures are known, placed anywhere in the lattice.
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <memory>
#include <random>
#include <string>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/levelset/level_set.h"

namespace burnish::test {

// A point of a surface: outward normal, principal curvatures with respect to it (a ball of radius R has 1/R, 1/R).
struct SurfacePoint {
  Vec3 foot, normal;
  double k1 = 0, k2 = 0;          // k1 >= k2
  Vec3 direction1;                // of k1; zero at umbilics

  double mean_sum() const { return k1 + k2; }  // kappa of numerics and thesis
};

// A shape at the origin. Its smallest radius of curvature is 1, and its distance is smooth at least where it is below 0.6.
class AnalyticShape {
 public:
  virtual ~AnalyticShape() = default;
  virtual std::string name() const = 0;
  virtual double radius() const = 0;  // of a ball about the origin that holds the shape
  // The closest point of the surface, for points at a distance below 0.6.
  virtual SurfacePoint closest(const Vec3& p) const = 0;
  // Signed distance, positive inside, anywhere; beyond 0.6 the sign and the size need to be about right only.
  virtual double distance(const Vec3& p) const = 0;
};

std::unique_ptr<AnalyticShape> unit_sphere();
// Tube of radius 1 about a circle of radius 2.5.
std::unique_ptr<AnalyticShape> unit_torus();
// Semi-axes 1.5625, 1.4, 1.25: the smallest radius of curvature is 1.25^2 / 1.5625 = 1.
std::unique_ptr<AnalyticShape> unit_ellipsoid();
// Tube of radius 1 about the trefoil knot 2.5 (sin t + 2 sin 2t, cos t - 2 cos 2t, -sin 3t).
std::unique_ptr<AnalyticShape> unit_trefoil();
std::vector<std::unique_ptr<AnalyticShape>> analytic_shapes();  // the four, in this order

// Rows of an orthonormal matrix.
using Rotation = std::array<Vec3, 3>;
inline constexpr Rotation kUpright{Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{0, 0, 1}};
Rotation random_rotation(std::mt19937& random);

// A shape in the lattice: scaled so that its smallest radius of curvature is `size` finest cells, turned, moved.
struct PlacedShape {
  const AnalyticShape* shape = nullptr;
  double size = 1;
  Rotation rotation = kUpright;
  Vec3 center;
  int depth = 0;  // 2^depth finest blocks a side hold it

  double distance(const Vec3& p) const;       // in cells, positive inside
  SurfacePoint closest(const Vec3& p) const;  // in lattice units
  bool is_exact(double distance) const { return std::abs(distance) < 0.6 * size; }
};

// In the middle of a domain with `room` cells around it, off the lattice by random parts of a cell, and turned at random.
PlacedShape placed_at_random(const AnalyticShape& shape, double size, double room, std::mt19937& random, bool turned = true);

// phi = distance in finest cells, clamped to +- band cells of the level of each leaf; leaves that hold no value below that share the
// uniform blocks. Blocks within the band of the surface have the level that `level_at(centre of a finest block)` wants, up
// to the 2:1 balance (finer); by default 0.
template <class T>
BasicLevelSet<T> level_set_of_shape(const PlacedShape& placed, double band, const std::function<int(const Vec3&)>& level_at = {});

// Level 0 on one side of a plane through the centre, `coarser` on the other: the jump runs through the surface.
std::function<int(const Vec3&)> jump_through(const PlacedShape& placed, int coarser = 1);

}  // namespace burnish::test
