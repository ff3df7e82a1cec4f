#include "burnish/surface/boundary_caps.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <unordered_map>
#include <vector>

#include "burnish/surface/edge_table.h"

namespace burnish {
namespace {

using Loop = std::vector<std::uint32_t>;  // points in the direction in which the cap's facets run its rim

constexpr std::size_t kLeastAreaLimit = 256;
constexpr double kLeastAreaBudget = 3e8;  // steps of dynamic programming over all loops
constexpr std::size_t kMaxRings = 12;
constexpr int kRelaxations = 200;

// Directed edges that the caps have to run, as (from, to), sorted: the chain's boundary, reversed. [T-CHAIN-1]
std::vector<Edge> missing_edges(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  std::vector<Edge> missing;
  for (std::size_t e = 0; e < table.size(); ++e) {
    int net = 0;
    for (const EdgeUse& use : table.uses(e)) net += use.forward ? 1 : -1;
    const auto [a, b] = table.edge(e);
    for (; net > 0; --net) missing.push_back({b, a});
    for (; net < 0; ++net) missing.push_back({a, b});
  }
  std::sort(missing.begin(), missing.end());
  return missing;
}

// Splits a chain without boundary into simple loops: walk until a point repeats, cut the loop off, go on.
std::vector<Loop> split_into_loops(const std::vector<Edge>& edges) {
  std::unordered_map<std::uint32_t, std::size_t> next_edge;  // first unused edge that leaves a point
  for (std::size_t i = edges.size(); i-- > 0;) next_edge[edges[i][0]] = i;
  std::unordered_map<std::uint32_t, std::size_t> place_on_path;
  std::vector<Loop> loops;
  Loop path;
  const auto leave = [&](std::uint32_t point, std::uint32_t& to) {
    std::size_t& i = next_edge[point];
    if (i >= edges.size() || edges[i][0] != point) return false;
    to = edges[i++][1];
    return true;
  };
  for (const Edge& start : edges) {
    std::uint32_t at = start[0], to = 0;
    while (leave(at, to)) {
      if (path.empty()) place_on_path[at] = 0, path.push_back(at);
      if (const auto seen = place_on_path.find(to); seen != place_on_path.end()) {
        const std::size_t from = seen->second;
        loops.emplace_back(path.begin() + static_cast<std::ptrdiff_t>(from), path.end());
        for (std::size_t k = from + 1; k < path.size(); ++k) place_on_path.erase(path[k]);
        path.resize(from + 1);
      } else {
        place_on_path[to] = path.size();
        path.push_back(to);
      }
      at = path.back();
    }
    path.clear();
    place_on_path.clear();
  }
  return loops;
}

double triangle_area(const Vec3& a, const Vec3& b, const Vec3& c) { return 0.5 * norm(cross(b - a, c - a)); }

// Klincsek's dynamic programme: best[i][j] is the least area of a triangulation of points i..j. [T-CAP-1]
void least_area_cap(const Loop& loop, TriangleSoup& soup) {
  const std::size_t n = loop.size();
  std::vector<double> best(n * n, 0.0);
  std::vector<std::uint16_t> split(n * n, 0);
  const auto point = [&](std::size_t i) -> const Vec3& { return soup.points[loop[i]]; };
  for (std::size_t span = 2; span < n; ++span)
    for (std::size_t i = 0; i + span < n; ++i) {
      const std::size_t j = i + span;
      double least = std::numeric_limits<double>::infinity();
      split[i * n + j] = static_cast<std::uint16_t>(i + 1);
      for (std::size_t m = i + 1; m < j; ++m) {
        const double sum = best[i * n + m] + best[m * n + j] + triangle_area(point(i), point(m), point(j));
        if (sum < least) {
          least = sum;
          split[i * n + j] = static_cast<std::uint16_t>(m);
        }
      }
      best[i * n + j] = least;
    }
  std::vector<std::array<std::size_t, 2>> todo{{0, n - 1}};
  while (!todo.empty()) {
    const auto [i, j] = todo.back();
    todo.pop_back();
    if (j < i + 2) continue;
    const std::size_t m = split[i * n + j];
    soup.facets.push_back({loop[i], loop[m], loop[j]});
    todo.push_back({i, m});
    todo.push_back({m, j});
  }
}

// The points of a membrane disc: rings of n points from the rim (ring `rings`) to the centre.
class Membrane {
 public:
  Membrane(const Loop& loop, const TriangleSoup& soup) : n_(loop.size()) {
    double rim = 0;
    for (std::size_t i = 0; i < n_; ++i) {
      center_ += soup.points[loop[i]] / static_cast<double>(n_);
      rim += norm(soup.points[loop[(i + 1) % n_]] - soup.points[loop[i]]);
    }
    double radius = 0;
    for (const std::uint32_t p : loop) radius += norm(soup.points[p] - center_) / static_cast<double>(n_);
    const double edge = rim / static_cast<double>(n_);
    rings_ = std::clamp<std::size_t>(edge > 0 ? static_cast<std::size_t>(radius / edge) : 2, 2, kMaxRings);
    points_.resize(rings_ * n_);
    for (std::size_t r = 1; r <= rings_; ++r)
      for (std::size_t i = 0; i < n_; ++i)
        at(r, i) = center_ + (soup.points[loop[i]] - center_) *
                                 (static_cast<double>(r) / static_cast<double>(rings_));
    for (int pass = 0; pass < kRelaxations; ++pass) relax();
  }

