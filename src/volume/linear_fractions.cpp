// Tetrahedra cut by the interpolant of a distance, divided in eight as long as that matters. [T-VOF-4]
#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/volume/volume_fraction.h"
#include "cell_tetrahedra.h"
#include "fraction_sums.h"
#include "linear_cut.h"
#include "tetrahedron_share.h"

namespace burnish {
namespace {

constexpr std::size_t kCellsPerBatch = 64;
using Tetrahedron = CellTetrahedra::Tetrahedron;

// The eight parts of a tetrahedron, by corners (0 to 3) and middles of edges (4 + edge): the corners, and the octahedron between them around its
// diagonal from 02 to 13 (Bey 1995).
constexpr std::array<std::array<std::size_t, 4>, 8> kParts{
    {{0, 4, 5, 6}, {1, 4, 7, 8}, {2, 5, 7, 9}, {3, 6, 8, 9}, {5, 8, 4, 6}, {5, 8, 6, 9}, {5, 8, 9, 7}, {5, 8, 7, 4}}};

// One batch of cells, division by division.
class BatchCut {
 public:
  BatchCut(const SolidField& field, const FractionOptions& options) : field_(field), options_(options) {}

  CellTetrahedra& cells() { return cells_; }
  void run(std::size_t cell_count) {
    inside_.assign(cell_count, 0);
    filled_.assign(cell_count, Filled::unknown);
    for (int level = 0; !cells_.tetrahedra.empty(); ++level) {
      set_aside_whole();
      add_middles();
      divide(level);
    }
  }
  // Of a cell of this volume; exactly 1 if the surface does not pass through; `otherwise` if the cell has no volume.
  double fraction(std::size_t slot, double volume, double otherwise) const {
    if (volume == 0 || filled_[slot] == Filled::unknown) return otherwise;
    return filled_[slot] == Filled::whole ? 1 : inside_[slot] / volume;
  }

 private:
  enum class Filled : std::uint8_t { unknown, whole, in_part };

  // Tetrahedra that the surface does not pass through.
  void set_aside_whole() {
    std::erase_if(cells_.tetrahedra, [&](const Tetrahedron& t) {
      const int sign = whole(t);
      if (sign != 0) add_share(t, sign > 0 ? 1.0 : 0.0);
      return sign != 0;
    });
  }
  void add_share(const Tetrahedron& t, double share) {
    inside_[t.slot] += t.volume * share;
    if (share < 1) filled_[t.slot] = Filled::in_part;
    else if (filled_[t.slot] == Filled::unknown) filled_[t.slot] = Filled::whole;
  }
  // [T-VOF-6] +1 inside, -1 outside, 0 unknown.
  int whole(const Tetrahedron& t) const {
    double longest = 0, least = INFINITY, most = -INFINITY;
    for (const auto& [i, j] : kTetrahedronEdges) longest = std::max(longest, squared_norm(cells_.points[t.corner[i]] - cells_.points[t.corner[j]]));
    for (const std::uint32_t p : t.corner) {
      least = std::min(least, cells_.phi[p]);
      most = std::max(most, cells_.phi[p]);
    }
    if (least <= 0 && most > 0) return 0;
    const double reach = std::sqrt(longest);
    const bool is_free = shows_free(most, field_.band, reach) || shows_free(least, field_.band, reach);
    if (is_free || least >= field_.band || most <= -field_.band) return most > 0 ? 1 : -1;
    return 0;
  }

  // Points in the middle of all edges, each once.
  void add_middles() {
    edges_.clear();
    for (const Tetrahedron& t : cells_.tetrahedra)
      for (const auto& [i, j] : kTetrahedronEdges) edges_.push_back(edge(t.corner[i], t.corner[j]));
    std::sort(edges_.begin(), edges_.end());
    edges_.erase(std::unique(edges_.begin(), edges_.end()), edges_.end());
    first_middle_ = cells_.points.size();
    for (const std::uint64_t e : edges_) cells_.points.push_back((cells_.points[e >> 32] + cells_.points[e & 0xffffffffu]) * 0.5);
    cells_.phi.resize(cells_.points.size());
    if (!edges_.empty()) field_.distance(std::span(cells_.points).subspan(first_middle_), cells_.phi.data() + first_middle_);
  }
  static std::uint64_t edge(std::uint32_t a, std::uint32_t b) { return std::uint64_t{std::min(a, b)} << 32 | std::max(a, b); }
  std::uint32_t middle(std::uint32_t a, std::uint32_t b) const {
    return static_cast<std::uint32_t>(first_middle_ + static_cast<std::size_t>(std::lower_bound(edges_.begin(), edges_.end(), edge(a, b)) - edges_.begin()));
  }

