#include "burnish/surface/validate.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/shells.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 8192;
constexpr double kFlat = 1e-12;  // smallest altitude by longest edge
constexpr double kDegrees = 180 / std::numbers::pi;

struct FacetShape {
  std::array<double, 3> edges{};
  double smallest = 0, largest = 180;  // angles
  double ratio = 0;                    // 0: flat
};

// [T-SHAPE-1]
FacetShape shape_of(const TriangleSoup& soup, std::size_t f) {
  FacetShape shape;
  std::array<Vec3, 3> side;
  for (int i = 0; i < 3; ++i) {
    const auto s = static_cast<std::size_t>(i);
    side[s] = soup.corner(f, (i + 1) % 3) - soup.corner(f, i);
    shape.edges[s] = norm(side[s]);
  }
  const auto [a, b, c] = shape.edges;
  const double twice_area = norm(cross(side[0], side[1])), longest = std::max({a, b, c});
  if (!(twice_area > kFlat * longest * longest)) return shape;
  shape.smallest = 180, shape.largest = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    const double angle = std::atan2(twice_area, -dot(side[i], side[(i + 2) % 3])) * kDegrees;
    shape.smallest = std::min(shape.smallest, angle);
    shape.largest = std::max(shape.largest, angle);
  }
  shape.ratio = a * b * c * (a + b + c) / (4 * twice_area * twice_area);
  return shape;
}

struct Totals {
  FacetShapes shapes;
  double length = 0;
};

void add(const FacetShape& facet, Totals& totals) {
  FacetShapes& all = totals.shapes;
  ++all.facets;
  all.flat_facets += facet.ratio == 0;
  all.share_below_10 += facet.smallest < 10;
  all.share_below_25 += facet.smallest < 25;
  all.smallest_angle = std::min(all.smallest_angle, facet.smallest);
  all.largest_angle = std::max(all.largest_angle, facet.largest);
  all.largest_ratio = std::max(all.largest_ratio, facet.ratio);
  for (const double edge : facet.edges) {
    all.shortest_edge = std::min(all.shortest_edge, edge);
    all.longest_edge = std::max(all.longest_edge, edge);
    totals.length += edge;
  }
}

Totals nothing() {
  Totals totals;
  totals.shapes.smallest_angle = 180;
  totals.shapes.shortest_edge = std::numeric_limits<double>::infinity();
  return totals;
}

Totals combine(Totals a, const Totals& b) {
  FacetShapes &s = a.shapes;
  const FacetShapes& t = b.shapes;
  s.facets += t.facets;
  s.flat_facets += t.flat_facets;
  s.share_below_10 += t.share_below_10;
  s.share_below_25 += t.share_below_25;
  s.smallest_angle = std::min(s.smallest_angle, t.smallest_angle);
  s.largest_angle = std::max(s.largest_angle, t.largest_angle);
  s.largest_ratio = std::max(s.largest_ratio, t.largest_ratio);
  s.shortest_edge = std::min(s.shortest_edge, t.shortest_edge);
  s.longest_edge = std::max(s.longest_edge, t.longest_edge);
  a.length += b.length;
  return a;
}

double percentile(std::vector<float>& values, double share) {
  const auto rank = std::min(values.size() - 1, static_cast<std::size_t>(share * static_cast<double>(values.size())));
  const auto at = values.begin() + static_cast<std::ptrdiff_t>(rank);
  std::nth_element(values.begin(), at, values.end());
  return static_cast<double>(*at);
}

// Fans of facets around points: corners 3 f + i, joined across edges. The representative of each stands for a vertex.
UnionFind fans_of(const TriangleSoup& soup, const EdgeTable& table) {
  UnionFind fans(3 * soup.facets.size());
  const auto corner = [&](const EdgeUse& use, bool upper) {
    return 3 * use.facet + (use.forward == upper ? (use.side + 1u) % 3 : use.side);
  };
  for (std::size_t e = 0; e < table.size(); ++e) {
    const auto uses = table.uses(e);
    for (const EdgeUse& use : uses.subspan(1))
      for (const bool upper : {false, true}) fans.unite(corner(uses[0], upper), corner(use, upper));
  }
  return fans;
}

