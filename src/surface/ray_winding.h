// Winding numbers along axis-parallel rays, watertight: both facets of an edge are asked by one rule.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Points filed by columns of a grid over x and y.
class PointColumns {
 public:
  explicit PointColumns(const std::vector<Vec3>& points) {
    Box3 box;
    for (const Vec3& p : points) box.extend(p);
    side_ = std::clamp<std::size_t>(static_cast<std::size_t>(std::sqrt(static_cast<double>(points.size()))), 1, 256);
    lower_ = box.lower;
    const Vec3 e = box.extent();
    per_x_ = e.x > 0 ? static_cast<double>(side_) / e.x : 0;
    per_y_ = e.y > 0 ? static_cast<double>(side_) / e.y : 0;
    first_.assign(side_ * side_ + 1, 0);
    for (const Vec3& p : points) ++first_[column(p)];
    filed_.resize(exclusive_scan_in_place(first_));
    std::vector<std::uint32_t> next = first_;
    for (std::uint32_t i = 0; i < points.size(); ++i) filed_[next[column(points[i])]++] = i;
  }

  // Calls visit(point) for every point whose column meets the box.
  template <class Visit>
  void for_each_in(const Box3& box, Visit&& visit) const {
    const std::size_t x0 = along(box.lower.x - lower_.x, per_x_), x1 = along(box.upper.x - lower_.x, per_x_);
    const std::size_t y0 = along(box.lower.y - lower_.y, per_y_), y1 = along(box.upper.y - lower_.y, per_y_);
    for (std::size_t y = y0; y <= y1; ++y)
      for (std::uint32_t i = first_[x0 + side_ * y]; i < first_[x1 + side_ * y + 1]; ++i) visit(filed_[i]);
  }

 private:
  std::size_t along(double offset, double per) const {
    return static_cast<std::size_t>(std::clamp(offset * per, 0.0, static_cast<double>(side_ - 1)));
  }
  std::size_t column(const Vec3& p) const { return along(p.x - lower_.x, per_x_) + side_ * along(p.y - lower_.y, per_y_); }

  Vec3 lower_;
  double per_x_ = 0, per_y_ = 0;
  std::size_t side_ = 1;
  std::vector<std::uint32_t> first_, filed_;
};

// +1 or -1 if the upward ray from p passes the facet, counter-clockwise or clockwise seen from above; else 0. An edge gives
// the same answer to both its facets: its ends are taken in one order, lower y first. [T-SHELL-1]
inline int passes(const std::array<Vec3, 3>& c, const Vec3& p) {
  int winding = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &u = c[i], &v = c[(i + 1) % 3];
    const bool up = u.y <= p.y && v.y > p.y, down = v.y <= p.y && u.y > p.y;
    if (!up && !down) continue;
    const Vec3 &low = up ? u : v, &high = up ? v : u;
    const double x = low.x + (p.y - low.y) / (high.y - low.y) * (high.x - low.x);
    if (x > p.x) winding += up ? 1 : -1;
  }
  if (winding == 0) return 0;
  const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
  const double bottom = std::min({c[0].z, c[1].z, c[2].z}), top = std::max({c[0].z, c[1].z, c[2].z});
  const double height = n.z == 0 ? bottom : c[0].z - (n.x * (p.x - c[0].x) + n.y * (p.y - c[0].y)) / n.z;
  return std::clamp(height, bottom, top) > p.z ? winding : 0;
}

}  // namespace burnish
