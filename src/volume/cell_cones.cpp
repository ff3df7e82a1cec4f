#include "cell_cones.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace burnish {
namespace {

// Twice the vector area of the triangles from the middle to the sides.
Vec3 area_vector(std::span<const Vec3> polygon, const Vec3& middle) {
  Vec3 sum;
  for (std::size_t i = 0; i < polygon.size(); ++i)
    sum += cross(polygon[i] - middle, polygon[(i + 1) % polygon.size()] - middle);
  return sum;
}

// To rounding: whether it is one plane polygon, and turns one way only.
bool is_plane_and_convex(std::span<const Vec3> polygon, const Vec3& middle, const Vec3& twice_area) {
  constexpr double kRounding = 1e-13;
  const double area = norm(twice_area), size = std::sqrt(area);
  if (!(area > 0)) return false;
  const Vec3 normal = twice_area / area;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &a = polygon[i], &b = polygon[(i + 1) % polygon.size()], &c = polygon[(i + 2) % polygon.size()];
    if (std::abs(dot(a - middle, normal)) > kRounding * size) return false;
    if (dot(cross(b - a, c - b), normal) < -kRounding * area || dot(cross(a - middle, b - middle), normal) < 0) return false;
  }
  return true;
}

}  // namespace

void CellCones::build(const PolyhedralMesh& mesh, std::span<const std::uint32_t> faces, std::uint32_t cell, const Vec3& apex) {
  cones_.clear();
  sides_.clear();
  for (const std::uint32_t f : faces) add_face(mesh, f, mesh.owner[f] != cell, apex);
}

// All is measured at the face alone, before the apex comes in, so that both its cells do the same.
void CellCones::add_face(const PolyhedralMesh& mesh, std::uint32_t face, bool turned, const Vec3& apex) {
  const auto points = mesh.face(face);
  const Vec3 middle = face_middle(mesh, face);
  polygon_.clear();
  for (const std::uint32_t p : points) polygon_.push_back(mesh.points[p]);
  const Vec3 twice_area = area_vector(polygon_, middle);
  const bool whole = points.size() <= kMostSides && (points.size() == 3 || is_plane_and_convex(polygon_, middle, twice_area));
  if (turned) std::reverse(polygon_.begin(), polygon_.end());
  const Vec3 largest = max(max(middle, middle * -1.0), max(apex, apex * -1.0));
  const double rounding = 8 * std::numeric_limits<double>::epsilon() * std::max({largest.x, largest.y, largest.z});
  for (Vec3& p : polygon_) p -= apex;
  if (whole) return add_cone(polygon_, turned ? twice_area * -1.0 : twice_area, rounding);
  for (std::size_t i = 0; i < polygon_.size(); ++i) {
    const std::array<Vec3, 3> triangle{middle - apex, polygon_[i], polygon_[(i + 1) % polygon_.size()]};
    add_cone(triangle, cross(triangle[1] - triangle[0], triangle[2] - triangle[0]), rounding);
  }
}

void CellCones::add_cone(std::span<const Vec3> base, const Vec3& normal, double rounding) {
  const double sixfold = dot(normal, base[0]);
  if (sixfold == 0 || !std::isfinite(sixfold)) return;
  Cone cone;
  cone.height = normal / sixfold;
  cone.sign = sixfold > 0 ? 1 : -1;
  cone.rounding = rounding * norm(cone.height);
  cone.first_side = static_cast<std::uint32_t>(sides_.size());
  cone.sides = static_cast<std::uint32_t>(base.size());
  for (std::size_t i = 0; i < base.size(); ++i) sides_.push_back(cross(base[i], base[(i + 1) % base.size()]) * cone.sign);
  cones_.push_back(cone);
}

}  // namespace burnish
