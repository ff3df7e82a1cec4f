#include "relax.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <span>

namespace burnish {
namespace {

// At each corner, with its neighbours in an order that makes the determinant positive.
constexpr std::array<std::array<int, 4>, 1> kTetrahedron{{{0, 1, 2, 3}}};
constexpr std::array<std::array<int, 4>, 4> kPyramid{{{0, 1, 3, 4}, {1, 2, 0, 4}, {2, 3, 1, 4}, {3, 0, 2, 4}}};
constexpr std::array<std::array<int, 4>, 6> kWedge{{{0, 2, 1, 3}, {1, 0, 2, 4}, {2, 1, 0, 5}, {3, 4, 5, 0}, {4, 5, 3, 1}, {5, 3, 4, 2}}};
constexpr std::array<std::array<int, 4>, 8> kHexahedron{{{0, 1, 3, 4}, {1, 2, 0, 5}, {2, 3, 1, 6}, {3, 0, 2, 7}, {4, 7, 5, 0}, {5, 4, 6, 1}, {6, 5, 7, 2}, {7, 6, 4, 3}}};

std::span<const std::array<int, 4>> corner_tetrahedra(CellShape shape) {
  switch (shape) {
    case CellShape::tetrahedron: return kTetrahedron;
    case CellShape::pyramid: return kPyramid;
    case CellShape::wedge: return kWedge;
    case CellShape::hexahedron: return kHexahedron;
    case CellShape::polyhedron: break;
  }
  return {};
}

// [T-HEX-7] Negative for an inverted tetrahedron.
double mean_ratio(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& d) {
  const Vec3 u = b - a, v = c - a, w = d - a;
  const double volume = dot(cross(u, v), w) / 6;
  const double lengths = squared_norm(u) + squared_norm(v) + squared_norm(w) + squared_norm(c - b) + squared_norm(d - c) + squared_norm(b - d);
  return std::copysign(12 * std::cbrt(9 * volume * volume) / lengths, volume);
}

void move(VolumeMesh& mesh, const PointCells& around, std::uint32_t p) {
  Vec3 mean;
  double count = 0;
  for (const std::uint32_t c : around[p])
    for (const std::uint32_t q : mesh.cell(c))
      if (q != p) mean += mesh.mesh.points[q], ++count;
  if (count == 0) return;
  Vec3& at = mesh.mesh.points[p];
  const Vec3 start = at, step = mean / count - start;
  const double before = worst_shape(mesh, around[p]);
  for (const double part : {1.0, 0.5, 0.25}) {
    at = start + step * part;
    if (worst_shape(mesh, around[p]) > before) return;
  }
  at = start;
}

}  // namespace

double worst_shape(const VolumeMesh& mesh, std::span<const std::uint32_t> cells) {
  double least = std::numeric_limits<double>::infinity();
  for (const std::uint32_t c : cells) {
    const auto cell = mesh.cell(c);
    const auto at = [&](int k) { return mesh.mesh.points[cell[static_cast<std::size_t>(k)]]; };
    for (const std::array<int, 4>& t : corner_tetrahedra(mesh.shape[c])) least = std::min(least, mean_ratio(at(t[0]), at(t[1]), at(t[2]), at(t[3])));
  }
  return least;
}

void relax(VolumeMesh& mesh, const PointCells& around, const std::vector<std::uint8_t>& free, int sweeps) {
  for (int sweep = 0; sweep < sweeps; ++sweep)
    for (std::uint32_t p = 0; p < free.size(); ++p)
      if (free[p]) move(mesh, around, p);
}

}  // namespace burnish
