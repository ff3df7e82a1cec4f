#include "mesh_quality_topology.h"

#include "burnish/core/parallel.h"

namespace burnish::quality {

std::uint64_t unused_point_count(const PolyhedralMesh& mesh) {
  std::vector<bool> used(mesh.points.size(), false);
  std::uint64_t unused = mesh.points.size();
  for (const std::uint32_t p : mesh.face_points) {
    if (!used[p]) --unused;
    used[p] = true;
  }
  return unused;
}

namespace {

std::uint64_t misordered_of_cell(const PolyhedralMesh& mesh, std::span<const std::uint32_t> faces, std::size_t cell) {
  std::uint64_t wrong = 0;
  std::uint32_t previous = 0;
  for (const std::uint32_t f : faces) {
    if (f >= mesh.internal_faces() || mesh.owner[f] != cell) continue;
    const std::uint32_t neighbour = mesh.neighbour[f];
    if (neighbour <= cell || neighbour < previous) ++wrong;
    previous = neighbour;
  }
  return wrong;
}

}  // namespace

std::uint64_t misordered_face_count(const PolyhedralMesh& mesh, const CellFaces& faces) {
  return parallel_reduce(
      mesh.cells, kDefaultGrain, std::uint64_t{0},
      [&](std::size_t begin, std::size_t end) {
        std::uint64_t wrong = 0;
        for (std::size_t c = begin; c < end; ++c) wrong += misordered_of_cell(mesh, faces[c], c);
        return wrong;
      },
      [](std::uint64_t a, std::uint64_t b) { return a + b; });
}

}  // namespace burnish::quality
