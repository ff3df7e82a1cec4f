// A point's neighbourhood over edges, and the quadric that fits it: what noise and outliers are measured against.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "burnish/surface/edge_table.h"
#include "burnish/surface/triangle_soup.h"
#include "stamped_set.h"

namespace burnish {

// Points that share an edge, and the points' normals.
struct PointGraph {
  std::vector<std::uint32_t> first;      // CSR: neighbours of point p are [first[p], first[p + 1])
  std::vector<std::uint32_t> neighbor;   // ascending
  std::vector<Vec3> normal_area;         // sum of facet_normal_2a of the facets around
  std::vector<std::uint8_t> irregular;   // 1: an edge here has other than one or two uses, or two in the same direction

  std::span<const std::uint32_t> neighbors(std::uint32_t p) const { return {neighbor.data() + first[p], first[p + 1] - first[p]}; }
};

PointGraph point_graph(const TriangleSoup& soup, const EdgeTable& edges);

// The points around one, ring by ring. Reused from point to point. Collecting costs what is collected, and making a collector does not depend on the surface.
class PatchCollector {
 public:
  explicit PatchCollector(const PointGraph& graph) : graph_(graph) {}

  // The centre first, then rings of neighbours: at least two, more until there are `at_least` points and the last ring is farther than `radius` from
  // the centre on average; never more than kMost points.
  std::span<const std::uint32_t> collect(std::uint32_t center, std::size_t at_least, double radius, const std::vector<Vec3>& points);
  static constexpr std::size_t kMost = 96;

 private:
  const PointGraph& graph_;
  denoising::StampedSet<512> seen_;  // the members
  std::vector<std::uint32_t> members_;
};

inline constexpr std::size_t kQuadricCoefficients = 6;
using QuadricRow = std::array<double, kQuadricCoefficients>;

// Heights over the plane across the patch' mean normal, lengths in units of the patch' radius; the first point is the origin.
struct PatchSystem {
  bool valid = false;
  std::size_t count = 0;
  double size = 0;
  Vec3 u, v, n;
  std::array<QuadricRow, PatchCollector::kMost> rows;  // 1, x, y, x^2, x y, y^2
  std::array<double, PatchCollector::kMost> heights;

  double residual(const QuadricRow& coefficients, std::size_t i) const;
  // Unit normal of z = c . rows at the origin.
  Vec3 normal(const QuadricRow& coefficients) const;
};

PatchSystem patch_system(std::span<const std::uint32_t> patch, const PointGraph& graph, const std::vector<Vec3>& points);

// Weighted least squares. Nothing if the points do not determine a quadric.
std::optional<QuadricRow> weighted_quadric(const PatchSystem& system, std::span<const double> weights);

struct PatchFit {
  bool valid = false;
  double rss = 0;                 // sum of squared residuals, square of model units, along the fit's own normal
  int freedom = 0;                // points less coefficients
  double residual = 0;            // of the centre, the first point, along the fit's normal there
  double leverage = 0;            // of the centre: its residual has the variance (1 - leverage) sigma^2
  Vec3 normal;                    // unit, of the fit at the centre
  std::array<double, PatchCollector::kMost> influence;  // of each point on the fitted value at the centre; that of the first is the leverage
};

// Least squares of heights, all points alike.
PatchFit fit_patch(std::span<const std::uint32_t> patch, const PointGraph& graph, const std::vector<Vec3>& points);

}  // namespace burnish