  void divide(int level) {
    next_.clear();
    const double enough = options_.tolerance * std::exp2(level);
    for (const Tetrahedron& t : cells_.tetrahedra) {
      std::array<std::uint32_t, 10> at;
      std::copy(t.corner.begin(), t.corner.end(), at.begin());
      for (std::size_t e = 0; e < 6; ++e) at[4 + e] = middle(t.corner[kTetrahedronEdges[e][0]], t.corner[kTetrahedronEdges[e][1]]);
      std::array<double, 10> phi;
      for (std::size_t i = 0; i < 10; ++i) phi[i] = cells_.phi[at[i]];
      const Cut cut = cut_in_two_ways(phi);
      const bool is_good = std::abs(cut.quadratic - cut.extrapolated) <= enough && !leaves_band(phi) && !hides_surface(phi);
      if (is_good || level >= options_.deepest) add_share(t, is_good ? cut.quadratic : cut.in_parts);
      else for (const auto& [a, b, c, d] : kParts) next_.push_back({{at[a], at[b], at[c], at[d]}, t.slot, t.volume / 8});
    }
    cells_.tetrahedra.swap(next_);
  }

  // [T-VOF-4] The share by phi's linear interpolant and its quadratic part, and by the eight parts, without and with what these miss still.
  struct Cut {
    double quadratic, in_parts, extrapolated;
  };
  static Cut cut_in_two_ways(const std::array<double, 10>& phi) {
    const double linear = positive_share(phi[0], phi[1], phi[2], phi[3]);
    double in_parts = 0;
    for (const auto& [a, b, c, d] : kParts) in_parts += positive_share(phi[a], phi[b], phi[c], phi[d]) / 8;
    return {std::clamp(linear + quadratic_share(phi), 0.0, 1.0), in_parts, in_parts + (in_parts - linear) / 3};
  }
  // Values beyond the band are no distances to interpolate.
  bool leaves_band(const std::array<double, 10>& phi) const {
    return std::any_of(phi.begin(), phi.end(), [&](double p) { return std::abs(p) >= field_.band; });
  }
  // [T-VOF-4] All points are on one side, but phi bends by more than the surface is off: an edge may come in between.
  static bool hides_surface(const std::array<double, 10>& phi) {
    const auto [least, most] = std::minmax_element(phi.begin(), phi.end());
    if (*least <= 0 && *most > 0) return false;
    double bend = 0;
    for (std::size_t e = 0; e < 6; ++e) {
      const auto [i, j] = kTetrahedronEdges[e];
      bend = std::max(bend, std::abs(phi[4 + e] - 0.5 * (phi[i] + phi[j])));
    }
    return std::min(std::abs(*least), std::abs(*most)) < bend;
  }

  const SolidField& field_;
  const FractionOptions& options_;
  CellTetrahedra cells_;
  std::vector<Tetrahedron> next_;
  std::vector<std::uint64_t> edges_;
  std::size_t first_middle_ = 0;
  std::vector<double> inside_;
  std::vector<Filled> filled_;
};

}  // namespace

void cut_linearly(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field, const NearCells& near,
                  std::span<const std::uint32_t> cells, const FractionOptions& options, std::vector<double>& alpha, Progress& progress) {
  parallel_ranges(cells.size(), kCellsPerBatch, [&](std::size_t begin, std::size_t end) {
    progress.check();
    BatchCut batch(field, options);
    for (std::size_t i = begin; i < end; ++i) batch.cells().add(mesh, geometry, faces, near, cells[i], static_cast<std::uint32_t>(i - begin));
    batch.run(end - begin);
    for (std::size_t i = begin; i < end; ++i) alpha[cells[i]] = batch.fraction(i - begin, geometry.volume[cells[i]], alpha[cells[i]]);
  });
}

std::vector<double> whole_fractions(const NearCells& near) {
  std::vector<double> alpha(near.at_middle.size());
  parallel_for(alpha.size(), [&](std::size_t c) { alpha[c] = near.at_middle[c] > 0 ? 1 : 0; });
  return alpha;
}

VolumeFractions linear_volume_fractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field,
                                        const FractionOptions& options, Progress& progress) {
  const NearCells near = near_cells(mesh, geometry, faces, field, progress);
  VolumeFractions result;
  result.alpha = whole_fractions(near);
  cut_linearly(mesh, geometry, faces, field, near, near.cells, options, result.alpha, progress);
  clamp_and_sum(geometry, result);
  return result;
}

}  // namespace burnish
