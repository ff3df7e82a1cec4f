#include "burnish/surface/defect_map.h"

#include <algorithm>
#include <cassert>
#include <functional>
#include <limits>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"

namespace burnish {
namespace {

using Indices = std::vector<std::uint32_t>;

constexpr std::uint32_t kNone = 0xffffffffu;

// Sizes are compared and written as JSON: neither bears what overflow leaves behind.
double finite(double size) {
  constexpr double kLargest = std::numeric_limits<double>::max();
  return size <= kLargest ? size : kLargest;
}

// Relative to the first position, so that models far from the origin keep their digits.
class WeightedMean {
 public:
  void add(const Vec3& position, double weight) {
    if (weight_ == 0) origin_ = position;
    moment_ += (position - origin_) * weight;
    weight_ += weight;
  }
  // Within the box, whatever rounding, underflow and overflow did.
  Vec3 within(const Box3& box) const {
    const Vec3 mean = origin_ + moment_ / weight_;
    return is_finite(mean) ? min(max(mean, box.lower), box.upper) : box.center();
  }

 private:
  Vec3 origin_, moment_;
  double weight_ = 0;
};

// The defects of one kind, before they are sorted, and the one of each element.
struct Found {
  std::vector<LocatedDefect> defects;
  Indices of_element;
  std::vector<WeightedMean> means;

