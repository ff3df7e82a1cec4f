#include "mesh_quality_shapes.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/core/parallel.h"
#include "foam_geometry.h"

namespace burnish::quality {
namespace {

using ShapeFace = std::array<int, 4>;
using Pairs = std::vector<std::pair<std::size_t, std::size_t>>;

bool share_an_edge(const ShapeFace& a, const ShapeFace& b) {
  return std::count_if(a.begin(), a.end(), [&](int corner) { return corner >= 0 && std::find(b.begin(), b.end(), corner) != b.end(); }) == 2;
}

Pairs neighbouring_faces(CellShape shape) {
  const auto faces = faces_of_shape(shape);
  Pairs pairs;
  for (std::size_t i = 0; i < faces.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (share_an_edge(faces[i], faces[j])) pairs.push_back({i, j});
  return pairs;
}

// By its diagonals, a quadrangle's area vector is that of any triangulation.
Vec3 unit_normal(const VolumeMesh& mesh, std::span<const std::uint32_t> corners, const ShapeFace& f) {
  const auto at = [&](int i) -> const Vec3& { return mesh.mesh.points[corners[static_cast<std::size_t>(f[static_cast<std::size_t>(i)])]]; };
  const Vec3 n = f[3] < 0 ? cross(at(1) - at(0), at(2) - at(0)) : cross(at(2) - at(0), at(3) - at(1));
  const double length = norm(n);
  return length > 0 ? n / length : Vec3{};
}

// Cosines: the greatest is that of the least angle.
struct Cosines {
  std::array<double, kCellShapes> greatest, least;
  Cosines() { greatest.fill(-2), least.fill(2); }
  void add(std::size_t shape, double cosine) {
    greatest[shape] = std::max(greatest[shape], cosine);
    least[shape] = std::min(least[shape], cosine);
  }
};

void add_cell(const VolumeMesh& mesh, std::size_t c, const std::array<Pairs, kCellShapes>& pairs, Cosines& cosines) {
  const auto shape = static_cast<std::size_t>(mesh.shape[c]);
  const auto faces = faces_of_shape(mesh.shape[c]);
  std::array<Vec3, 6> normals;
  for (std::size_t i = 0; i < faces.size(); ++i) normals[i] = unit_normal(mesh, mesh.cell(c), faces[i]);
  for (const auto& [i, j] : pairs[shape]) {
    if (normals[i] == Vec3{} || normals[j] == Vec3{}) cosines.add(shape, 1), cosines.add(shape, -1);  // a face without area has any angle
    else cosines.add(shape, -dot(normals[i], normals[j]));
  }
}

Cosines combined(Cosines a, const Cosines& b) {
  for (std::size_t s = 0; s < kCellShapes; ++s) {
    a.greatest[s] = std::max(a.greatest[s], b.greatest[s]);
    a.least[s] = std::min(a.least[s], b.least[s]);
  }
  return a;
}

}  // namespace

// [T-QUAL-12]
std::array<AngleRange, kCellShapes> dihedral_angles(const VolumeMesh& mesh) {
  std::array<Pairs, kCellShapes> pairs;
  for (std::size_t s = 0; s < kCellShapes; ++s) pairs[s] = neighbouring_faces(static_cast<CellShape>(s));
  const Cosines all = parallel_reduce(
      mesh.cells(), kDefaultGrain, Cosines{},
      [&](std::size_t begin, std::size_t end) {
        Cosines cosines;
        for (std::size_t c = begin; c < end; ++c) add_cell(mesh, c, pairs, cosines);
        return cosines;
      },
      combined);
  std::array<AngleRange, kCellShapes> angles;
  for (std::size_t s = 0; s < kCellShapes; ++s)
    if (all.greatest[s] >= all.least[s]) angles[s] = {foam::degrees(all.greatest[s]), foam::degrees(all.least[s])};
  return angles;
}

}  // namespace burnish::quality
