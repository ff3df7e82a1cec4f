#include "burnish/surface/creases.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "burnish/core/parallel.h"
#include "denoise/bilateral_normals.h"

namespace burnish {
namespace {

constexpr double kCornerTurn = 30 * std::numbers::pi / 180;
// Of the largest coordinate: lower facets have no normal of their own once points have been rounded to float32.
constexpr double kRoundedHeight = 4e-6;
constexpr int kNeedlesDeep = 4;

double to_radians(double degrees) { return degrees * std::numbers::pi / 180; }

double angle_between(const Vec3& m, const Vec3& n) { return 2 * std::asin(std::min(1.0, 0.5 * norm(m - n))); }

double largest_coordinate(const TriangleSoup& soup) {
  const Box3 box = bounding_box(soup);
  double largest = 0;
  for (const Vec3& p : {box.lower, box.upper}) largest = std::max({largest, std::abs(p.x), std::abs(p.y), std::abs(p.z)});
  return largest;
}

bool is_oriented_pair(const EdgeTable& table, std::size_t e) { return table.uses(e).size() == 2 && !table.is_misoriented(e); }

// Needles take the normal of the facet across their longest side, so that a crease runs along the other two.
void borrow_normals(const TriangleSoup& soup, const EdgeTable& table, FacetNormals& normals) {
  const double least = kRoundedHeight * largest_coordinate(soup);
  std::vector<std::uint32_t> needles;
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    if (altitude(soup, normals, f) < least) needles.push_back(f);
  if (needles.empty()) return;
  std::vector<std::uint32_t> lender(soup.facets.size(), kNoFacet);
  for (const std::uint32_t f : needles) normals.unit[f] = {};
  std::vector<double> longest(soup.facets.size(), 0.0);
  for (std::size_t e = 0; e < table.size(); ++e) {
    if (!is_oriented_pair(table, e)) continue;
    const double length = squared_norm(soup.points[table.edge(e)[1]] - soup.points[table.edge(e)[0]]);
    const auto u = table.uses(e);
    for (const auto& [own, other] : {std::pair{u[0].facet, u[1].facet}, std::pair{u[1].facet, u[0].facet}})
      if (length > longest[own]) longest[own] = length, lender[own] = other;
  }
  for (int depth = 0; depth < kNeedlesDeep; ++depth)
    for (const std::uint32_t f : needles)
      if (lender[f] != kNoFacet && squared_norm(normals.unit[f]) == 0) normals.unit[f] = normals.unit[lender[f]];
}

class Finder {
 public:
  Finder(const TriangleSoup& soup, const CreaseOptions& options) : soup_(soup), options_(options), table_(soup), normals_(facet_normals(soup)) {
    if (options.sigma > 0) {
      filter_normals(soup, table_, options.sigma, 0, normals_);
    } else {
      borrow_normals(soup, table_, normals_);
    }
  }

  Creases find() {
    collect_edges();
    while (true) {
      link();
      trace();
      if (!drop_short_chains()) break;
    }
    return std::move(found_);
  }

 private:
  // How far both facets reach from their edge.
  double reach(std::size_t e) const {
    const auto u = table_.uses(e);
    const double length = norm(soup_.points[table_.edge(e)[1]] - soup_.points[table_.edge(e)[0]]);
    return length > 0 ? std::min(normals_.area[u[0].facet], normals_.area[u[1].facet]) / length : 0;
  }

  // [T-CREASE-1]
  bool is_sharp(std::size_t e) const {
    if (!is_oriented_pair(table_, e)) return false;
    const auto u = table_.uses(e);
    const Vec3 &m = normals_.unit[u[0].facet], &n = normals_.unit[u[1].facet];
    if (squared_norm(m) == 0 || squared_norm(n) == 0) return false;
    // What is thinner than the noise may have been folded by it.
    if (options_.sigma > 0 && std::min(altitude(soup_, normals_, u[0].facet), altitude(soup_, normals_, u[1].facet)) < options_.sigma) return false;
    const double angle = angle_between(m, n);
    if (angle > to_radians(options_.angle)) return true;
    return angle > to_radians(options_.resolved_angle) && reach(e) >= options_.resolved;
  }

  void collect_edges() {
    std::vector<char> sharp(table_.size());
    parallel_for(table_.size(), [&](std::size_t e) { sharp[e] = is_sharp(e); });
    for (std::size_t e = 0; e < table_.size(); ++e) {
      if (!sharp[e]) continue;
      const auto u = table_.uses(e);
      const EdgeUse &first = u[0].forward ? u[0] : u[1], &second = u[0].forward ? u[1] : u[0];
      found_.edges.push_back({table_.edge(e), {first.facet, second.facet}});
    }
  }

