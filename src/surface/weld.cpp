#include "burnish/surface/weld.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/surface/edge_table.h"
#include "facet_kinds.h"
#include "point_table.h"

namespace burnish {
namespace {

// Facets whose corners are hashed ahead, so that their cache misses overlap.
constexpr std::size_t kAhead = 16;

// Replaces each index of `facets` by that of the welded point and returns the welded points. [T-WELD-1]
std::vector<Vec3> weld_in_place(const std::vector<Vec3>& points, std::vector<Facet>& facets) {
  // A closed surface has half as many points as facets; others make the table grow once or twice.
  PointTable table(std::min(points.size(), facets.size() / 2 + 16));
  std::array<std::array<std::uint64_t, 3>, kAhead> hashes;
  for (std::size_t begin = 0; begin < facets.size(); begin += kAhead) {
    const std::size_t count = std::min(kAhead, facets.size() - begin);
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        hashes[i][k] = hash_of(points[facets[begin + i][k]]);
        table.prefetch(hashes[i][k]);
      }
    for (std::size_t i = 0; i < count; ++i)
      for (std::size_t k = 0; k < 3; ++k) {
        std::uint32_t& index = facets[begin + i][k];
        index = table.insert(points[index], hashes[i][k]);
      }
  }
  return table.take_points();
}

// Points of open edges, each to be joined to an earlier one nearby (its leader) or to lead itself. [T-WELD-2]
class BoundaryJoiner {
 public:
  BoundaryJoiner(const TriangleSoup& soup, double tolerance)
      : soup_(soup), tolerance_(tolerance), leader_(soup.points.size()), origin_(bounding_box(soup).lower),
        cells_(1024) {
    for (std::uint32_t p = 0; p < leader_.size(); ++p) leader_[p] = p;
    find_boundary();
  }

  std::size_t join() {
    std::size_t moved = 0;
    for (const std::uint32_t p : boundary_) {
      if (const auto near = nearest_leader(p)) {
        leader_[p] = *near;
        ++moved;
      } else {
        lead(p);
      }
    }
    return moved;
  }

  const std::vector<std::uint32_t>& leaders() const { return leader_; }

 private:
  void find_boundary() {
    const EdgeTable edges(soup_);
    std::vector<char> open(soup_.points.size(), 0);
    for (std::size_t e = 0; e < edges.size(); ++e)
      if (edges.is_open(e)) open[edges.edge(e)[0]] = open[edges.edge(e)[1]] = 1;
    for (std::uint32_t p = 0; p < open.size(); ++p)
      if (open[p]) boundary_.push_back(p);
    file_facets(open);
  }

  // CSR of the facets around each boundary point.
  void file_facets(const std::vector<char>& open) {
    first_facet_.assign(soup_.points.size() + 1, 0);
    for (const Facet& facet : soup_.facets)
      for (const std::uint32_t p : facet) first_facet_[p] += open[p] ? 1 : 0;
    facets_.resize(exclusive_scan_in_place(first_facet_));
    std::vector<std::uint32_t> next = first_facet_;
    for (std::uint32_t f = 0; f < soup_.facets.size(); ++f)
      for (const std::uint32_t p : soup_.facets[f])
        if (open[p]) facets_[next[p]++] = f;
  }

  // Cells are a little wider than the tolerance, so that rounding cannot hide a neighbour. Their numbers stay
  // doubles: no tolerance makes them overflow.
  Vec3 cell_of(const Vec3& p) const {
    const Vec3 q = (p - origin_) / (1.001 * tolerance_);
    return {std::floor(q.x), std::floor(q.y), std::floor(q.z)};
  }

  void lead(std::uint32_t p) {
    const std::uint32_t cell = cells_.insert(cell_of(soup_.points[p]));
    if (cell == leaders_in_cell_.size()) leaders_in_cell_.emplace_back();
    leaders_in_cell_[cell].push_back(p);
  }

