#include "cell_centres.h"

#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

struct FaceCentre {
  Vec3 at, area;  // area: normal of that length
};

FaceCentre face_centre(const PolyhedralMesh& mesh, std::size_t face) {
  const auto points = mesh.face(face);
  const auto p = [&](std::size_t i) { return mesh.points[points[i % points.size()]]; };
  const Vec3 middle = face_middle(mesh, face);
  if (points.size() == 3) return {middle, 0.5 * cross(p(1) - p(0), p(2) - p(0))};
  Vec3 normal, weighted;
  double area = 0;
  for (std::size_t i = 0; i < points.size(); ++i) {
    const Vec3 n = cross(p(i + 1) - p(i), middle - p(i));
    const double a = norm(n);
    normal += n;
    area += a;
    weighted += (p(i) + p(i + 1) + middle) * a;
  }
  if (!(area > 0)) return {middle, {}};
  return {weighted / (3 * area), 0.5 * normal};
}

}  // namespace

std::vector<Vec3> cell_centres(const PolyhedralMesh& mesh, const CellFaces& faces) {
  std::vector<FaceCentre> at(mesh.faces());
  parallel_for(at.size(), [&](std::size_t f) { at[f] = face_centre(mesh, f); });
  std::vector<Vec3> centres(mesh.cells);
  parallel_for(centres.size(), [&](std::size_t c) {
    Vec3 estimate, weighted;
    for (const std::uint32_t f : faces[c]) estimate += at[f].at;
    estimate = estimate / static_cast<double>(std::max<std::size_t>(1, faces[c].size()));
    double volume = 0;
    for (const std::uint32_t f : faces[c]) {
      const double pyramid = dot(at[f].area, at[f].at - estimate) * (mesh.owner[f] == c ? 1 : -1);
      weighted += (0.75 * at[f].at + 0.25 * estimate) * pyramid;
      volume += pyramid;
    }
    centres[c] = std::abs(volume) > 0 ? weighted / volume : estimate;
  });
  return centres;
}

}  // namespace burnish