  // The edges at each point, as slots in `at_`.
  void link() {
    first_.assign(soup_.points.size() + 1, 0);
    for (const CreaseEdge& e : found_.edges)
      for (const std::uint32_t p : e.points) ++first_[p + 1];
    for (std::size_t p = 0; p < soup_.points.size(); ++p) first_[p + 1] += first_[p];
    at_.resize(2 * found_.edges.size());
    std::vector<std::uint32_t> next(first_.begin(), first_.end() - 1);
    for (std::uint32_t e = 0; e < found_.edges.size(); ++e)
      for (const std::uint32_t p : found_.edges[e].points) at_[next[p]++] = e;
  }
  std::uint32_t degree(std::uint32_t p) const { return first_[p + 1] - first_[p]; }
  std::uint32_t other_end(std::uint32_t e, std::uint32_t p) const {
    const Edge& points = found_.edges[e].points;
    return points[0] == p ? points[1] : points[0];
  }
  bool is_corner(std::uint32_t p) const {
    if (degree(p) != 2) return true;
    const Vec3 in = soup_.points[p] - soup_.points[other_end(at_[first_[p]], p)], out = soup_.points[other_end(at_[first_[p] + 1], p)] - soup_.points[p];
    return dot(in, out) < std::cos(kCornerTurn) * norm(in) * norm(out);
  }

  // Follows edges that have no chain yet, from `start` along `e` to a corner or back to the start. [T-CREASE-2]
  void follow(std::uint32_t start, std::uint32_t e) {
    std::vector<std::uint32_t>& chain = found_.chains.emplace_back(1, start);
    std::vector<std::uint32_t>& members = members_.emplace_back();
    for (std::uint32_t p = start;;) {
      done_[e] = 1;
      members.push_back(e);
      p = other_end(e, p);
      chain.push_back(p);
      if (p == start || is_corner(p)) return;
      e = at_[first_[p]] == e ? at_[first_[p] + 1] : at_[first_[p]];
    }
  }

  void trace() {
    found_.chains.clear();
    found_.corners.clear();
    members_.clear();
    done_.assign(found_.edges.size(), 0);
    for (std::uint32_t p = 0; p < soup_.points.size(); ++p) {
      if (degree(p) == 0 || !is_corner(p)) continue;
      found_.corners.push_back(p);
      for (std::uint32_t i = first_[p]; i < first_[p + 1]; ++i)
        if (!done_[at_[i]]) follow(p, at_[i]);
    }
    for (std::uint32_t e = 0; e < found_.edges.size(); ++e)
      if (!done_[e]) follow(found_.edges[e].points[0], e);
  }

  double length_of(const std::vector<std::uint32_t>& chain) const {
    double length = 0;
    for (std::size_t i = 1; i < chain.size(); ++i) length += norm(soup_.points[chain[i]] - soup_.points[chain[i - 1]]);
    return length;
  }

  bool drop_short_chains() {
    std::vector<char> dropped(found_.edges.size(), 0);
    bool any = false;
    for (std::size_t c = 0; c < found_.chains.size(); ++c) {
      const std::vector<std::uint32_t>& chain = found_.chains[c];
      if (degree(chain.front()) != 1 && degree(chain.back()) != 1) continue;
      if (!(length_of(chain) < options_.least_length)) continue;
      any = true;
      for (const std::uint32_t e : members_[c]) dropped[e] = 1;
    }
    std::size_t kept = 0;
    for (std::size_t e = 0; e < dropped.size(); ++e)
      if (!dropped[e]) found_.edges[kept++] = found_.edges[e];
    found_.edges.resize(kept);
    return any;
  }

  const TriangleSoup& soup_;
  const CreaseOptions& options_;
  const EdgeTable table_;
  FacetNormals normals_;
  std::vector<std::uint32_t> first_, at_;            // CSR: edges at each point
  std::vector<std::vector<std::uint32_t>> members_;  // edges of each chain
  std::vector<char> done_;
  Creases found_;
};

}  // namespace

Creases find_creases(const TriangleSoup& welded, const CreaseOptions& options) { return Finder(welded, options).find(); }

TriangleSoup folded(const TriangleSoup& soup, const Creases& creases) {
  TriangleSoup edges;
  edges.points.reserve(2 * creases.edges.size());
  for (const CreaseEdge& e : creases.edges) {
    const auto first = static_cast<std::uint32_t>(edges.points.size());
    edges.points.push_back(soup.points[e.points[0]]);
    edges.points.push_back(soup.points[e.points[1]]);
    edges.facets.push_back({first, first + 1, first + 1});
  }
  return edges;
}

}  // namespace burnish
