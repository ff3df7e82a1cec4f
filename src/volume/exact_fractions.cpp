// Volume fractions of a triangulated solid: the shadows of its facets, cast by a light in the cell. [T-VOF-1]
#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "../surface/box_tree.h"
#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/winding.h"
#include "burnish/volume/volume_fraction.h"
#include "cell_cones.h"
#include "fraction_sums.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 256;
constexpr double kNothing = 1e-15;  // of a cell: less of it is none

// A convex polygon, cut by one plane after the other.
class Clipped {
 public:
  explicit Clipped(const std::array<Vec3, 3>& corners) : size_(3) { std::copy(corners.begin(), corners.end(), points_.begin()); }
  std::span<const Vec3> points() const { return {points_.data(), size_}; }

  // Keeps where value(x), linear, is positive. False once nothing is left.
  template <class Value>
  bool keep(Value&& value) {
    std::array<double, kRoom> at;
    double least = std::numeric_limits<double>::infinity(), most = -least;
    for (std::size_t i = 0; i < size_; ++i) {
      at[i] = value(points_[i]);
      least = std::min(least, at[i]);
      most = std::max(most, at[i]);
    }
    if (!(most > 0)) return false;
    if (least < 0) cut(at.data());
    return size_ >= 3;
  }

 private:
  static constexpr std::size_t kRoom = CellCones::kMostSides + 5;

  void cut(const double* at) {
    std::array<Vec3, kRoom> kept;
    std::size_t n = 0;
    for (std::size_t i = 0; i < size_ && n + 2 <= kRoom; ++i) {
      const std::size_t j = i + 1 < size_ ? i + 1 : 0;
      if (at[i] >= 0) kept[n++] = points_[i];
      if ((at[i] < 0) != (at[j] < 0)) kept[n++] = points_[i] + (points_[j] - points_[i]) * (at[i] / (at[i] - at[j]));
    }
    std::copy_n(kept.begin(), n, points_.begin());
    size_ = n;
  }

  std::array<Vec3, kRoom> points_;
  std::size_t size_;
};

// A polygon in a cone, seen from its apex: what is between apex and polygon less what is between apex and base, in its shadow's cone.
// [T-VOF-1] Positive where the polygon turns its back to the apex.
double minus_shadow(std::span<const Vec3> polygon, const Vec3& height) {
  const Vec3& a = polygon[0];
  const double over_a = 1 / dot(height, a);
  double sum = 0, over_b = 1 / dot(height, polygon[1]);
  for (std::size_t i = 2; i < polygon.size(); ++i) {
    const Vec3 &b = polygon[i - 1], &c = polygon[i];
    const double over_c = 1 / dot(height, c);
    sum += dot(a, cross(b - a, c - a)) * (1 - over_a * over_b * over_c);
    over_b = over_c;
  }
  return sum / 6;
}

