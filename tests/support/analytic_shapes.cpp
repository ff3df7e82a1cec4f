#include "support/analytic_shapes.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "burnish/core/parallel.h"
#include "support/level_sets.h"

namespace burnish::test {
namespace {

class Sphere final : public AnalyticShape {
 public:
  std::string name() const override { return "sphere"; }
  double radius() const override { return 1; }
  SurfacePoint closest(const Vec3& p) const override {
    const Vec3 n = p / norm(p);
    return {n, n, 1, 1, {}};
  }
  double distance(const Vec3& p) const override { return 1 - norm(p); }
};

// A tube of radius 1 about a curve: the closest point of the curve to p gives everything.
struct CurvePoint {
  Vec3 point, tangent, curvature;  // unit tangent; curvature vector: normal times curvature
};

SurfacePoint on_tube(const CurvePoint& c, const Vec3& p) {
  const Vec3 away = p - c.point;
  const Vec3 n = away / norm(away);
  const double toward = dot(c.curvature, n);  // the tube runs closer together on the inner side of a bend
  return {c.point + n, n, 1, -toward / (1 - toward), cross(c.tangent, n)};
}

class Torus final : public AnalyticShape {
 public:
  static constexpr double kRing = 2.5;
  std::string name() const override { return "torus"; }
  double radius() const override { return kRing + 1; }
  SurfacePoint closest(const Vec3& p) const override {
    const double r = std::hypot(p.x, p.y);
    const Vec3 out{p.x / r, p.y / r, 0};
    return on_tube({out * kRing, {-out.y, out.x, 0}, out * (-1 / kRing)}, p);
  }
  double distance(const Vec3& p) const override { return 1 - std::hypot(std::hypot(p.x, p.y) - kRing, p.z); }
};

class Trefoil final : public AnalyticShape {
 public:
  Trefoil() {
    for (int i = 0; i < kSamples; ++i) samples_[static_cast<std::size_t>(i)] = at(step() * i).point;
  }
  std::string name() const override { return "trefoil"; }
  double radius() const override { return 3 * kScale + 1; }
  SurfacePoint closest(const Vec3& p) const override { return on_tube(closest_of_curve(p), p); }
  double distance(const Vec3& p) const override {
    // Far away the nearest sample will do: it is off by less than half of what lies between two of them.
    const int nearest = nearest_sample(p);
    const double rough = 1 - norm(p - samples_[static_cast<std::size_t>(nearest)]);
    return std::abs(rough) > 0.7 ? rough : 1 - norm(p - refined(p, nearest).point);
  }

 private:
  static constexpr double kScale = 2.5;
  static constexpr int kSamples = 480;
  static constexpr double step() { return 2 * std::numbers::pi / kSamples; }

  struct Derivatives {
    Vec3 point, first, second;
  };

  static Derivatives at(double t) {
    const double s1 = std::sin(t), c1 = std::cos(t), s2 = std::sin(2 * t), c2 = std::cos(2 * t), s3 = std::sin(3 * t), c3 = std::cos(3 * t);
    return {Vec3{s1 + 2 * s2, c1 - 2 * c2, -s3} * kScale, Vec3{c1 + 4 * c2, -s1 + 4 * s2, -3 * c3} * kScale,
            Vec3{-s1 - 8 * s2, -c1 + 8 * c2, 9 * s3} * kScale};
  }

  int nearest_sample(const Vec3& p) const {
    // Every eighth sample first, then those around the two best of these.
    int best = 0;
    double least = 1e300;
    for (int i = 0; i < kSamples; i += 8)
      if (const double d = squared_norm(p - samples_[static_cast<std::size_t>(i)]); d < least) least = d, best = i;
    const int around = best;
    for (int i = around - 12; i <= around + 12; ++i) {
      const int k = (i + kSamples) % kSamples;
      if (const double d = squared_norm(p - samples_[static_cast<std::size_t>(k)]); d < least) least = d, best = k;
    }
    return best;
  }

  // Newton's method for (c(t) - p) . c'(t) = 0.
  static CurvePoint refined(const Vec3& p, int sample) {
    double t = step() * sample;
    Derivatives d = at(t);
    for (int i = 0; i < 20; ++i) {
      const Vec3 away = d.point - p;
      const double move = dot(away, d.first) / (squared_norm(d.first) + dot(away, d.second));
      t -= move;
      d = at(t);
      if (std::abs(move) < 1e-14) break;
    }
    const double speed2 = squared_norm(d.first);
    const Vec3 tangent = d.first / std::sqrt(speed2);
    return {d.point, tangent, (d.second - tangent * dot(d.second, tangent)) / speed2};
  }

