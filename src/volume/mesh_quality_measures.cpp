#include "mesh_quality_measures.h"

#include <algorithm>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/core/scramble.h"

namespace burnish::quality {

namespace {

constexpr double kDegree = 3.14159265358979323846 / 180;

Box3 box_of(const std::vector<Vec3>& points) {
  return parallel_reduce(
      points.size(), kDefaultGrain, Box3{},
      [&](std::size_t begin, std::size_t end) {
        Box3 box;
        for (std::size_t p = begin; p < end; ++p) box.extend(points[p]);
        return box;
      },
      [](Box3 a, const Box3& b) {
        a.extend(b);
        return a;
      });
}

}  // namespace

Limits limits_of(const MeshQualityLimits& limits) {
  Limits result{};  // counts of what should not be there: 0
  result[faces_of_cell] = 4;
  result[boundary_openness] = result[cell_openness] = 1e-6;
  result[aspect_ratio] = limits.aspect_ratio;
  result[face_area] = result[cell_volume] = foam::kVerySmall;
  result[non_orthogonality] = std::cos(limits.non_orthogonality * kDegree);
  result[pyramids] = -foam::kSmall;
  result[internal_skewness] = limits.internal_skewness;
  result[boundary_skewness] = limits.boundary_skewness;
  result[concave_faces] = std::sin(limits.concave_degrees * kDegree);
  result[flatness] = limits.flatness;
  result[determinant] = limits.determinant;
  result[weight] = limits.weight;
  result[volume_ratio] = limits.volume_ratio;
  return result;
}

Limits limits_of(const MeshQualityLimits& limits, const PolyhedralMesh& mesh) {
  Limits result = limits_of(limits);
  result[edge_length] = 1e-6 * box_of(mesh.points).diagonal();
  return result;
}

double shown(int check, double value) {
  if (check == non_orthogonality) return foam::degrees(value);
  if (check == concave_faces) return std::asin(std::min(1.0, value)) / kDegree;
  return value;
}

StoredGeometry stored_geometry(const PolyhedralMesh& mesh, const CellFaces& faces) {
  StoredGeometry result{mesh, faces, std::vector<foam::Cell>(mesh.cells)};
  parallel_ranges(mesh.cells, kDefaultGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<foam::Side> scratch;
    for (std::size_t c = begin; c < end; ++c) result.cell_geometry[c] = foam::cell(mesh, faces, c, scratch);
  });
  return result;
}

int repeated_points(foam::Loop loop) {
  int repeated = 0;
  for (std::size_t i = 1; i < loop.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (loop[j] == loop[i]) {
        ++repeated;
        break;
      }
  return repeated;
}

double shortest_edge(foam::Loop loop, foam::Points points) {
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t i = 0; i < loop.size(); ++i) least = std::min(least, squared_norm(points[loop[i]] - points[loop[i + 1 < loop.size() ? i + 1 : 0]]));
  return std::sqrt(least);
}

namespace {

using Edge = std::pair<std::uint32_t, std::uint32_t>;

template <class Visit>
void for_each_edge_use(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell, Visit&& visit) {
  for (const std::uint32_t f : faces[cell]) {
    const auto loop = mesh.face(f);
    for (std::size_t i = 0; i < loop.size(); ++i) visit(std::minmax(loop[i], loop[i + 1 < loop.size() ? i + 1 : 0]));
  }
}

}  // namespace

// [T-QUAL-11] Where each edge is used an even number of times the scrambled edges cancel; others are counted.
int open_edges(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell) {
  std::uint64_t sum = 0;
  for_each_edge_use(mesh, faces, cell, [&](const Edge& e) { sum ^= scramble((std::uint64_t{e.first} << 32 | e.second) + kScrambleStep); });
  if (sum == 0) return 0;
  std::vector<Edge> uses;
  for_each_edge_use(mesh, faces, cell, [&](const Edge& e) { uses.push_back(e); });
  std::sort(uses.begin(), uses.end());
  int open = 0;
  for (std::size_t i = 0, next; i < uses.size(); i = next) {
    for (next = i + 1; next < uses.size() && uses[next] == uses[i];) ++next;
    if (next - i == 1) ++open;
  }
  return open;
}

foam::Cell measure_cell(const PolyhedralMesh& mesh, const CellFaces& faces, std::size_t cell, std::vector<foam::Side>& sides, Measures& m) {
  const foam::Cell geometry = foam::cell(mesh, faces, cell, sides);
  const foam::Closedness closed = foam::closedness(sides, geometry.volume);
  m[faces_of_cell] = static_cast<double>(sides.size());
  m[zip_up] = open_edges(mesh, faces, cell);
  m[cell_openness] = closed.openness;
  m[aspect_ratio] = closed.aspect_ratio;
  m[cell_volume] = geometry.volume;
  m[determinant] = foam::determinant(sides);
  m[concave_cells] = foam::is_concave(sides) ? 1 : 0;
  return geometry;
}

}  // namespace burnish::quality