  // Adds the disc's facets; rim points are the loop's.
  void add_to(TriangleSoup& soup, const Loop& loop) const {
    const auto base = static_cast<std::uint32_t>(soup.points.size());
    soup.points.push_back(center_);
    for (std::size_t k = 0; k + n_ < points_.size(); ++k) soup.points.push_back(points_[k]);
    const auto index = [&](std::size_t r, std::size_t i) {
      if (r == 0) return base;
      return r == rings_ ? loop[i] : base + 1 + static_cast<std::uint32_t>((r - 1) * n_ + i);
    };
    for (std::size_t r = 0; r < rings_; ++r)
      for (std::size_t i = 0; i < n_; ++i) {
        const std::size_t j = (i + 1) % n_;
        soup.facets.push_back({index(r + 1, i), index(r + 1, j), index(r, i)});
        if (r > 0) soup.facets.push_back({index(r, i), index(r + 1, j), index(r, j)});
      }
  }

 private:
  Vec3& at(std::size_t r, std::size_t i) { return points_[(r - 1) * n_ + i]; }

  // One Gauss-Seidel pass of Laplace's equation in polar coordinates. [T-CAP-2]
  void relax() {
    const double turn = 2 * std::numbers::pi / static_cast<double>(n_);
    for (std::size_t r = rings_ - 1; r >= 1; --r) {
      const double rr = static_cast<double>(r);
      const double outer = 1 + 0.5 / rr, inner = 1 - 0.5 / rr, around = 1 / (rr * rr * turn * turn);
      for (std::size_t i = 0; i < n_; ++i) {
        const Vec3 below = r == 1 ? center_ : at(r - 1, i);
        at(r, i) = (at(r + 1, i) * outer + below * inner + (at(r, (i + 1) % n_) + at(r, (i + n_ - 1) % n_)) * around) /
                   (outer + inner + 2 * around);
      }
    }
    Vec3 sum;
    for (std::size_t i = 0; i < n_; ++i) sum += at(1, i);
    center_ = sum / static_cast<double>(n_);
  }

  std::size_t n_;
  std::size_t rings_ = 2;
  Vec3 center_;
  std::vector<Vec3> points_;
};

std::vector<Vec3> points_of(const Loop& loop, const TriangleSoup& soup) {
  std::vector<Vec3> points;
  for (const std::uint32_t p : loop) points.push_back(soup.points[p]);
  return points;
}

// The cap's facets are the last ones of the soup.
void finish(Cap& cap, const TriangleSoup& soup) {
  cap.facet_count = soup.facets.size() - cap.first_facet;
  cap.hole.filled = true;
  cap.hole.area = 0;
  for (std::size_t f = cap.first_facet; f < soup.facets.size(); ++f) cap.hole.area += 0.5 * norm(facet_normal_2a(soup, f));
}

// Groups and colours speak of all facets or of none.
void name_caps(TriangleSoup& soup, std::size_t first) {
  const std::size_t caps = soup.facets.size() - first;
  if (!soup.colors.empty()) soup.colors.resize(soup.facets.size(), kNoColor);
  if (!soup.groups.empty() && caps > 0)
    soup.groups.push_back({"", static_cast<std::uint32_t>(first), static_cast<std::uint32_t>(caps)});
}

}  // namespace

CappedSoup cap_boundary(const TriangleSoup& oriented) {
  CappedSoup result{oriented, oriented.facets.size(), {}, 0};
  TriangleSoup& soup = result.soup;
  double budget = kLeastAreaBudget;
  for (const Loop& loop : split_into_loops(missing_edges(oriented))) {
    if (loop.size() < 3) continue;  // two opposite edges cancel
    Cap cap{measure_hole(points_of(loop, soup)), soup.facets.size(), 0};
    const double n = static_cast<double>(loop.size());
    if (loop.size() <= kLeastAreaLimit && n * n * n / 6 <= budget) {
      budget -= n * n * n / 6;
      least_area_cap(loop, soup);
    } else {
      Membrane(loop, soup).add_to(soup, loop);
    }
    finish(cap, soup);
    result.cap_area += cap.hole.area;
    result.caps.push_back(cap);
  }
  name_caps(soup, result.first_cap_facet);
  return result;
}

}  // namespace burnish