  CurvePoint closest_of_curve(const Vec3& p) const { return refined(p, nearest_sample(p)); }

  std::array<Vec3, kSamples> samples_;
};

class Ellipsoid final : public AnalyticShape {
 public:
  std::string name() const override { return "ellipsoid"; }
  double radius() const override { return kAxes.x; }

  SurfacePoint closest(const Vec3& p) const override {
    const Vec3 y = foot(p);
    // Shape operator of F = sum (x / a)^2 / 2: the Hessian of F on the tangent plane, over |grad F|.
    Vec3 g, h;
    for (int a = 0; a < 3; ++a) h[a] = 1 / (kAxes[a] * kAxes[a]), g[a] = y[a] * h[a];
    const double length = norm(g);
    const Vec3 n = g / length;
    const Vec3 u = unit(std::abs(n.x) < 0.6 ? cross(n, Vec3{1, 0, 0}) : cross(n, Vec3{0, 1, 0})), v = cross(n, u);
    const auto form = [&](const Vec3& r, const Vec3& s) { return (h.x * r.x * s.x + h.y * r.y * s.y + h.z * r.z * s.z) / length; };
    const double uu = form(u, u), uv = form(u, v), vv = form(v, v);
    const double middle = 0.5 * (uu + vv), half = std::hypot(0.5 * (uu - vv), uv);
    const double angle = 0.5 * std::atan2(2 * uv, uu - vv);
    return {y, n, middle + half, middle - half, u * std::cos(angle) + v * std::sin(angle)};
  }

  double distance(const Vec3& p) const override {
    Vec3 in;
    for (int a = 0; a < 3; ++a) in[a] = p[a] / kAxes[a];
    return squared_norm(in) < 1 ? norm(p - foot(p)) : -norm(p - foot(p));
  }

 private:
  static constexpr Vec3 kAxes{1.5625, 1.4, 1.25};
  static Vec3 unit(const Vec3& v) { return v / norm(v); }

  // y = a^2 p / (t + a^2) per axis (Eberly, "Distance from a point to an ellipsoid"), t the largest root of
  // sum (a p / (t + a^2))^2 = 1. Newton's method from the left is monotone, since the sum is convex and decreasing there.
  static Vec3 foot(const Vec3& p) {
    double t = -1e300;
    for (int a = 0; a < 3; ++a) t = std::max(t, kAxes[a] * std::abs(p[a]) - kAxes[a] * kAxes[a]);
    for (int i = 0; i < 60; ++i) {
      double f = -1, slope = 0;
      for (int a = 0; a < 3; ++a) {
        const double d = t + kAxes[a] * kAxes[a], r = d > 0 ? kAxes[a] * p[a] / d : 0;
        f += r * r;
        if (d > 0) slope -= 2 * r * r / d;
      }
      if (!(std::abs(f) > 1e-15) || slope == 0) break;
      t -= f / slope;
    }
    Vec3 y;
    for (int a = 0; a < 3; ++a) y[a] = kAxes[a] * kAxes[a] * p[a] / (t + kAxes[a] * kAxes[a]);
    return y;
  }
};

Vec3 turned(const Rotation& r, const Vec3& v) { return {dot(r[0], v), dot(r[1], v), dot(r[2], v)}; }
Vec3 turned_back(const Rotation& r, const Vec3& v) { return r[0] * v.x + r[1] * v.y + r[2] * v.z; }

}  // namespace

std::unique_ptr<AnalyticShape> unit_sphere() { return std::make_unique<Sphere>(); }
std::unique_ptr<AnalyticShape> unit_torus() { return std::make_unique<Torus>(); }
std::unique_ptr<AnalyticShape> unit_ellipsoid() { return std::make_unique<Ellipsoid>(); }
std::unique_ptr<AnalyticShape> unit_trefoil() { return std::make_unique<Trefoil>(); }

std::vector<std::unique_ptr<AnalyticShape>> analytic_shapes() {
  std::vector<std::unique_ptr<AnalyticShape>> all;
  all.push_back(unit_sphere());
  all.push_back(unit_torus());
  all.push_back(unit_ellipsoid());
  all.push_back(unit_trefoil());
  return all;
}

Rotation random_rotation(std::mt19937& random) {
  // A unit quaternion of four normal numbers.
  std::normal_distribution<double> any;
  std::array<double, 4> q{};
  double length = 0;
  for (double& c : q) c = any(random), length += c * c;
  for (double& c : q) c /= std::sqrt(length);
  const auto [w, x, y, z] = q;
  return {Vec3{1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)}, Vec3{2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)},
          Vec3{2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)}};
}

