#include "support/damage.h"

#include <algorithm>
#include <cmath>
#include <functional>
#include <map>
#include <queue>
#include <utility>

#include "support/shapes.h"

namespace burnish::test {
namespace {

using DirectedEdge = std::pair<std::uint32_t, std::uint32_t>;
// For every directed edge the facet that runs along it.
using FacetLeftOf = std::map<DirectedEdge, std::uint32_t>;

FacetLeftOf facets_left_of_edges(const TriangleSoup& soup) {
  FacetLeftOf left;
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    for (std::size_t i = 0; i < 3; ++i) left[{soup.facets[f][i], soup.facets[f][(i + 1) % 3]}] = f;
  return left;
}

Vec3 centroid(const TriangleSoup& soup, std::size_t f) { return (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3; }

double local_edge(const TriangleSoup& soup, std::size_t f) {
  double sum = 0;
  for (int i = 0; i < 3; ++i) sum += norm(soup.corner(f, (i + 1) % 3) - soup.corner(f, i));
  return sum / 3;
}

std::vector<std::size_t> chosen_facets(const TriangleSoup& soup, double share, std::uint64_t seed) {
  Random random(seed);
  std::vector<std::size_t> facets;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    if (random.uniform(0, 1) < share) facets.push_back(f);
  return facets;
}

std::uint32_t corner_after(const Facet& facet, std::uint32_t point) {
  const auto at = std::find(facet.begin(), facet.end(), point) - facet.begin();
  return facet[static_cast<std::size_t>(at + 1) % 3];
}

// Cuts facet f in two from point m, on its side i, to the corner across.
void cut_facet(TriangleSoup& soup, std::size_t f, std::size_t i, std::uint32_t m) {
  const std::uint32_t a = soup.facets[f][i], b = soup.facets[f][(i + 1) % 3], c = soup.facets[f][(i + 2) % 3];
  soup.facets[f] = {a, m, c};
  soup.facets.push_back({m, b, c});
}

std::uint32_t add_point(TriangleSoup& soup, const Vec3& p) {
  soup.points.push_back(p);
  return static_cast<std::uint32_t>(soup.points.size() - 1);
}

std::vector<std::vector<std::uint32_t>> neighbours_of_points(const TriangleSoup& soup) {
  std::vector<std::vector<std::uint32_t>> neighbours(soup.points.size());
  for (const Facet& facet : soup.facets)
    for (std::size_t i = 0; i < 3; ++i) neighbours[facet[i]].push_back(facet[(i + 1) % 3]);
  return neighbours;
}

std::vector<Vec3> point_normals(const TriangleSoup& soup) {
  std::vector<Vec3> normals(soup.points.size());
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) normals[p] += facet_normal_2a(soup, f);
  for (Vec3& n : normals) n = squared_norm(n) > 0 ? n / norm(n) : Vec3{};
  return normals;
}

// The facets left of the path from u over v to w, around v.
std::vector<std::uint32_t> facets_between(const TriangleSoup& soup, const FacetLeftOf& left, std::uint32_t u, std::uint32_t v,
                                          std::uint32_t w) {
  std::vector<std::uint32_t> fan;
  for (std::uint32_t spoke = w; spoke != u;) {
    const std::uint32_t f = left.at({v, spoke});
    fan.push_back(f);
    spoke = corner_after(soup.facets[f], spoke);
  }
  return fan;
}

// All inner points of the path come apart into two, the left of which moves towards its facets.
void cut_along(TriangleSoup& soup, const std::vector<std::uint32_t>& path, double gap) {
  const FacetLeftOf left = facets_left_of_edges(soup);
  const TriangleSoup whole = soup;
  for (std::size_t i = 1; i + 1 < path.size(); ++i) {
    const auto fan = facets_between(whole, left, path[i - 1], path[i], path[i + 1]);
    const Vec3& v = whole.points[path[i]];
    Vec3 away;
    double edge = 0;
    for (const std::uint32_t f : fan) away += centroid(whole, f) - v, edge += local_edge(whole, f) / static_cast<double>(fan.size());
    const std::uint32_t bank = add_point(soup, v + away * (gap * edge / norm(away)));
    for (const std::uint32_t f : fan) std::replace(soup.facets[f].begin(), soup.facets[f].end(), path[i], bank);
  }
}

}  // namespace

Vec3 Random::in_ball() {
  for (;;) {
    const double x = uniform(-1, 1), y = uniform(-1, 1), z = uniform(-1, 1);
    if (squared_norm({x, y, z}) <= 1) return {x, y, z};
  }
}

TriangleSoup unwelded_and_jittered(const TriangleSoup& soup, double edges, std::uint64_t seed) {
  Random random(seed);
  TriangleSoup result = unwelded(soup);
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : result.facets[f]) result.points[p] += random.in_ball() * (edges * local_edge(soup, f));
  return result;
}

TriangleSoup jittered(const TriangleSoup& soup, double edges, std::uint64_t seed) {
  Random random(seed);
  const double most = edges * mean_edge_length(soup);
  return mapped(soup, [&](const Vec3& p) { return p + random.in_ball() * most; });
}

TriangleSoup without_random_facets(const TriangleSoup& soup, double share, std::uint64_t seed) {
  return without_facets(soup, chosen_facets(soup, share, seed));
}

TriangleSoup with_random_flips(TriangleSoup soup, double share, std::uint64_t seed) {
  for (const std::size_t f : chosen_facets(soup, share, seed)) std::swap(soup.facets[f][1], soup.facets[f][2]);
  return soup;
}

