#include "cell_tetrahedra.h"

#include <algorithm>

namespace burnish {

void CellTetrahedra::clear() {
  points.clear();
  phi.clear();
  tetrahedra.clear();
}

void CellTetrahedra::add(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const NearCells& near,
                         std::uint32_t cell, std::uint32_t slot) {
  ids_.clear();
  for (const std::uint32_t f : faces[cell]) ids_.insert(ids_.end(), mesh.face(f).begin(), mesh.face(f).end());
  std::sort(ids_.begin(), ids_.end());
  ids_.erase(std::unique(ids_.begin(), ids_.end()), ids_.end());
  const std::uint32_t apex = add_point(geometry.middle[cell], near.at_middle[cell]);
  first_ = apex + 1;
  for (const std::uint32_t p : ids_) add_point(mesh.points[p], near.at_point[p]);
  for (const std::uint32_t f : faces[cell]) add_face(mesh, near, f, apex, slot, mesh.owner[f] == cell ? 1 : -1);
}

void CellTetrahedra::add_face(const PolyhedralMesh& mesh, const NearCells& near, std::uint32_t face, std::uint32_t apex, std::uint32_t slot, double sign) {
  const auto ids = mesh.face(face);
  const auto local = [&](std::size_t i) {
    return first_ + static_cast<std::uint32_t>(std::lower_bound(ids_.begin(), ids_.end(), ids[i % ids.size()]) - ids_.begin());
  };
  if (ids.size() == 3) return add_tetrahedron({apex, local(0), local(1), local(2)}, slot, sign);
  const std::uint32_t middle = add_point(face_middle(mesh, face), near.at_face[face]);
  for (std::size_t i = 0; i < ids.size(); ++i) add_tetrahedron({apex, middle, local(i), local(i + 1)}, slot, sign);
}

std::uint32_t CellTetrahedra::add_point(const Vec3& p, double value) {
  points.push_back(p);
  phi.push_back(value);
  return static_cast<std::uint32_t>(points.size() - 1);
}

void CellTetrahedra::add_tetrahedron(const std::array<std::uint32_t, 4>& corner, std::uint32_t slot, double sign) {
  const Vec3& o = points[corner[0]];
  const double volume = sign * dot(points[corner[1]] - o, cross(points[corner[2]] - o, points[corner[3]] - o)) / 6;
  if (volume != 0) tetrahedra.push_back({corner, slot, volume});
}

}  // namespace burnish
