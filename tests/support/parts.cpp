#include "support/parts.h"

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <numbers>

#include "burnish/surface/weld.h"

namespace burnish::test {
namespace {

void add_triangle(TriangleSoup& soup, const Vec3& a, const Vec3& b, const Vec3& c) {
  const auto first = static_cast<std::uint32_t>(soup.points.size());
  soup.points.insert(soup.points.end(), {a, b, c});
  soup.facets.push_back({first, first + 1, first + 2});
}

// Corners counter-clockwise seen from outside. Without the half that has no area, where two corners are one.
void add_quad(TriangleSoup& soup, const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  add_triangle(soup, a, b, c);
  if (c != d) add_triangle(soup, a, c, d);
}

// The bracket in plan is a row of unit squares; each is drawn as a ring of 4 n quads between its outline and its hole.
class BracketMaker {
 public:
  explicit BracketMaker(int n) : n_(n) {}

  TriangleSoup make() {
    for (int cell = 0; cell < kCells; ++cell)
      for (int k = 0; k < 4 * n_; ++k) {
        add_faces(cell, k);
        add_outer_wall(cell, k);
        if (kHasHole[static_cast<std::size_t>(cell)]) add_wall(inner(cell, k + 1), inner(cell, k), 0, kPlate);
      }
    return weld(soup_);
  }

 private:
  static constexpr int kCells = 3;
  static constexpr double kPlate = 0.25, kRadius = 0.3;
  static constexpr std::array<bool, kCells> kHasHole{true, true, false};
  static constexpr std::array<double, kCells> kHeight{kPlate, kPlate, 1};

  static double height(int cell) { return cell < 0 || cell >= kCells ? 0 : kHeight[static_cast<std::size_t>(cell)]; }
  static Vec3 at_height(const Vec3& p, double z) { return {p.x, p.y, z}; }

  // Point k of the outline, counter-clockwise from the corner (0, 0). Squares side by side get the same bits.
  Vec3 outer(int cell, int k) const {
    const int side = k / n_ % 4, i = k % n_;
    const auto part = [&](int steps) { return static_cast<double>(steps) / n_; };
    switch (side) {
      case 0: return {cell + part(i), 0, 0};
      case 1: return {cell + 1.0, part(i), 0};
      case 2: return {cell + part(n_ - i), 1, 0};
      default: return {cell + 0.0, part(n_ - i), 0};
    }
  }
  Vec3 inner(int cell, int k) const {
    const double radius = kHasHole[static_cast<std::size_t>(cell)] ? kRadius : 0;
    const double angle = std::numbers::pi * (0.5 * (k % (4 * n_)) / n_ - 0.75);
    return {cell + 0.5 + radius * std::cos(angle), 0.5 + radius * std::sin(angle), 0};
  }

  void add_faces(int cell, int k) {
    const Vec3 a = outer(cell, k), b = outer(cell, k + 1), c = inner(cell, k + 1), d = inner(cell, k);
    const double z = height(cell);
    add_quad(soup_, at_height(a, z), at_height(b, z), at_height(c, z), at_height(d, z));
    add_quad(soup_, b, a, d, c);
  }
  // Upright, outwards to the right of the way from a to b.
  void add_wall(const Vec3& a, const Vec3& b, double from, double to) {
    add_quad(soup_, at_height(a, from), at_height(b, from), at_height(b, to), at_height(a, to));
  }
  // Down to what stands beside it; in two storeys, so that the block's corners match the plate's.
  void add_outer_wall(int cell, int k) {
    const int side = k / n_;
    const double beside = side == 1 ? height(cell + 1) : side == 3 ? height(cell - 1) : 0;
    const Vec3 a = outer(cell, k), b = outer(cell, k + 1);
    if (beside < kPlate) add_wall(a, b, 0, kPlate);
    if (beside < 1 && height(cell) == 1) add_wall(a, b, kPlate, 1);
  }

  int n_;
  TriangleSoup soup_;
};

// n x m squares; at(i, j) counter-clockwise in i and j seen from outside.
void add_grid(TriangleSoup& soup, int n, int m, const std::function<Vec3(int, int)>& at) {
  for (int j = 0; j < m; ++j)
    for (int i = 0; i < n; ++i) add_quad(soup, at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1));
}

}  // namespace

TriangleSoup box(const Vec3& extent, int nx, int ny, int nz) {
  const auto point = [&](int i, int j, int k) { return Vec3{extent.x * i / nx, extent.y * j / ny, extent.z * k / nz}; };
  TriangleSoup soup;
  add_grid(soup, ny, nx, [&](int j, int i) { return point(i, j, 0); });
  add_grid(soup, nx, ny, [&](int i, int j) { return point(i, j, nz); });
  add_grid(soup, nx, nz, [&](int i, int k) { return point(i, 0, k); });
  add_grid(soup, nz, nx, [&](int k, int i) { return point(i, ny, k); });
  add_grid(soup, nz, ny, [&](int k, int j) { return point(0, j, k); });
  add_grid(soup, ny, nz, [&](int j, int k) { return point(nx, j, k); });
  return weld(soup);
}

TriangleSoup thin_plate() { return box({1, 0.6, 0.02}, 20, 12, 1); }

TriangleSoup bracket(int n) { return BracketMaker(n).make(); }

}  // namespace burnish::test
