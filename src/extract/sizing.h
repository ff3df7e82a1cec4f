// How long edges may be, by place.
#pragma once

#include <cstdint>
#include <unordered_map>
#include <vector>

#include "burnish/extract/delaunay.h"
#include "seeds.h"

namespace burnish::detail {

// Lengths of edges for each point of the zero surface. [T-DELAUNAY-3] sqrt(8 tolerance / |k|), k the larger principal curvature, between `edge` and
// `largest_edge`; `edge` where there is no curvature. Near protected curves k is theirs, as the surface has none. Then lengths grow by at most kGrowth of
// the distance along the surface's edges.
inline constexpr double kGrowth = 0.3;
std::vector<double> edge_lengths(const LevelSet& level_set, const ZeroSurface& surface, const std::vector<std::vector<Vec3>>& curves,
                                 const DelaunayOptions& options, Progress& progress);

// The same for any point near the surface: the least one of the cell that it is in, or of the cells around that; `otherwise` where there is none.
class LengthByCell {
 public:
  LengthByCell(const std::vector<Vec3>& points, const std::vector<double>& lengths, double otherwise);
  double operator()(const Vec3& p) const;

 private:
  std::unordered_map<std::uint64_t, double> least_;
  double otherwise_;
};

}  // namespace burnish::detail
