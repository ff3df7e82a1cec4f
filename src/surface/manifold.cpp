#include "burnish/surface/manifold.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <span>

#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"

namespace burnish {
namespace {

// A facet at an edge, by the angle around the edge at which it leaves it.
struct Leaf {
  double angle;
  EdgeUse use;
};

std::uint32_t third_point(const TriangleSoup& soup, const EdgeUse& use) { return soup.facets[use.facet][(use.side + 2u) % 3]; }

// The facets around edge {a, b}, counter-clockwise about the direction from a to b.
std::vector<Leaf> around_edge(const TriangleSoup& soup, const Edge& edge, std::span<const EdgeUse> uses) {
  const Vec3 a = soup.points[edge[0]], axis = soup.points[edge[1]] - a;
  const Vec3 first = soup.points[third_point(soup, uses[0])] - a;
  const Vec3 y = cross(axis, first), x = cross(y, axis) / std::max(norm(axis), 1e-300);
  std::vector<Leaf> leaves;
  for (const EdgeUse& use : uses) {
    const Vec3 d = soup.points[third_point(soup, use)] - a;
    double angle = std::atan2(dot(d, y), dot(d, x));
    if (angle < 0) angle += 2 * std::numbers::pi;
    leaves.push_back({use.facet == uses[0].facet ? 0 : angle, use});
  }
  std::stable_sort(leaves.begin(), leaves.end(), [](const Leaf& p, const Leaf& q) { return p.angle < q.angle; });
  return leaves;
}

// Corner 3 f + i of the use's facet at the edge's lower point, or at its upper one.
std::uint32_t corner_of(const EdgeUse& use, bool lower) {
  const std::uint32_t from = use.side, to = (use.side + 1u) % 3;
  return 3 * use.facet + (use.forward == lower ? from : to);
}

void pair_up(const EdgeUse& f, const EdgeUse& g, UnionFind& fans) {
  for (const bool lower : {true, false}) fans.unite(corner_of(f, lower), corner_of(g, lower));
}

// A facet that runs the edge from a to b has its material on the side of smaller angles: it is paired with the
// facet before it, if that one runs the edge backwards. [T-MANI-1]
void pair_by_angle(const TriangleSoup& soup, const EdgeTable& table, std::size_t e, UnionFind& fans) {
  const std::vector<Leaf> leaves = around_edge(soup, table.edge(e), table.uses(e));
  for (std::size_t i = 0; i < leaves.size(); ++i) {
    const Leaf& here = leaves[i];
    const Leaf& before = leaves[(i + leaves.size() - 1) % leaves.size()];
    if (here.use.forward && !before.use.forward) pair_up(here.use, before.use, fans);
  }
}

bool is_manifold(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  for (std::size_t e = 0; e < table.size(); ++e)
    if (table.is_non_manifold(e) || table.is_misoriented(e)) return false;
  return true;
}

}  // namespace

ManifoldPieces split_into_manifold_pieces(const TriangleSoup& oriented) {
  ManifoldPieces result;
  UnionFind fans(3 * oriented.facets.size());
  {
    const EdgeTable table(oriented);
    for (std::size_t e = 0; e < table.size(); ++e) {
      const auto uses = table.uses(e);
      if (uses.size() == 2 && !table.is_misoriented(e)) {
        pair_up(uses[0], uses[1], fans);
      } else if (uses.size() > 1) {
        ++result.cut_edges;
        pair_by_angle(oriented, table, e, fans);
      }
    }
  }
  result.soup.points = oriented.points;
  result.soup.facets = oriented.facets;
  result.original.resize(oriented.points.size());
  for (std::uint32_t p = 0; p < oriented.points.size(); ++p) result.original[p] = p;
  std::vector<char> taken(oriented.points.size(), 0);
  std::vector<std::uint32_t> point_of_fan(3 * oriented.facets.size());
  for (std::uint32_t c = 0; c < point_of_fan.size(); ++c) {
    std::uint32_t& corner = result.soup.facets[c / 3][c % 3];
    if (!fans.is_representative(c)) {
      corner = point_of_fan[fans.find(c)];
      continue;
    }
    if (taken[corner]) {
      result.original.push_back(corner);
      result.soup.points.push_back(oriented.points[corner]);
      corner = static_cast<std::uint32_t>(result.soup.points.size() - 1);
      ++result.points_split;
    } else {
      taken[corner] = 1;
    }
    point_of_fan[c] = corner;
  }
  result.manifold = is_manifold(result.soup);
  return result;
}

}  // namespace burnish
