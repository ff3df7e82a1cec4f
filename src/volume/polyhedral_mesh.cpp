#include "burnish/volume/polyhedral_mesh.h"

#include <algorithm>

#include "burnish/core/parallel.h"

namespace burnish {

CellFaces cell_faces(const PolyhedralMesh& mesh) {
  CellFaces result;
  result.first.assign(mesh.cells + std::size_t{1}, 0);
  const auto sides = [&](auto&& visit) {
    for (std::uint32_t f = 0; f < mesh.faces(); ++f) {
      visit(mesh.owner[f], f);
      if (f < mesh.internal_faces()) visit(mesh.neighbour[f], f);
    }
  };
  sides([&](std::uint32_t c, std::uint32_t) { ++result.first[c + std::size_t{1}]; });
  for (std::size_t c = 0; c < mesh.cells; ++c) result.first[c + 1] += result.first[c];
  result.at.resize(result.first.back());
  std::vector<std::uint64_t> next(result.first.begin(), result.first.end() - 1);
  sides([&](std::uint32_t c, std::uint32_t f) { result.at[next[c]++] = f; });
  return result;
}

Vec3 face_middle(const PolyhedralMesh& mesh, std::size_t face) {
  Vec3 sum;
  for (const std::uint32_t p : mesh.face(face)) sum = sum + mesh.points[p];
  return sum / static_cast<double>(mesh.face(face).size());
}

// [T-MESH-1]
CellGeometry cell_geometry(const PolyhedralMesh& mesh, const CellFaces& faces) {
  CellGeometry result;
  result.volume.resize(mesh.cells);
  result.middle.resize(mesh.cells);
  result.box.resize(mesh.cells);
  parallel_for(mesh.cells, [&](std::size_t c) {
    Vec3 sum;
    for (const std::uint32_t f : faces[c]) sum = sum + face_middle(mesh, f);
    const Vec3 apex = result.middle[c] = sum / static_cast<double>(std::max<std::size_t>(1, faces[c].size()));
    double sixfold = 0;
    for (const std::uint32_t f : faces[c]) {
      const auto points = mesh.face(f);
      const Vec3 middle = points.size() > 3 ? face_middle(mesh, f) : mesh.points[points[0]];
      double outward = 0;
      for (std::size_t i = 0; i < points.size(); ++i) {
        const Vec3 &a = mesh.points[points[i]], &b = mesh.points[points[(i + 1) % points.size()]];
        outward += dot(middle - apex, cross(a - apex, b - apex));
        result.box[c].extend(a);
      }
      sixfold += mesh.owner[f] == c ? outward : -outward;
    }
    result.volume[c] = sixfold / 6;
  });
  return result;
}

}  // namespace burnish
