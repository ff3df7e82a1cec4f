#include "near_cells.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr std::size_t kBatch = 4096;

std::vector<double> distances(const SolidField& field, const std::vector<Vec3>& points, Progress& progress) {
  std::vector<double> phi(points.size());
  parallel_ranges(points.size(), kBatch, [&](std::size_t begin, std::size_t end) {
    progress.check();
    field.distance(std::span(points).subspan(begin, end - begin), phi.data() + begin);
  });
  return phi;
}

// phi at the marked ones of `count` places.
template <class Place>
std::vector<double> distances_where(const SolidField& field, const std::vector<char>& marked, Place&& place, Progress& progress) {
  std::vector<Vec3> points;
  for (std::size_t i = 0; i < marked.size(); ++i)
    if (marked[i]) points.push_back(place(i));
  const std::vector<double> phi = distances(field, points, progress);
  std::vector<double> all(marked.size(), 0);
  for (std::size_t i = 0, n = 0; i < marked.size(); ++i)
    if (marked[i]) all[i] = phi[n++];
  return all;
}

}  // namespace

NearCells near_cells(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field, Progress& progress) {
  NearCells near;
  near.at_middle = distances(field, geometry.middle, progress);
  std::vector<char> face(mesh.faces(), 0), point(mesh.points.size(), 0);
  for (std::uint32_t c = 0; c < mesh.cells; ++c) {
    const Vec3 &m = geometry.middle[c], reach = max(geometry.box[c].upper - m, m - geometry.box[c].lower);
    if (shows_free(near.at_middle[c], field.band, norm(reach))) continue;
    near.cells.push_back(c);
    for (const std::uint32_t f : faces[c]) {
      face[f] = mesh.face(f).size() > 3;
      for (const std::uint32_t p : mesh.face(f)) point[p] = 1;
    }
  }
  near.at_face = distances_where(field, face, [&](std::size_t f) { return face_middle(mesh, f); }, progress);
  near.at_point = distances_where(field, point, [&](std::size_t p) { return mesh.points[p]; }, progress);
  return near;
}

}  // namespace burnish
