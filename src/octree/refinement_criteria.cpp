#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "burnish/octree/refine.h"
#include "cell_scatter.h"

namespace burnish {
namespace {

class MaxFaceLimit : public RefinementCriterion {
 public:
  explicit MaxFaceLimit(std::uint32_t limit) : limit_(limit) {}
  std::string_view name() const override { return "max_face_limit"; }
  bool divides(const OctantFacets& octant) const override {  // [T-REF-1]
    if (octant.facets.size() <= limit_) return false;
    std::array<std::uint32_t, detail::kMostCells> sorted{};
    for (const std::uint32_t f : octant.facets) {
      const std::size_t cell = detail::cell_of(octant, (octant.soup.corner(f, 0) + octant.soup.corner(f, 1) + octant.soup.corner(f, 2)) / 3.0);
      if (cell != detail::kMostCells && ++sorted[cell] > limit_) return true;
    }
    return false;
  }

 private:
  std::uint32_t limit_;
};

class MaxFaceCut : public RefinementCriterion {
 public:
  explicit MaxFaceCut(std::uint32_t limit) : limit_(limit) {}
  std::string_view name() const override { return "max_face_cut"; }
  bool divides(const OctantFacets& octant) const override {  // [T-REF-1]
    if (octant.facets.size() <= limit_) return false;
    std::array<std::uint32_t, detail::kMostCells> cut{};
    return std::any_of(octant.facets.begin(), octant.facets.end(), [&](std::uint32_t f) {
      return detail::for_cells_cut(octant, f, [&](std::size_t cell) { return ++cut[cell] > limit_; });
    });
  }

 private:
  std::uint32_t limit_;
};

double shortest_edge(const TriangleSoup& soup, std::uint32_t f) {
  const Vec3 &a = soup.corner(f, 0), &b = soup.corner(f, 1), &c = soup.corner(f, 2);
  return std::sqrt(std::min({squared_norm(b - a), squared_norm(c - b), squared_norm(a - c)}));
}

class RefineTol : public RefinementCriterion {
 public:
  explicit RefineTol(double tolerance) : tolerance_(tolerance) {}
  std::string_view name() const override { return "refine_tol"; }
  bool divides(const OctantFacets& octant) const override {  // [T-REF-1]
    return std::any_of(octant.facets.begin(), octant.facets.end(), [&](std::uint32_t f) {
      const double length_scale = shortest_edge(octant.soup, f);
      return length_scale > 0 && octant.cell() / length_scale > tolerance_ &&
             detail::for_cells_cut(octant, f, [](std::size_t) { return true; });
    });
  }

 private:
  double tolerance_;
};

class LevelsInBoxes : public RefinementCriterion {
 public:
  explicit LevelsInBoxes(std::vector<LevelInBox> boxes) : boxes_(std::move(boxes)) {}
  std::string_view name() const override { return "boxes"; }
  bool divides(const OctantFacets& octant) const override {
    const double side = octant.cells_per_side * octant.cell();
    return std::any_of(boxes_.begin(), boxes_.end(), [&](const LevelInBox& b) {
      bool meets = octant.level > b.level;
      for (int a = 0; a < 3; ++a) meets = meets && octant.corner[a] <= b.box.upper[a] && octant.corner[a] + side >= b.box.lower[a];
      return meets;
    });
  }

 private:
  std::vector<LevelInBox> boxes_;
};

}  // namespace

std::unique_ptr<RefinementCriterion> max_face_limit(std::uint32_t limit) { return std::make_unique<MaxFaceLimit>(limit); }
std::unique_ptr<RefinementCriterion> max_face_cut(std::uint32_t limit) { return std::make_unique<MaxFaceCut>(limit); }
std::unique_ptr<RefinementCriterion> refine_tol(double tolerance) { return std::make_unique<RefineTol>(tolerance); }

std::unique_ptr<RefinementCriterion> levels_in_boxes(std::vector<LevelInBox> boxes) { return std::make_unique<LevelsInBoxes>(std::move(boxes)); }

std::vector<std::unique_ptr<RefinementCriterion>> criteria_of(const RefinementLimits& limits) {
  std::vector<std::unique_ptr<RefinementCriterion>> criteria;
  if (limits.max_face_limit) criteria.push_back(max_face_limit(*limits.max_face_limit));
  if (limits.max_face_cut) criteria.push_back(max_face_cut(*limits.max_face_cut));
  if (limits.refine_tol) criteria.push_back(refine_tol(*limits.refine_tol));
  if (!limits.boxes.empty()) criteria.push_back(levels_in_boxes(limits.boxes));
  return criteria;
}

}  // namespace burnish