  void place() {
    for (std::size_t d = 0; d < means.size(); ++d) defects[d].position = means[d].within(defects[d].box);
  }
};

// One defect for each set, numbered in the order of the elements; member(element) is in the element's set.
void add_sets(Found& found, DefectKind kind, UnionFind& sets, std::size_t universe, const auto& elements,
              auto&& member) {
  Indices number(universe, kNone);
  std::uint32_t count = 0;
  found.of_element.reserve(elements.size());
  for (const auto& element : elements) {
    std::uint32_t& defect = number[sets.find(member(element))];
    if (defect == kNone) defect = count++;
    found.of_element.push_back(defect);
  }
  LocatedDefect nothing_yet;
  nothing_yet.kind = kind;
  nothing_yet.facet = kNone;
  found.defects.assign(count, nothing_yet);
  found.means.resize(count);
}

void gather_chains(Found& found, DefectKind kind, const std::vector<DefectiveEdge>& edges,
                   std::size_t points) {
  UnionFind sets(points);
  for (const DefectiveEdge& edge : edges) sets.unite(edge.points[0], edge.points[1]);
  add_sets(found, kind, sets, points, edges, [](const DefectiveEdge& edge) { return edge.points[0]; });
}

void add_edge(LocatedDefect& chain, WeightedMean& mean, const TriangleSoup& soup, const DefectiveEdge& edge) {
  const Vec3& a = soup.points[edge.points[0]];
  const Vec3& b = soup.points[edge.points[1]];
  const double length = norm(b - a);
  mean.add(a * 0.5 + b * 0.5, length);
  chain.box.extend(a);
  chain.box.extend(b);
  chain.length = finite(chain.length + length);
  chain.facet = std::min(chain.facet, edge.facet);
  ++chain.count;
}

void add_cone(LocatedDefect& loop, const TriangleSoup& soup, const DefectiveEdge& edge) {
  const Vec3 a = soup.points[edge.points[0]] - loop.position, b = soup.points[edge.points[1]] - loop.position;
  loop.area = finite(loop.area + norm(cross(a, b)) / 2);
}

Found chains(DefectKind kind, const TriangleSoup& soup, const std::vector<DefectiveEdge>& edges) {
  Found found;
  if (edges.empty()) return found;
  gather_chains(found, kind, edges, soup.points.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const std::uint32_t chain = found.of_element[e];
    add_edge(found.defects[chain], found.means[chain], soup, edges[e]);
  }
  found.place();
  if (kind != DefectKind::open_loop) return found;
  for (std::size_t e = 0; e < edges.size(); ++e) add_cone(found.defects[found.of_element[e]], soup, edges[e]);
  return found;
}

Found single_points(const TriangleSoup& soup, const Indices& points) {
  Found found;
  if (points.empty()) return found;
  Indices defect_at(soup.points.size(), kNone);
  for (const std::uint32_t p : points) {
    defect_at[p] = static_cast<std::uint32_t>(found.defects.size());
    found.of_element.push_back(defect_at[p]);
    found.defects.push_back(
        {DefectKind::non_manifold_point, soup.points[p], {soup.points[p], soup.points[p]}, 0, 0, 0, kNone});
  }
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) {
      if (defect_at[p] == kNone || repeats_point(soup.facets[f])) continue;
      LocatedDefect& defect = found.defects[defect_at[p]];
      defect.facet = std::min(defect.facet, f);
      ++defect.count;
    }
  return found;
}

Box3 box_of(const TriangleSoup& soup, std::uint32_t f) {
  Box3 box;
  for (int i = 0; i < 3; ++i) box.extend(soup.corner(f, i));
  return box;
}

double area_of(const TriangleSoup& soup, std::uint32_t f) {
  return finite(norm(facet_normal_2a(soup, f)) / 2);
}

LocatedDefect facet_defect(DefectKind kind, const TriangleSoup& soup, std::uint32_t f) {
  LocatedDefect defect{kind, {}, box_of(soup, f), 1, 0, 0, f};
  WeightedMean mean;
  for (int i = 0; i < 3; ++i) {
    mean.add(soup.corner(f, i), 1);
    defect.length = std::max(defect.length, finite(norm(soup.corner(f, (i + 1) % 3) - soup.corner(f, i))));
  }
  defect.position = mean.within(defect.box);
  if (kind == DefectKind::duplicate_facet) defect.area = area_of(soup, f);
  return defect;
}

Found single_facets(DefectKind kind, const TriangleSoup& soup, const Indices& facets) {
  Found found;
  for (const std::uint32_t f : facets) {
    found.of_element.push_back(static_cast<std::uint32_t>(found.defects.size()));
    found.defects.push_back(facet_defect(kind, soup, f));
  }
  return found;
}

using Pairs = std::vector<std::array<std::uint32_t, 2>>;

// The facets that take part in pairs, ascending.
Indices facets_of(const Pairs& pairs, std::size_t facets) {
  std::vector<char> takes_part(facets, 0);
  for (const auto& [f, g] : pairs) takes_part[f] = takes_part[g] = 1;
  Indices taking_part;
  for (std::uint32_t f = 0; f < facets; ++f)
    if (takes_part[f]) taking_part.push_back(f);
  return taking_part;
}

void unite_around_points(UnionFind& sets, const TriangleSoup& soup, const Indices& facets) {
  Indices first_at(soup.points.size(), kNone);
  for (const std::uint32_t f : facets)
    for (const std::uint32_t p : soup.facets[f]) {
      if (first_at[p] == kNone) first_at[p] = f;
      sets.unite(first_at[p], f);
    }
}

// Boxes of facets that intersect overlap, if only in a point.
Box3 overlap(const Box3& a, const Box3& b) { return {max(a.lower, b.lower), min(a.upper, b.upper)}; }

void add_pair(LocatedDefect& cluster, WeightedMean& mean, const TriangleSoup& soup,
              const std::array<std::uint32_t, 2>& pair) {
  const Box3 meeting = overlap(box_of(soup, pair[0]), box_of(soup, pair[1]));
  cluster.box.extend(meeting);
  mean.add(meeting.center(), 1);
  ++cluster.count;
}

Found clusters(const TriangleSoup& soup, const Pairs& pairs, const Indices& facets) {
  Found found;
  if (pairs.empty()) return found;
  UnionFind sets(soup.facets.size());
  for (const auto& [f, g] : pairs) sets.unite(f, g);
  unite_around_points(sets, soup, facets);
  add_sets(found, DefectKind::self_intersection, sets, soup.facets.size(), facets, std::identity());
  Indices cluster_of(soup.facets.size(), kNone);
  for (std::size_t i = 0; i < facets.size(); ++i) {
    LocatedDefect& cluster = found.defects[cluster_of[facets[i]] = found.of_element[i]];
    cluster.facet = std::min(cluster.facet, facets[i]);
    cluster.area = finite(cluster.area + area_of(soup, facets[i]));
  }
  for (const auto& pair : pairs) {
    const std::uint32_t cluster = cluster_of[pair[0]];
    add_pair(found.defects[cluster], found.means[cluster], soup, pair);
  }
  found.place();
  return found;
}

double size_of(const LocatedDefect& defect) {
  switch (defect.kind) {
    case DefectKind::duplicate_facet:
      return defect.area;
    case DefectKind::non_manifold_point:
    case DefectKind::self_intersection:
      return static_cast<double>(defect.count);
    default:
      return defect.length;
  }
}

// Appends the defects of a kind, the largest first.
void append(DefectMap& map, DefectKind kind, Found found) {
  std::vector<std::pair<double, std::uint32_t>> order;
  order.reserve(found.defects.size());
  for (std::uint32_t d = 0; d < found.defects.size(); ++d) order.emplace_back(-size_of(found.defects[d]), d);
  parallel_sort(order);
  Indices place(order.size());
  map.defects.reserve(map.defects.size() + order.size());
  for (const auto& [size, d] : order) {
    place[d] = static_cast<std::uint32_t>(map.defects.size());
    map.defects.push_back(found.defects[d]);
  }
  for (std::uint32_t& defect : found.of_element) defect = place[defect];
  map.defect_of_element[static_cast<std::size_t>(kind)] = std::move(found.of_element);
}

}  // namespace

