#include "mend.h"

#include <algorithm>
#include <array>
#include <utility>

#include "burnish/octree/octree.h"
#include "relax.h"

namespace burnish {
namespace {

constexpr std::size_t kMostMended = 4096;  // bad cells in a round: a mesh with more is beyond mending
constexpr double kMeanDistance = 1.5;      // half sides from a point to the other corners of its cells, in the mean and rather too few
constexpr std::size_t kPlaces = 78;        // where a point may go: three steps in 26 directions
constexpr std::size_t kTried = 10;         // of them in the first round, by the shapes of the cells around; measuring all takes ten times as long

}  // namespace

std::vector<BadCell> without_split_ones(const VolumeMesh& mesh, std::vector<BadCell> bad) {
  std::erase_if(bad, [&](const BadCell& b) { return mesh.shape[b.cell] == CellShape::polyhedron && b.check == "concave cells"; });
  return bad;
}

std::vector<BadCell> Mending::mend(std::vector<BadCell> bad, int rounds) {
  for (int round = 0; round < rounds && !bad.empty(); ++round) {
    const std::vector<std::uint32_t> first = worst_first(bad);
    for (const std::uint32_t cell : first) {
      progress_.check();
      mend_cell(cell, round == 0 ? kTried : kPlaces);
    }
    std::vector<std::uint32_t> again;
    for (const std::uint32_t cell : first)
      for (const std::uint32_t p : volume_.cell(cell)) again.push_back(p);
    bad = judged_again(bad, again);
  }
  return bad;
}

// Those that checkMesh itself would refuse or warn of come before those that are beyond our own limits only.
std::vector<std::uint32_t> Mending::worst_first(const std::vector<BadCell>& bad) const {
  std::vector<std::uint32_t> cells;
  cells.reserve(bad.size());
  for (const BadCell& b : bad) cells.push_back(b.cell);
  const std::vector<BadCell> refused = bad_cells_among(volume_.mesh, faces_, cells);
  const auto is_refused = [&](std::uint32_t cell) { return std::binary_search(refused.begin(), refused.end(), BadCell{cell, {}, 0, 0}, [](const BadCell& a, const BadCell& b) { return a.cell < b.cell; }); };
  std::stable_partition(cells.begin(), cells.end(), is_refused);
  if (cells.size() > kMostMended) cells.resize(kMostMended);
  return cells;
}

void Mending::mend_cell(std::uint32_t cell, std::size_t tried) {
  if (badness({cell}) == 0) return;  // by what its neighbours did
  for (const std::uint32_t p : volume_.cell(cell))
    if (!fixed_[p] && mend_by(p, tried)) return;
}

// Half a side of the cells at a point, as far as these show it: corners of tetrahedra of the lattice are 1.7 and 2 half sides away.
double Mending::cell_at(std::uint32_t p) const {
  double sum = 0, count = 0;
  for (const std::uint32_t c : around_[p])
    for (const std::uint32_t q : volume_.cell(c))
      if (q != p) sum += norm(volume_.mesh.points[q] - volume_.mesh.points[p]), ++count;
  return count > 0 ? std::min(largest_, sum / (kMeanDistance * count)) : largest_;
}

// Places a tenth, a fifth and two fifths of half a side away, those with the best shapes first.
std::vector<Vec3> Mending::places_for(std::uint32_t p) {
  Vec3& at = volume_.mesh.points[p];
  const Vec3 start = at;
  const double cell = cell_at(p);
  std::vector<std::pair<double, Vec3>> places;
  for (const double step : {0.1, 0.2, 0.4})
    for (int d = 0; d < kDirections; ++d) {
      if (d == kSelf) continue;
      const std::array<int, 3> o = offset_of(d);
      const Vec3 direction{static_cast<double>(o[0]), static_cast<double>(o[1]), static_cast<double>(o[2])};
      at = start + direction * (step * cell / norm(direction));
      places.emplace_back(-worst_shape(volume_, around_[p]), at);
    }
  at = start;
  std::stable_sort(places.begin(), places.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Vec3> sorted;
  sorted.reserve(places.size());
  for (const auto& place : places) sorted.push_back(place.second);
  return sorted;
}

// True if no cell that the point concerns is bad any more.
bool Mending::mend_by(std::uint32_t p, std::size_t tried) {
  const std::vector<std::uint32_t> concerned = cells_concerned({p});
  Vec3& at = volume_.mesh.points[p];
  const Vec3 start = at;
  Vec3 best = start;
  double least = badness(concerned);
  std::vector<Vec3> places = places_for(p);
  places.resize(std::min(places.size(), tried));
  for (const Vec3& place : places) {
    if (least == 0) break;
    at = place;
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
