// The cones over the faces of a cell, from a point of one's choice: with signs they add up to the cell.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

#include "burnish/volume/polyhedral_mesh.h"

namespace burnish {

// A cone over a plane, convex polygon, from the origin: x is in it where side . x >= 0 for all sides and height . x <= 1.
struct Cone {
  Vec3 height;
  double sign = 1;       // -1: the base turns its back to the apex, and the cone is to be taken away
  double rounding = 0;   // of height . x, by that of coordinates
  std::uint32_t first_side = 0, sides = 0;
};

class CellCones {
 public:
  // Polygons with more sides are cut into triangles, so that a clipped triangle has at most this many points and four more.
  static constexpr std::size_t kMostSides = 24;

  // One cone for each face that is plane and convex, one for each of its triangles [T-MESH-1] for others. What was there before is
  // forgotten, but not its memory.
  void build(const PolyhedralMesh& mesh, std::span<const std::uint32_t> faces, std::uint32_t cell, const Vec3& apex);

  const std::vector<Cone>& cones() const { return cones_; }
  std::span<const Vec3> sides(const Cone& cone) const { return {sides_.data() + cone.first_side, cone.sides}; }

 private:
  void add_face(const PolyhedralMesh& mesh, std::uint32_t face, bool turned, const Vec3& apex);
  void add_cone(std::span<const Vec3> base, const Vec3& normal, double rounding);

  std::vector<Cone> cones_;
  std::vector<Vec3> sides_, polygon_;
};

}  // namespace burnish