  // True if a facet around p has a corner that went to `leader`: joining would collapse the facet.
  bool shares_facet(std::uint32_t p, std::uint32_t leader) const {
    for (std::uint32_t i = first_facet_[p]; i < first_facet_[p + 1]; ++i)
      for (const std::uint32_t corner : soup_.facets[facets_[i]])
        if (corner != p && leader_[corner] == leader) return true;
    return false;
  }

  std::optional<std::uint32_t> nearest_leader(std::uint32_t p) const {
    const Vec3& at = soup_.points[p];
    std::pair<double, std::uint32_t> best{tolerance_, 0};
    bool found = false;
    for_each_near(at, [&](std::uint32_t leader) {
      const std::pair<double, std::uint32_t> candidate{norm(soup_.points[leader] - at), leader};
      if (found ? candidate >= best : candidate.first > tolerance_) return;
      if (shares_facet(p, leader)) return;
      best = candidate;
      found = true;
    });
    return found ? std::optional(best.second) : std::nullopt;
  }

  template <class Visit>
  void for_each_near(const Vec3& at, Visit&& visit) const {
    const Vec3 cell = cell_of(at);
    for (int i = 0; i < 27; ++i) {
      const int x = i % 3 - 1, y = i / 3 % 3 - 1, z = i / 9 - 1;
      const Vec3 offset{static_cast<double>(x), static_cast<double>(y), static_cast<double>(z)};
      const std::uint32_t number = cells_.find(cell + offset);
      if (number == PointTable::kFree) continue;
      for (const std::uint32_t leader : leaders_in_cell_[number]) visit(leader);
    }
  }

  const TriangleSoup& soup_;
  double tolerance_;
  std::vector<std::uint32_t> leader_;
  Vec3 origin_;
  std::vector<std::uint32_t> boundary_;
  std::vector<std::uint32_t> first_facet_, facets_;
  PointTable cells_;
  std::vector<std::vector<std::uint32_t>> leaders_in_cell_;
};

// The group list of a soup of which only the proper facets remain.
std::vector<FacetGroup> groups_after_dropping(const std::vector<FacetGroup>& groups,
                                              const std::vector<FacetKind>& kinds) {
  std::vector<FacetGroup> result = groups;
  std::uint32_t next = 0;
  for (FacetGroup& group : result) {
    const auto begin = kinds.begin() + group.first_facet;
    const auto kept = std::count(begin, begin + group.facet_count, FacetKind::proper);
    group.first_facet = next;
    group.facet_count = static_cast<std::uint32_t>(kept);
    next += group.facet_count;
  }
  return result;
}

}  // namespace

TriangleSoup weld(const TriangleSoup& soup) {
  TriangleSoup result;
  result.facets = soup.facets;
  result.groups = soup.groups;
  result.colors = soup.colors;
  result.points = weld_in_place(soup.points, result.facets);
  return result;
}

TriangleSoup weld(TriangleSoup&& soup) {
  TriangleSoup result = std::move(soup);
  result.points = weld_in_place(result.points, result.facets);
  return result;
}

WeldedNear weld_boundaries(const TriangleSoup& soup, double tolerance) {
  if (!(tolerance > 0)) return {soup, 0};
  BoundaryJoiner joiner(soup, tolerance);
  const std::size_t moved = joiner.join();
  TriangleSoup joined = soup;
  for (Facet& facet : joined.facets)
    for (std::uint32_t& p : facet) p = joiner.leaders()[p];
  return {weld(std::move(joined)), moved};
}

CleanedFacets drop_degenerate_and_duplicate_facets(const TriangleSoup& soup) {
  const std::vector<FacetKind> kinds = facet_kinds(soup);
  CleanedFacets result;
  result.degenerate = static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), FacetKind::degenerate));
  result.duplicate = static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), FacetKind::duplicate));
  result.soup.points = soup.points;
  result.soup.groups = groups_after_dropping(soup.groups, kinds);
  for (std::size_t f = 0; f < kinds.size(); ++f) {
    if (kinds[f] != FacetKind::proper) continue;
    result.soup.facets.push_back(soup.facets[f]);
    if (!soup.colors.empty()) result.soup.colors.push_back(soup.colors[f]);
  }
  result.soup = weld(std::move(result.soup));
  return result;
}

}  // namespace burnish