// Per shell V - E + F, and whether its edges are those of a closed 2-manifold. [T-TOPO-1]
std::vector<ComponentTopology> count_cells(const TriangleSoup& soup, const EdgeTable& table, const Shells& shells) {
  std::vector<ComponentTopology> of_shell(shells.shells.size());
  for (std::size_t s = 0; s < of_shell.size(); ++s) of_shell[s].closed = shells.shells[s].closed;
  const UnionFind fans = fans_of(soup, table);
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f) {
    if (repeats_point(soup.facets[f])) continue;
    ComponentTopology& component = of_shell[shells.of_facet[f]];
    ++component.facets;
    ++component.euler_characteristic;
    for (std::uint32_t i = 0; i < 3; ++i) component.euler_characteristic += fans.is_representative(3 * f + i);
  }
  for (std::size_t e = 0; e < table.size(); ++e) {
    ComponentTopology& component = of_shell[shells.of_facet[table.uses(e)[0].facet]];
    --component.euler_characteristic;
    component.closed = component.closed && table.uses(e).size() == 2 && !table.is_misoriented(e);
  }
  return of_shell;
}

}  // namespace

FacetShapes facet_shapes(const TriangleSoup& soup) {
  const std::size_t n = soup.facets.size();
  if (n == 0) return {};
  std::vector<float> angles(n);
  Totals totals = parallel_reduce(
      n, kGrain, nothing(),
      [&](std::size_t begin, std::size_t end) {
        Totals part = nothing();
        for (std::size_t f = begin; f < end; ++f) {
          const FacetShape shape = shape_of(soup, f);
          angles[f] = static_cast<float>(shape.smallest);
          add(shape, part);
        }
        return part;
      },
      combine);
  FacetShapes& shapes = totals.shapes;
  shapes.share_below_10 /= static_cast<double>(n);
  shapes.share_below_25 /= static_cast<double>(n);
  shapes.mean_edge = totals.length / (3 * static_cast<double>(n));
  shapes.angle_of_thousandth = percentile(angles, 0.001);
  shapes.angle_of_hundredth = percentile(angles, 0.01);
  shapes.median_angle = percentile(angles, 0.5);
  return shapes;
}

SurfaceTopology surface_topology(const TriangleSoup& welded) {
  const Shells shells = find_shells(welded);
  SurfaceTopology result;
  bool all_closed = true;
  std::int64_t handles = 0;
  const auto counted = count_cells(welded, EdgeTable(welded), shells);
  for (std::size_t s = 0; s < counted.size(); ++s) {
    ComponentTopology component = counted[s];
    if (component.facets == 0) continue;
    component.cavity = component.closed && shells.shells[s].volume < 0;
    if (component.closed) component.genus = 1 - component.euler_characteristic / 2;
    result.cavities += component.cavity;
    result.euler_characteristic += component.euler_characteristic;
    all_closed = all_closed && component.closed;
    handles += component.genus.value_or(0);
    result.components.push_back(component);
  }
  if (all_closed) result.genus = handles;
  return result;
}

double largest_fold(const TriangleSoup& welded) {
  const EdgeTable table(welded);
  return parallel_reduce(
      table.size(), kGrain, 0.0,
      [&](std::size_t begin, std::size_t end) {
        double largest = 0;
        for (std::size_t e = begin; e < end; ++e) {
          const auto uses = table.uses(e);
          if (uses.size() != 2) continue;
          const Vec3 p = facet_normal_2a(welded, uses[0].facet), q = facet_normal_2a(welded, uses[1].facet);
          const double turned = uses[0].forward == uses[1].forward ? -1.0 : 1.0;
          if (squared_norm(p) > 0 && squared_norm(q) > 0)
            largest = std::max(largest, std::atan2(norm(cross(p, q)), turned * dot(p, q)) * kDegrees);
        }
        return largest;
      },
      [](double a, double b) { return std::max(a, b); });
}

Validation validate(const TriangleSoup& welded, const InspectOptions& options, Progress& progress) {
  return {inspect(welded, options, progress), facet_shapes(welded), surface_topology(welded), largest_fold(welded)};
}

}  // namespace burnish