TriangleSoup with_random_copies(TriangleSoup soup, double share, std::uint64_t seed) {
  for (const std::size_t f : chosen_facets(soup, share, seed)) soup.facets.push_back(Facet(soup.facets[f]));
  return soup;
}

TriangleSoup shuffled(TriangleSoup soup, std::uint64_t seed) {
  Random random(seed);
  for (std::size_t f = soup.facets.size(); f > 1; --f) std::swap(soup.facets[f - 1], soup.facets[random.below(f)]);
  for (Facet& facet : soup.facets)
    std::rotate(facet.begin(), facet.begin() + static_cast<std::ptrdiff_t>(random.below(3)), facet.end());
  return soup;
}

TriangleSoup with_round_hole(const TriangleSoup& soup, double share, std::uint64_t seed) {
  Random random(seed);
  const FacetLeftOf left = facets_left_of_edges(soup);
  const auto first = static_cast<std::uint32_t>(random.below(soup.facets.size()));
  const Vec3 center = centroid(soup, first);
  using Reached = std::pair<double, std::uint32_t>;
  std::priority_queue<Reached, std::vector<Reached>, std::greater<>> nearest;
  std::vector<char> seen(soup.facets.size());
  const auto reach = [&](std::uint32_t f) {
    if (!std::exchange(seen[f], 1)) nearest.push({squared_norm(centroid(soup, f) - center), f});
  };
  reach(first);
  std::vector<std::size_t> hole;
  for (double left_area = share * area(soup); !nearest.empty() && left_area > 0; ) {
    const std::uint32_t f = nearest.top().second;
    nearest.pop();
    hole.push_back(f);
    left_area -= norm(facet_normal_2a(soup, f)) / 2;
    for (std::size_t i = 0; i < 3; ++i) reach(left.at({soup.facets[f][(i + 1) % 3], soup.facets[f][i]}));
  }
  return without_facets(soup, hole);
}

TriangleSoup with_t_junctions(TriangleSoup soup, double share, double off, std::uint64_t seed) {
  const auto facets = chosen_facets(soup, share, seed);
  Random random(seed + 1);
  for (const std::size_t f : facets) {
    const std::size_t i = random.below(3);
    const Vec3 a = soup.points[soup.facets[f][i]], ab = soup.points[soup.facets[f][(i + 1) % 3]] - a;
    cut_facet(soup, f, i, add_point(soup, a + ab * random.uniform(0.3, 0.7) + random.in_ball() * (off * norm(ab))));
  }
  return soup;
}

std::vector<std::uint32_t> random_path(const TriangleSoup& soup, int steps, Random& random) {
  const auto neighbours = neighbours_of_points(soup);
  std::vector<std::uint32_t> path{soup.facets[random.below(soup.facets.size())][0]};
  const Vec3 direction = random.in_ball();
  for (int i = 0; i < steps; ++i) {
    const std::uint32_t from = path.back();
    double best = -2;
    std::uint32_t next = from;
    for (const std::uint32_t to : neighbours[from]) {
      const Vec3 d = soup.points[to] - soup.points[from];
      const double along = dot(d, direction) / (norm(d) * norm(direction));
      if (along > best && std::find(path.begin(), path.end(), to) == path.end()) best = along, next = to;
    }
    if (next == from) break;
    path.push_back(next);
  }
  return path;
}

TriangleSoup with_slits(TriangleSoup soup, int count, int steps, double gap, std::uint64_t seed) {
  Random random(seed);
  const TriangleSoup whole = soup;
  std::vector<char> used(whole.points.size());
  // Paths that meet would not open: such draws are thrown away.
  for (int cut = 0, draws = 0; cut < count && draws < 100; ++draws) {
    const auto path = random_path(whole, steps, random);
    const auto neighbours = neighbours_of_points(whole);
    const bool free = std::none_of(path.begin(), path.end(), [&](std::uint32_t p) { return used[p]; });
    if (!free || path.size() < 3) continue;
    for (const std::uint32_t p : path) {
      used[p] = 1;
      for (const std::uint32_t q : neighbours[p]) used[q] = 1;
    }
    cut_along(soup, path, gap);
    ++cut;
  }
  return soup;
}

TriangleSoup with_fin(TriangleSoup soup, int steps, double height, std::uint64_t seed) {
  Random random(seed);
  const auto path = random_path(soup, steps, random);
  const auto normals = point_normals(soup);
  const double up = height * mean_edge_length(soup);
  std::vector<std::uint32_t> top;
  for (const std::uint32_t p : path) top.push_back(add_point(soup, soup.points[p] + normals[p] * up));
  for (std::size_t i = 0; i + 1 < path.size(); ++i) {
    soup.facets.push_back({path[i], path[i + 1], top[i + 1]});
    soup.facets.push_back({path[i], top[i + 1], top[i]});
  }
  return soup;
}

TriangleSoup with_slivers(TriangleSoup soup, double share, std::uint64_t seed) {
  const auto facets = chosen_facets(soup, share, seed);
  Random random(seed + 1);
  for (const std::size_t f : facets) {
    const std::size_t i = random.below(3);
    const std::uint32_t a = soup.facets[f][i], b = soup.facets[f][(i + 1) % 3];
    const std::uint32_t m = add_point(soup, (soup.points[a] + soup.points[b]) / 2);
    cut_facet(soup, f, i, m);
    soup.facets.push_back({a, b, m});
    soup.facets.push_back({a, b, b});
  }
  return soup;
}

}  // namespace burnish::test
