// The one step of `extract_delaunay` that needs CGAL.
#pragma once

#include <cstddef>
#include <functional>
#include <string>
#include <vector>

#include "burnish/surface/triangle_soup.h"
#include "field_sampler.h"

namespace burnish::detail {

struct MesherRequest {
  Box3 box;                                        // holds the surface
  double facet_size = 0;                           // largest radius of a facet's surface ball
  std::function<double(const Vec3&)> sizing;       // the same by place, instead; may be empty
  double distance = 0;
  double min_angle = 0;
  double edge_size = 0;                            // of creases
  std::vector<std::vector<Vec3>> creases;          // disjoint but for common ends, closed if first == last
  std::size_t max_points = 0;
};

struct MesherResult {
  TriangleSoup soup;
  std::vector<std::uint8_t> on_crease;
  std::string failure;
  bool at_limit = false;  // that is why it failed
};

// Seeds are asked for once the balls that protect creases are known.
using SeedsFor = std::function<std::vector<Vec3>(const std::vector<std::pair<Vec3, double>>& balls)>;

MesherResult mesh_surface(FieldSampler& field, const MesherRequest& request, const SeedsFor& seeds_for);

}  // namespace burnish::detail
