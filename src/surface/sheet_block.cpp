#include "burnish/surface/sheet_block.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"

namespace burnish {
namespace {

constexpr double kFacingShare = 0.98;  // of the area has to face the mean normal
constexpr double kFacing = 0.05;       // cosine that counts as facing
constexpr double kShareOfWidth = 0.2;  // of a loop's width: how far the sheet goes on at most

std::optional<Vec3> height_direction(const TriangleSoup& sheet) {
  Vec3 sum;
  for (std::size_t f = 0; f < sheet.facets.size(); ++f) sum += facet_normal_2a(sheet, f);
  if (!(norm(sum) > 0)) return std::nullopt;
  const Vec3 up = sum / norm(sum);
  double facing = 0, all = 0;
  for (std::size_t f = 0; f < sheet.facets.size(); ++f) {
    const Vec3 n = facet_normal_2a(sheet, f);
    all += norm(n);
    if (dot(n, up) > kFacing * norm(n)) facing += norm(n);
  }
  return facing >= kFacingShare * all ? std::optional(up) : std::nullopt;
}

// A directed edge that a facet runs and no other runs back.
struct OpenEdge {
  std::uint32_t from, to;
  Vec3 outwards;  // in the facet's plane, unit
};

std::vector<OpenEdge> open_edges(const TriangleSoup& sheet) {
  const EdgeTable table(sheet);
  std::vector<OpenEdge> open;
  for (std::size_t e = 0; e < table.size(); ++e) {
    int net = 0;
    for (const EdgeUse& use : table.uses(e)) net += use.forward ? 1 : -1;
    for (const EdgeUse& use : table.uses(e)) {
      if (net == 0 || use.forward != (net > 0)) continue;
      const Facet& facet = sheet.facets[use.facet];
      OpenEdge edge{facet[use.side], facet[(use.side + 1u) % 3], {}};
      edge.outwards = cross(sheet.points[edge.to] - sheet.points[edge.from], facet_normal_2a(sheet, use.facet));
      if (norm(edge.outwards) > 0) edge.outwards = edge.outwards / norm(edge.outwards);
      open.push_back(edge);
      net += net > 0 ? -1 : 1;
    }
  }
  return open;
}

class Block {
 public:
  Block(const TriangleSoup& sheet, const Vec3& up, double outwards, double depth)
      : up_(up), result_{sheet, sheet.facets.size(), {}, 0}, count_(static_cast<std::uint32_t>(sheet.points.size())) {
    double lowest = std::numeric_limits<double>::infinity();
    for (const Vec3& p : sheet.points) lowest = std::min(lowest, dot(p, up));
    floor_ = lowest - depth;
    add_points(open_edges(sheet), outwards);
  }

  CappedSoup close(const TriangleSoup& sheet) {
    for (const Facet& f : sheet.facets) add(under(f[0]), under(f[2]), under(f[1]));
    for (const OpenEdge& e : edges_) {
      quad(e.from, e.to, outer(e.to), outer(e.from));
      quad(outer(e.from), outer(e.to), outer_under(e.to), outer_under(e.from));
      quad(outer_under(e.from), outer_under(e.to), under(e.to), under(e.from));
    }
    Cap cap{{}, result_.first_cap_facet, result_.soup.facets.size() - result_.first_cap_facet};
    cap.hole.perimeter = std::numeric_limits<double>::infinity();
    for (std::size_t f = result_.first_cap_facet; f < result_.soup.facets.size(); ++f)
      cap.hole.area += 0.5 * norm(facet_normal_2a(result_.soup, f));
    result_.cap_area = cap.hole.area;
    result_.caps.push_back(cap);
    return std::move(result_);
  }

 private:
  // Behind the sheet's points stand their projections on the floor, then the points farther out, then theirs.
  void add_points(std::vector<OpenEdge> edges, double outwards) {
    edges_ = std::move(edges);
    std::vector<Vec3>& points = result_.soup.points;
    const std::vector<double> limit = outward_limits();
    std::vector<Vec3> out(count_);
    for (const OpenEdge& e : edges_) {
      out[e.from] += e.outwards;
      out[e.to] += e.outwards;
    }
    for (std::uint32_t p = 0; p < count_; ++p) points.push_back(on_floor(points[p]));
    for (std::uint32_t p = 0; p < count_; ++p) {
      const double length = norm(out[p]);
      points.push_back(length > 0 ? points[p] + out[p] * (std::min(outwards, limit[p]) / length) : points[p]);
    }
    for (std::uint32_t p = 0; p < count_; ++p) points.push_back(on_floor(points[2 * count_ + p]));
  }

  // A part of the width of the loop that a point is on: what goes on into a hole must not reach its other side.
  std::vector<double> outward_limits() const {
    UnionFind loops(count_);
    for (const OpenEdge& e : edges_) loops.unite(e.from, e.to);
    std::vector<double> perimeter(count_, 0.0), limit(count_, 0.0);
    const std::vector<Vec3>& points = result_.soup.points;
    for (const OpenEdge& e : edges_) perimeter[loops.find(e.from)] += norm(points[e.to] - points[e.from]);
    for (std::uint32_t p = 0; p < count_; ++p) limit[p] = kShareOfWidth * perimeter[loops.find(p)] / std::numbers::pi;
    return limit;
  }

  Vec3 on_floor(const Vec3& p) const { return p - up_ * (dot(p, up_) - floor_); }
  std::uint32_t under(std::uint32_t p) const { return count_ + p; }
  std::uint32_t outer(std::uint32_t p) const { return 2 * count_ + p; }
  std::uint32_t outer_under(std::uint32_t p) const { return 3 * count_ + p; }
  void add(std::uint32_t a, std::uint32_t b, std::uint32_t c) { result_.soup.facets.push_back({a, b, c}); }
  // The quadrilateral that runs edge from -> to backwards, as a neighbour does.
  void quad(std::uint32_t from, std::uint32_t to, std::uint32_t far_to, std::uint32_t far_from) {
    add(to, from, far_from);
    add(to, far_from, far_to);
  }

  Vec3 up_;
  CappedSoup result_;
  std::uint32_t count_;
  double floor_ = 0;
  std::vector<OpenEdge> edges_;
};

}  // namespace

std::optional<CappedSoup> close_as_block(const TriangleSoup& oriented, double outwards, double depth) {
  const std::optional<Vec3> up = height_direction(oriented);
  if (!up || open_edges(oriented).empty()) return std::nullopt;
  TriangleSoup sheet{oriented.points, oriented.facets, {}};
  return Block(sheet, *up, outwards, depth).close(sheet);
}

}  // namespace burnish
