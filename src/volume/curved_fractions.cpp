// Cells cut by a tangent plane, and what is between it and the osculating paraboloid. [T-VOF-5]
#include <algorithm>
#include <array>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/volume/volume_fraction.h"
#include "cell_tetrahedra.h"
#include "fraction_sums.h"
#include "linear_cut.h"

namespace burnish {
namespace {

constexpr std::size_t kCellsPerBatch = 256;
using Front = SolidField::Front;
using Tetrahedron = CellTetrahedra::Tetrahedron;

// Of one cell.
struct PlaneCut {
  double below = 0;     // volume
  double area = 0;      // of the polygon in the plane
  Vec3 moment;          // its centroid x area
  double bulge = 0;     // the integral over it of the paraboloid's depth below the plane, (k1 u^2 + k2 v^2) / 2
};

double height(const Front& front, const Vec3& x) { return dot(front.normal, x - front.foot); }
double depth(const Front& front, const Vec3& x) {
  const double u = dot(front.direction1, x - front.foot), v = dot(front.direction2, x - front.foot);
  return 0.5 * (front.k1 * u * u + front.k2 * v * v);
}

void add_triangle(const Front& front, const Vec3& a, const Vec3& b, const Vec3& c, double sign, PlaneCut& cut) {
  const double area = sign * 0.5 * norm(cross(b - a, c - a));
  cut.area += area;
  cut.moment += (a + b + c) * (area / 3);
  // Exact for quadratics.
  cut.bulge += area / 3 * (depth(front, (a + b) * 0.5) + depth(front, (b + c) * 0.5) + depth(front, (c + a) * 0.5));
}

void add_tetrahedron(const Front& front, const std::array<Vec3, 4>& x, double volume, PlaneCut& cut) {
  std::array<double, 4> z;
  std::array<std::size_t, 4> order{0, 1, 2, 3};
  std::size_t below = 0;
  for (std::size_t i = 0; i < 4; ++i) {
    z[i] = height(front, x[i]);
    below += z[i] < 0;
  }
  cut.below += volume * positive_share(-z[0], -z[1], -z[2], -z[3]);
  if (below == 0 || below == 4) return;
  std::sort(order.begin(), order.end(), [&](std::size_t i, std::size_t j) { return z[i] < z[j]; });
  const auto at = [&](std::size_t i, std::size_t j) {
    const std::size_t from = order[i], to = order[j];
    return x[from] + (x[to] - x[from]) * (z[from] / (z[from] - z[to]));
  };
  const double sign = volume < 0 ? -1 : 1;
  if (below == 1) return add_triangle(front, at(0, 1), at(0, 2), at(0, 3), sign, cut);
  if (below == 3) return add_triangle(front, at(0, 3), at(1, 3), at(2, 3), sign, cut);
  const Vec3 a = at(0, 2), b = at(0, 3), c = at(1, 3), d = at(1, 2);
  add_triangle(front, a, b, c, sign, cut);
  add_triangle(front, a, c, d, sign, cut);
}

class CurvedFractions {
 public:
  CurvedFractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field, const NearCells& near)
      : mesh_(mesh), geometry_(geometry), faces_(faces), field_(field), near_(near) {}

  // Sets alpha of near cells, and returns those that it cannot.
  std::vector<std::uint32_t> run(std::vector<double>& alpha, Progress& progress) const {
    const std::vector<std::uint32_t>& cells = near_.cells;
    std::vector<char> is_left(cells.size(), 0);
    parallel_ranges(cells.size(), kCellsPerBatch, [&](std::size_t begin, std::size_t end) {
      progress.check();
      cut_batch(std::span(cells).subspan(begin, end - begin), alpha, is_left.data() + begin);
    });
    std::vector<std::uint32_t> left;
    for (std::size_t i = 0; i < cells.size(); ++i)
      if (is_left[i]) left.push_back(cells[i]);
    return left;
  }

 private:
  void cut_batch(std::span<const std::uint32_t> cells, std::vector<double>& alpha, char* is_left) const {
    std::vector<Vec3> places(cells.size());
    std::vector<Front> fronts(cells.size());
    for (std::size_t i = 0; i < cells.size(); ++i) places[i] = geometry_.middle[cells[i]];
    field_.front(places, fronts.data());
    CellTetrahedra tetrahedra;
    for (std::size_t i = 0; i < cells.size(); ++i) {
      const std::uint32_t c = cells[i];
      tetrahedra.clear();
      tetrahedra.add(mesh_, geometry_, faces_, near_, c, 0);
      is_left[i] = !describes(fronts[i], c, tetrahedra);
      if (!is_left[i]) alpha[c] = fraction(fronts[i], c, tetrahedra);
    }
  }

  // Whether the paraboloid is the surface as far as the cell's points know.
  bool describes(Front& front, std::uint32_t cell, const CellTetrahedra& tetrahedra) const {
    constexpr double kNear = 0.05;
    const double diameter = geometry_.box[cell].diagonal();
    if (!front.found || geometry_.volume[cell] == 0 || !(std::max(std::abs(front.k1), std::abs(front.k2)) * diameter <= 1)) return false;
    for (std::size_t i = 0; i < tetrahedra.points.size(); ++i) {
      const double phi = tetrahedra.phi[i], expected = -height(front, tetrahedra.points[i]) - depth(front, tetrahedra.points[i]);
      if (std::abs(phi) < field_.band ? std::abs(phi - expected) > kNear * diameter : phi * expected < 0) return false;
    }
    return true;
  }

  double fraction(const Front& front, std::uint32_t cell, const CellTetrahedra& tetrahedra) const {
    PlaneCut cut;
    bool is_cut = false;
    for (const Vec3& p : tetrahedra.points) is_cut |= (height(front, p) < 0) != (height(front, geometry_.middle[cell]) < 0);
    if (!is_cut) return height(front, geometry_.middle[cell]) < 0 ? 1 : 0;
    for (const Tetrahedron& t : tetrahedra.tetrahedra) {
      const auto& p = tetrahedra.points;
      add_tetrahedron(front, {p[t.corner[0]], p[t.corner[1]], p[t.corner[2]], p[t.corner[3]]}, t.volume, cut);
    }
    return (cut.below - cut.bulge) / geometry_.volume[cell];
  }

  const PolyhedralMesh& mesh_;
  const CellGeometry& geometry_;
  const CellFaces& faces_;
  const SolidField& field_;
  const NearCells& near_;
};

}  // namespace

VolumeFractions curved_volume_fractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const SolidField& field,
                                        const FractionOptions& options, Progress& progress) {
  const NearCells near = near_cells(mesh, geometry, faces, field, progress);
  VolumeFractions result;
  result.alpha = whole_fractions(near);
  const std::vector<std::uint32_t> left = CurvedFractions(mesh, geometry, faces, field, near).run(result.alpha, progress);
  cut_linearly(mesh, geometry, faces, field, near, left, options, result.alpha, progress);
  clamp_and_sum(geometry, result);
  return result;
}

}  // namespace burnish
