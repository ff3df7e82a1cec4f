#include "mend.h"

#include <algorithm>
#include <array>
#include <utility>

#include "burnish/octree/octree.h"

namespace burnish {
namespace {

constexpr std::size_t kMostMended = 256;  // bad cells at a time: a mesh with more is beyond mending

}  // namespace

std::vector<BadCell> without_split_ones(const VolumeMesh& mesh, std::vector<BadCell> bad) {
  std::erase_if(bad, [&](const BadCell& b) { return mesh.shape[b.cell] == CellShape::polyhedron && b.check == "concave cells"; });
  return bad;
}

std::vector<BadCell> Mending::mend(std::vector<BadCell> bad, int rounds) {
  for (int round = 0; round < rounds && !bad.empty(); ++round) {
    if (bad.size() > kMostMended) bad.resize(kMostMended);
    for (const BadCell& b : bad)
      for (const std::uint32_t p : volume_.cell(b.cell))
        if (!fixed_[p] && mend_by(p)) break;
    std::vector<std::uint32_t> again;
    for (const BadCell& b : bad)
      for (const std::uint32_t p : volume_.cell(b.cell)) again.push_back(p);
    bad = judged_again(bad, again);
  }
  return bad;
}

// True if no cell that the point concerns is bad any more.
bool Mending::mend_by(std::uint32_t p) {
  const std::vector<std::uint32_t> concerned = cells_concerned({p});
  Vec3& at = volume_.mesh.points[p];
  const Vec3 start = at;
  Vec3 best = start;
  double least = badness(concerned);
  for (const double step : {0.1, 0.2, 0.4})
    for (int d = 0; d < kDirections && least > 0; ++d) {
      if (d == kSelf) continue;
      const std::array<int, 3> o = offset_of(d);
      const Vec3 direction{static_cast<double>(o[0]), static_cast<double>(o[1]), static_cast<double>(o[2])};
      at = start + direction * (step * cell_ / norm(direction));
      const double now = badness(concerned);
      if (now < least) least = now, best = at;
    }
  at = best;
  moves_ += !(best == start);
  return least == 0;
}

// How many of the cells are bad, and how bad: each counts 1 and up to 1 more.
double Mending::badness(const std::vector<std::uint32_t>& cells) const {
  double sum = 0;
  for (const BadCell& b : without_split_ones(volume_, bad_cells_among(volume_.mesh, faces_, cells, limits_))) {
    const double ratio = b.limit > 0 ? b.value / b.limit : 0;
    sum += 2 - std::max(0.0, ratio > 1 ? 1 / ratio : ratio);
  }
  return sum;
}

std::vector<BadCell> Mending::judged_again(const std::vector<BadCell>& bad, const std::vector<std::uint32_t>& moved) const {
  std::vector<std::uint32_t> cells = cells_concerned(moved);
  for (const BadCell& b : bad) cells.push_back(b.cell);
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return without_split_ones(volume_, bad_cells_among(volume_.mesh, faces_, cells, limits_));
}

// The cells at these points, and across their faces; ascending.
std::vector<std::uint32_t> Mending::cells_concerned(const std::vector<std::uint32_t>& points) const {
  const PolyhedralMesh& mesh = volume_.mesh;
  std::vector<std::uint32_t> cells;
  for (const std::uint32_t p : points)
    for (const std::uint32_t c : around_[p])
      for (const std::uint32_t f : faces_[c]) {
        cells.push_back(mesh.owner[f]);
        if (f < mesh.internal_faces()) cells.push_back(mesh.neighbour[f]);
      }
  std::sort(cells.begin(), cells.end());
  cells.erase(std::unique(cells.begin(), cells.end()), cells.end());
  return cells;
}

}  // namespace burnish
