// The region that smoothing is limited to.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/io/region_file.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {

// The union of boxes and balls of a text file, or what a closed surface encloses.
class Region {
 public:
  // A file whose name ends in .txt is read as io/region_file.h says, every other one as a mesh. Both are moved by -`moved_by`, as the model was.
  // Throws Error as the readers do, and Error{unreadable_input} for a mesh that encloses nothing.
  Region(const std::string& path, const Vec3& moved_by);

  // How freely the surface may move at p: 0 outside, 1 from `ramp` inside the region's border on, linear between.
  double mobility(const Vec3& p, double ramp) const;
  // The mobility of all points within `radius` of p, if the border is farther away than that and the ramp.
  std::optional<double> uniform_mobility(const Vec3& p, double radius, double ramp) const;

 private:
  // How far inside p is: the largest such distance to the border of any shape; negative outside.
  double depth(const Vec3& p) const;

  RegionShapes shapes_;
  std::unique_ptr<TriangleIndex> surface_;
};

// The mobility at points.
std::vector<float> mobility_at(const std::vector<Vec3>& points, const Region& region, double ramp);

}  // namespace burnish
