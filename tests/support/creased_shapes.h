// Solids with creases, and their way through a lattice to a sharpened surface.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <set>
#include <vector>

#include "burnish/extract/marching_tetrahedra.h"
#include "burnish/extract/sharpen.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/weld.h"
#include "support/parts.h"
#include "support/shapes.h"

namespace burnish::test {

// A prism over a convex polygon, counter-clockwise, from z = 0 to `height`; its ends are fans about their centroids.
inline TriangleSoup prism(const std::vector<std::array<double, 2>>& polygon, double height) {
  TriangleSoup soup;
  const auto n = static_cast<std::uint32_t>(polygon.size());
  double x = 0, y = 0;
  for (const double z : {0.0, height})
    for (const auto& p : polygon) {
      soup.points.push_back({p[0], p[1], z});
      x += p[0] / (2.0 * n), y += p[1] / (2.0 * n);
    }
  soup.points.push_back({x, y, 0});
  soup.points.push_back({x, y, height});
  for (std::uint32_t i = 0; i < n; ++i) {
    const std::uint32_t j = (i + 1) % n;
    soup.facets.insert(soup.facets.end(), {{i, j, n + j}, {i, n + j, n + i}, {2 * n, j, i}, {2 * n + 1, n + i, n + j}});
  }
  return soup;
}

inline std::vector<std::array<double, 2>> regular_polygon(int n, double radius) {
  std::vector<std::array<double, 2>> polygon;
  for (int i = 0; i < n; ++i) {
    const double a = 2 * std::numbers::pi * i / n;
    polygon.push_back({radius * std::cos(a), radius * std::sin(a)});
  }
  return polygon;
}

// An isosceles triangle with that angle at the origin, sides of length 1, 1 high.
inline TriangleSoup wedge(double degrees) {
  const double half = degrees / 2 * std::numbers::pi / 180;
  return prism({{0, 0}, {std::cos(half), -std::sin(half)}, {std::cos(half), std::sin(half)}}, 1);
}

// n sides, radius 1 at z = 0, tip at z = 1.
inline TriangleSoup cone(int n) {
  TriangleSoup soup = prism(regular_polygon(n, 1), 1);
  const auto count = static_cast<std::uint32_t>(n);
  for (Facet& f : soup.facets)
    for (std::uint32_t& v : f)
      if (v >= count && v < 2 * count) v = 2 * count + 1;
  std::erase_if(soup.facets, [](const Facet& f) { return f[0] == f[1] || f[1] == f[2] || f[2] == f[0]; });
  return weld(soup);
}

// The union of unit cubes at the given places: convex edges, concave ones, and corners where both meet.
inline TriangleSoup cubes(const std::vector<std::array<int, 3>>& places) {
  const std::set<std::array<int, 3>> solid(places.begin(), places.end());
  TriangleSoup soup;
  for (const auto& c : solid)
    for (std::size_t axis = 0; axis < 3; ++axis)
      for (const int side : {0, 1}) {
        std::array<int, 3> next = c;
        next[axis] += 2 * side - 1;
        if (solid.contains(next)) continue;
        const std::size_t u = (axis + 1) % 3, v = (axis + 2) % 3;
        const auto first = static_cast<std::uint32_t>(soup.points.size());
        for (const auto& [i, j] : {std::array{0, 0}, std::array{1, 0}, std::array{1, 1}, std::array{0, 1}}) {
          std::array<int, 3> p = c;
          p[axis] += side, p[u] += side ? i : j, p[v] += side ? j : i;
          soup.points.push_back({p[0] + 0.0, p[1] + 0.0, p[2] + 0.0});
        }
        soup.facets.push_back({first, first + 1, first + 2});
        soup.facets.push_back({first, first + 2, first + 3});
      }
  return weld(soup);
}

// A block with a ridge along the middle of its upper side, sharp at one end, gone at the other: |x - 1| slopes by `steepest` y / 2 over [0, 2]^2.
inline TriangleSoup block_with_fading_ridge(int n, double steepest) {
  return mapped(box({2, 2, 1.5}, 2 * n, 2 * n, 1), [&](const Vec3& p) {
    return p.z > 1 ? Vec3{p.x, p.y, p.z - steepest * p.y / 2 * std::abs(p.x - 1)} : p;
  });
}

// A rotation about the origin, spread evenly (Shoemake 1992).
struct Rotation {
  std::array<double, 4> q{1, 0, 0, 0};
  static Rotation random(std::mt19937_64& engine) {
    const auto uniform = [&] { return static_cast<double>(engine() >> 11) * 0x1p-53; };
    const double u = uniform(), a = 2 * std::numbers::pi * uniform(), b = 2 * std::numbers::pi * uniform();
    return {{std::sqrt(1 - u) * std::sin(a), std::sqrt(1 - u) * std::cos(a), std::sqrt(u) * std::sin(b), std::sqrt(u) * std::cos(b)}};
  }
  Vec3 operator()(const Vec3& p) const {
    const Vec3 v{q[1], q[2], q[3]};
    const Vec3 t = cross(v, p) * 2;
    return p + t * q[0] + cross(v, t);
  }
};

// A solid through the lattice.
struct Sharpened {
  TriangleSoup s;  // in lattice coordinates
  Creases creases;
  TriangleSoup m;
  SharpenedSurface result;
  std::size_t stuck = 0;  // vertices where settling did not help
};

// `stays`: as `sharpen` takes them.
inline Sharpened sharpened(const TriangleSoup& solid, double cell, const CreaseOptions& which = {}, const std::vector<std::uint8_t>& stays = {}) {
  const GridFrame frame = make_frame(bounding_box(solid), cell, 8);
  Sharpened out;
  out.s = to_lattice(solid, frame);
  out.creases = find_creases(out.s, which);
  out.m = extract_surface(level_set_from_triangles(solid, frame).level_set).soup;
  out.result = sharpen(out.m, ReferenceSurface(out.s, out.creases), stays);
  return out;
}

// The same, settled.
inline Sharpened sharpened_and_settled(const TriangleSoup& solid, double cell, const CreaseOptions& which = {}) {
  Sharpened out = sharpened(solid, cell, which);
  Sharpening sharpening(out.m, ReferenceSurface(out.s, out.creases));
  out.stuck = sharpening.settle().size();
  out.result = sharpening.surface();
  return out;
}

// Points that lie on M, though they could have been moved.
inline std::size_t points_on_m(const Sharpened& x) {
  std::size_t count = 0;
  for (std::size_t v = 0; v < x.result.soup.points.size(); ++v) {
    const auto& [a, b] = x.result.parents[v];
    const Vec3 &p = x.result.soup.points[v], &u = x.m.points[a], &w = x.m.points[b];
    if (norm(cross(p - u, w - u)) <= 1e-9 && norm(p - u) <= norm(w - u) + 1e-12) ++count;
  }
  return count;
}

}  // namespace burnish::test