class ExactFractions {
 public:
  ExactFractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces, const TriangleSoup& solid)
      : mesh_(mesh), geometry_(geometry), faces_(faces), solid_(solid), tree_(solid, all_facets(solid)) {}

  VolumeFractions run(Progress& progress) {
    result_.alpha.assign(mesh_.cells, 0);
    touched_.assign(mesh_.cells, kFar);
    light_ = geometry_.middle;
    parallel_ranges(mesh_.cells, kGrain, [&](std::size_t begin, std::size_t end) {
      progress.check();
      Scratch scratch;
      for (std::size_t c = begin; c < end; ++c) cut_cell(static_cast<std::uint32_t>(c), scratch);
    });
    add_lights();
    clamp_and_sum(geometry_, result_);
    return std::move(result_);
  }

 private:
  enum Touch : char { kFar, kNear, kCut };  // no facet can meet the cell, one may, one does
  struct Scratch {
    std::vector<std::uint32_t> facets;
    CellCones cones;
  };

  static std::vector<std::uint32_t> all_facets(const TriangleSoup& solid) {
    std::vector<std::uint32_t> all;
    for (std::uint32_t f = 0; f < solid.facets.size(); ++f)
      if (!repeats_point(solid.facets[f])) all.push_back(f);
    return all;
  }

  // Whether a box is on both sides of a facet's plane, or may be but for rounding. Most boxes that meet that of a large facet are not.
  bool plane_meets(std::uint32_t f, const Box3& box) const {
    constexpr double kRounding = 1e-12;
    const Vec3 &a = solid_.corner(f, 0), normal = cross(solid_.corner(f, 1) - a, solid_.corner(f, 2) - a), to = max(box.upper - a, a - box.lower);
    const Vec3 size{std::abs(normal.x), std::abs(normal.y), std::abs(normal.z)};
    return std::abs(dot(normal, box.center() - a)) <= 0.5 * dot(size, box.extent()) + kRounding * dot(size, to);
  }

  void cut_cell(std::uint32_t cell, Scratch& scratch) {
    scratch.facets.clear();
    const Box3& box = geometry_.box[cell];
    tree_.facets_meeting(box, [&](std::uint32_t f) {
      if (plane_meets(f, box)) scratch.facets.push_back(f);
    });
    if (scratch.facets.empty()) return;
    touched_[cell] = kNear;
    light_[cell] = place_of_light(cell, scratch.facets);
    scratch.cones.build(mesh_, faces_[cell], cell, light_[cell]);
    double sum = 0;
    bool cut = false;
    for (const std::uint32_t f : scratch.facets) {
      const std::array<Vec3, 3> corners{solid_.corner(f, 0) - light_[cell], solid_.corner(f, 1) - light_[cell], solid_.corner(f, 2) - light_[cell]};
      for (const Cone& cone : scratch.cones.cones()) cut |= add_shadow(corners, scratch.cones, cone, sum);
    }
    if (!cut || geometry_.volume[cell] == 0) return;
    touched_[cell] = kCut;
    result_.alpha[cell] = sum / geometry_.volume[cell];
  }

  bool add_shadow(const std::array<Vec3, 3>& corners, const CellCones& cones, const Cone& cone, double& sum) const {
    Clipped polygon(corners);
    // A facet in the base throws no shadow: one that is there but for rounding shall leave 0 and 1 as they are.
    const auto above = [&](const Vec3& x) { return 1 - cone.rounding > dot(cone.height, x); };
    if (std::none_of(corners.begin(), corners.end(), above)) return false;
    for (const Vec3& side : cones.sides(cone))
      if (!polygon.keep([&](const Vec3& x) { return dot(side, x); })) return false;
    if (!polygon.keep([&](const Vec3& x) { return 1 - dot(cone.height, x); })) return false;
    if (std::none_of(polygon.points().begin(), polygon.points().end(), above)) return false;
    sum += cone.sign * minus_shadow(polygon.points(), cone.height);
    return true;
  }

  // [T-VOF-2] The middle, unless a facet is near; then the first of some places around it that all facets are off.
  Vec3 place_of_light(std::uint32_t cell, const std::vector<std::uint32_t>& facets) const {
    constexpr double kClearance = 0.02, kSpread = 0.5;
    constexpr int kPlaces = 32;
    const Vec3 extent = geometry_.box[cell].extent(), middle = geometry_.middle[cell];
    const double enough = kClearance * kClearance * squared_norm(extent);
    Vec3 best = middle;
    double best_clearance = -1, alpha = 0, beta = 0, gamma = 0;
    for (int i = 0; i < kPlaces; ++i) {
      const Vec3 place = middle + Vec3{extent.x * alpha, extent.y * beta, extent.z * gamma};
      const double clearance = squared_clearance(place, facets, best_clearance);
      if (clearance > best_clearance) best = place, best_clearance = clearance;
      if (best_clearance >= enough) break;
      // Roberts' sequence in three dimensions (2018): powers of 1 / 1.2207..., the root of x^4 = x + 1.
      alpha = kSpread * (std::fmod(0.8191725133961645 * (i + 1), 1.0) - 0.5);
      beta = kSpread * (std::fmod(0.6710436067037893 * (i + 1), 1.0) - 0.5);
      gamma = kSpread * (std::fmod(0.5497004779019703 * (i + 1), 1.0) - 0.5);
    }
    return best;
  }

  // Or something that is not above `useless`, as soon as that is certain.
  double squared_clearance(const Vec3& p, const std::vector<std::uint32_t>& facets, double useless) const {
    double least = std::numeric_limits<double>::infinity();
    for (const std::uint32_t f : facets) {
      least = std::min(least, squared_norm(closest_point_on_triangle(p, solid_.corner(f, 0), solid_.corner(f, 1), solid_.corner(f, 2)) - p));
      if (least <= useless) break;
    }
    return least;
  }

  // How often the solid winds around each light. Cells far from all facets share one with those beside them.
  void add_lights() {
    UnionFind groups(mesh_.cells);
    for (std::size_t f = 0; f < mesh_.internal_faces(); ++f)
      if (touched_[mesh_.owner[f]] == kFar && touched_[mesh_.neighbour[f]] == kFar) groups.unite(mesh_.owner[f], mesh_.neighbour[f]);
    std::vector<std::uint32_t> asked(mesh_.cells);
    std::vector<Vec3> lights;
    for (std::uint32_t c = 0; c < mesh_.cells; ++c) {
      const std::uint32_t r = groups.find(c);
      if (r == c) lights.push_back(light_[c]);
      asked[c] = r == c ? static_cast<std::uint32_t>(lights.size() - 1) : asked[r];
    }
    const std::vector<std::int32_t> winding = winding_numbers(solid_, lights);
    parallel_for(mesh_.cells, [&](std::size_t c) {
      double& alpha = result_.alpha[c] += winding[asked[c]];
      // Shadows that cancel, as in what two cones of a concave cell share outside of it, leave their rounding.
      if (std::abs(alpha - std::round(alpha)) < kNothing) alpha = std::round(alpha);
    });
  }

  const PolyhedralMesh& mesh_;
  const CellGeometry& geometry_;
  const CellFaces& faces_;
  const TriangleSoup& solid_;
  BoxTree tree_;
  VolumeFractions result_;
  std::vector<char> touched_;
  std::vector<Vec3> light_;
};

}  // namespace

VolumeFractions exact_volume_fractions(const PolyhedralMesh& mesh, const CellGeometry& geometry, const CellFaces& faces,
                                       const TriangleSoup& solid, Progress& progress) {
  if (!is_closed_chain(solid)) throw Error(ErrorCode::usage, "volume fractions need a closed surface, and this one is open", "close it first, as clean() does");
  return ExactFractions(mesh, geometry, faces, solid).run(progress);
}

}  // namespace burnish