double PlacedShape::distance(const Vec3& p) const { return size * shape->distance(turned(rotation, (p - center) / size)); }

SurfacePoint PlacedShape::closest(const Vec3& p) const {
  const SurfacePoint at = shape->closest(turned(rotation, (p - center) / size));
  return {center + turned_back(rotation, at.foot) * size, turned_back(rotation, at.normal), at.k1 / size, at.k2 / size,
          turned_back(rotation, at.direction1)};
}

PlacedShape placed_at_random(const AnalyticShape& shape, double size, double room, std::mt19937& random, bool is_turned) {
  PlacedShape placed{&shape, size, kUpright, {}, 0};
  while (kBlockSide << placed.depth < 2 * (shape.radius() * size + room + 1)) ++placed.depth;
  std::uniform_real_distribution<double> any(0, 1);
  const double middle = 0.5 * (kBlockSide << placed.depth);
  for (int a = 0; a < 3; ++a) placed.center[a] = middle + any(random) - 0.5;
  if (is_turned) placed.rotation = random_rotation(random);
  return placed;
}

template <class T>
BasicLevelSet<T> level_set_of_shape(const PlacedShape& placed, double band, const std::function<int(const Vec3&)>& level_at) {
  const auto near = [&](std::uint64_t key) {
    const int l = morton::level(key);
    const morton::Position c = morton::corner(key);
    const double half = 4 << l;
    const Vec3 middle{8.0 * c.x + half, 8.0 * c.y + half, 8.0 * c.z + half};
    return std::abs(placed.distance(middle)) < 1.75 * half + (band + 1) * (1 << l);
  };
  const auto wants = [&](std::uint64_t key) {
    const morton::Position c = morton::corner(key);
    const double half = 4 << morton::level(key);
    return level_at ? level_at({8.0 * c.x + half, 8.0 * c.y + half, 8.0 * c.z + half}) : 0;
  };
  std::vector<std::uint64_t> keys, octants{morton::key(0, placed.depth)};
  while (!octants.empty()) {
    const std::uint64_t octant = octants.back();
    octants.pop_back();
    const int l = morton::level(octant);
    if (!near(octant)) continue;
    if (l == 0 || (l < 3 && l <= wants(octant))) {
      keys.push_back(octant);
      continue;
    }
    const std::uint64_t first = octant >> (3 * l + 1);
    for (std::uint64_t child = 0; child < 8; ++child) octants.push_back(morton::key(first << 3 | child, l - 1));
  }
  BasicLevelSet<T> set;
  set.frame.depth = placed.depth;
  set.band = band;
  set.grid.octree = Octree::build_graded(placed.depth, keys);
  const Octree& tree = set.octree();
  std::vector<char> is_near(tree.size());
  set.grid.first_facet.resize(tree.size() + 1);
  std::uint64_t count = 0;
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf) {
    is_near[leaf] = near(tree.key(leaf));
    set.grid.first_facet[leaf] = count;
    count += static_cast<std::uint64_t>(is_near[leaf]);
  }
  // One facet, which nobody looks at, stands for the surface in each block near it.
  set.grid.first_facet.back() = count;
  set.grid.facets.assign(count, 0);
  set.grid.layout = layout_of(tree.size(), [&](std::size_t leaf) { return is_near[leaf] != 0; });
  set.phi = field_over(set.grid, static_cast<T>(band), static_cast<T>(-band));
  for (std::size_t leaf = 0; leaf < tree.size(); ++leaf)
    if (!is_near[leaf]) set.phi.set_uniform(leaf, placed.distance(to_vec(lattice_node(tree, leaf, 4, 4, 4))) < 0);
  parallel_for(
      tree.size(),
      [&](std::size_t leaf) {
        if (!is_near[leaf]) return;
        const double most = band * (1 << tree.level(leaf));
        T* phi = set.phi.block(leaf);
        for (int n = 0; n < static_cast<int>(kBlockNodes); ++n)
          phi[n] = static_cast<T>(std::clamp(placed.distance(to_vec(lattice_node(tree, leaf, n % 8, n / 8 % 8, n / 64))), -most, most));
      },
      4);
  return set;
}

std::function<int(const Vec3&)> jump_through(const PlacedShape& placed, int coarser) {
  return [center = placed.center, coarser](const Vec3& p) { return p.x < center.x ? 0 : coarser; };
}

template BasicLevelSet<float> level_set_of_shape(const PlacedShape&, double, const std::function<int(const Vec3&)>&);
template BasicLevelSet<double> level_set_of_shape(const PlacedShape&, double, const std::function<int(const Vec3&)>&);

}  // namespace burnish::test