std::string_view name(DefectKind kind) {
  constexpr std::array<std::string_view, kDefectKinds> kNames = {
      "open_loop",        "non_manifold_edge", "non_manifold_point", "misoriented_edge",
      "degenerate_facet", "duplicate_facet",   "self_intersection"};
  return kNames[static_cast<std::size_t>(kind)];
}

std::span<const LocatedDefect> DefectMap::of(DefectKind kind) const {
  const auto first = std::partition_point(defects.begin(), defects.end(), [&](const LocatedDefect& d) { return d.kind < kind; });
  const auto behind = std::partition_point(first, defects.end(), [&](const LocatedDefect& d) { return d.kind == kind; });
  return {first, behind};
}

DefectMap locate_defects(const TriangleSoup& welded, const Inspection& inspection) {
  const DefectiveElements& elements = inspection.elements;
  assert(elements.open_edges.size() == inspection.defects.open_edges && "inspected without its elements");
  DefectMap map;
  map.intersecting_facets = facets_of(inspection.self_intersections, welded.facets.size());
  const auto add_chains = [&](DefectKind kind, const std::vector<DefectiveEdge>& edges) {
    append(map, kind, chains(kind, welded, edges));
  };
  add_chains(DefectKind::open_loop, elements.open_edges);
  add_chains(DefectKind::non_manifold_edge, elements.non_manifold_edges);
  append(map, DefectKind::non_manifold_point, single_points(welded, elements.non_manifold_points));
  add_chains(DefectKind::misoriented_edge, elements.misoriented_edges);
  for (const auto& [kind, facets] : {std::pair{DefectKind::degenerate_facet, &elements.degenerate_facets},
                                     std::pair{DefectKind::duplicate_facet, &elements.duplicate_facets}})
    append(map, kind, single_facets(kind, welded, *facets));
  append(map, DefectKind::self_intersection,
         clusters(welded, inspection.self_intersections, map.intersecting_facets));
  return map;
}

}  // namespace burnish
