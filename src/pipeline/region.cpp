#include "region.h"

#include <fmt/format.h>

#include <algorithm>
#include <limits>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/io/mesh_io.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/weld.h"

namespace burnish {
namespace {

double depth_in(const Box3& box, const Vec3& p) {
  const Vec3 d = min(p - box.lower, box.upper - p);
  return std::min({d.x, d.y, d.z});
}

double depth_in(const Ball& ball, const Vec3& p) { return ball.radius - norm(p - ball.center); }

std::unique_ptr<TriangleIndex> read_surface(const std::string& path, const Vec3& moved_by) {
  TriangleSoup soup = orient(weld(read_mesh(path).soup)).soup;
  if (!(signed_volume(soup) > 0))
    throw Error(ErrorCode::unreadable_input, fmt::format("{}: expected a closed surface around a region, found one that encloses nothing", path),
                "clean it first, or list boxes and spheres in a .txt file");
  for (Vec3& p : soup.points) p -= moved_by;
  return std::make_unique<TriangleIndex>(soup);
}

}  // namespace

Region::Region(const std::string& path, const Vec3& moved_by) {
  if (!path.ends_with(".txt")) {
    surface_ = read_surface(path, moved_by);
    return;
  }
  shapes_ = read_region_shapes(path);
  for (Box3& box : shapes_.boxes) box.lower -= moved_by, box.upper -= moved_by;
  for (Ball& ball : shapes_.balls) ball.center -= moved_by;
}

double Region::depth(const Vec3& p) const {
  if (surface_) {
    const double d = std::sqrt(surface_->closest(p).squared_distance);
    return surface_->winding_number(p) > 0.5 ? d : -d;
  }
  double deepest = -std::numeric_limits<double>::infinity();
  for (const Box3& box : shapes_.boxes) deepest = std::max(deepest, depth_in(box, p));
  for (const Ball& ball : shapes_.balls) deepest = std::max(deepest, depth_in(ball, p));
  return deepest;
}

double Region::mobility(const Vec3& p, double ramp) const {
  const double d = depth(p);
  return d <= 0 ? 0 : ramp > 0 ? std::min(d / ramp, 1.0) : 1;
}

std::optional<double> Region::uniform_mobility(const Vec3& p, double radius, double ramp) const {
  const double reach = radius + ramp;
  if (!surface_) {
    const double d = depth(p);
    return d >= reach ? std::optional(1.0) : d <= -radius ? std::optional(0.0) : std::nullopt;
  }
  if (surface_->closest(p, reach * reach).facet != kNoFacet) return std::nullopt;
  return surface_->winding_number(p) > 0.5 ? 1 : 0;
}

std::vector<float> mobility_at(const std::vector<Vec3>& points, const Region& region, double ramp) {
  std::vector<float> mobility(points.size());
  parallel_for(points.size(), [&](std::size_t i) { mobility[i] = static_cast<float>(region.mobility(points[i], ramp)); }, 256);
  return mobility;
}

}  // namespace burnish
