#include "burnish/surface/facet_filter.h"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <span>
#include <utility>

#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/weld.h"
#include "facet_kinds.h"

namespace burnish {
namespace {

Facet sorted(Facet f) {
  std::sort(f.begin(), f.end());
  return f;
}

// For each facet that is a copy the first of its kind; itself for all others.
std::vector<std::uint32_t> first_copies(const TriangleSoup& soup, const std::vector<FacetKind>& kinds) {
  std::vector<std::uint32_t> first(soup.facets.size());
  for (std::uint32_t f = 0; f < first.size(); ++f) first[f] = f;
  std::vector<Facet> copied;
  for (std::size_t f = 0; f < kinds.size(); ++f)
    if (kinds[f] == FacetKind::duplicate) copied.push_back(sorted(soup.facets[f]));
  if (copied.empty()) return first;
  std::sort(copied.begin(), copied.end());
  copied.erase(std::unique(copied.begin(), copied.end()), copied.end());
  std::vector<std::uint32_t> seen(copied.size(), 0xffffffffu);
  for (std::uint32_t f = 0; f < first.size(); ++f) {
    if (kinds[f] == FacetKind::degenerate) continue;
    const Facet key = sorted(soup.facets[f]);
    const auto at = std::lower_bound(copied.begin(), copied.end(), key);
    if (at == copied.end() || *at != key) continue;
    std::uint32_t& earliest = seen[static_cast<std::size_t>(at - copied.begin())];
    if (earliest == 0xffffffffu) earliest = f;
    first[f] = earliest;
  }
  return first;
}

// Edges with an odd number of facets, with one copy kept and with none, per connected part of copied facets. [T-WALL-1]
class WallVote {
 public:
  WallVote(const TriangleSoup& soup, const std::vector<FacetKind>& kinds, const std::vector<std::uint32_t>& first)
      : copied_(soup.facets.size(), 0), parts_(soup.facets.size()), kept_(soup.facets.size(), 0), none_(soup.facets.size(), 0), all_(soup.facets.size(), 0),
        copies_(soup.facets.size(), 0), facing_(soup.facets.size(), 0) {
    for (std::uint32_t f = 0; f < first.size(); ++f)
      if (first[f] != f) copied_[f] = copied_[first[f]] = 1;
    const EdgeTable table(soup);
    for (std::size_t e = 0; e < table.size(); ++e) join(table.uses(e));
    for (std::uint32_t f = 0; f < first.size(); ++f)
      if (first[f] != f) parts_.unite(f, first[f]);
    for (std::size_t e = 0; e < table.size(); ++e) count(table.uses(e), kinds, first);
    for (std::uint32_t f = 0; f < first.size(); ++f) {
      if (!copied_[f]) continue;
      ++copies_[parts_.find(f)];
      facing_[parts_.find(f)] += same_way(soup.facets[f], soup.facets[first[f]]) ? 1 : -1;
    }
  }

  bool is_wall(std::uint32_t f) {
    const std::uint32_t part = parts_.find(f);
    return copied_[f] && none_[part] < kept_[part] && 2 * std::abs(facing_[part]) < copies_[part];
  }

  // Bodies that overlap need a copy each.
  bool all_are_needed(std::uint32_t f) {
    const std::uint32_t part = parts_.find(f);
    return copied_[f] && all_[part] < kept_[part] && 2 * std::abs(facing_[part]) >= copies_[part];
  }

 private:
  void join(std::span<const EdgeUse> uses) {
    const EdgeUse* before = nullptr;
    for (const EdgeUse& use : uses) {
      if (!copied_[use.facet]) continue;
      if (before) parts_.unite(before->facet, use.facet);
      before = &use;
    }
  }

  void count(std::span<const EdgeUse> uses, const std::vector<FacetKind>& kinds, const std::vector<std::uint32_t>& first) {
    std::size_t single = 0, firsts = 0, copies = 0;
    std::uint32_t copy = 0xffffffffu;
    for (const EdgeUse& use : uses) {
      if (!copied_[use.facet]) {
        single += kinds[use.facet] != FacetKind::degenerate;
      } else {
        copy = use.facet;
        ++copies;
        firsts += first[use.facet] == use.facet;
      }
    }
    if (copy == 0xffffffffu) return;
    const std::uint32_t part = parts_.find(copy);
    none_[part] += single % 2;
    kept_[part] += (single + firsts) % 2;
    all_[part] += (single + copies) % 2;
  }

  static bool same_way(const Facet& f, Facet g) {
    while (g[0] != f[0]) std::rotate(g.begin(), g.begin() + 1, g.end());
    return f == g;
  }

  std::vector<char> copied_;
  UnionFind parts_;
  std::vector<std::size_t> kept_, none_, all_;  // edges with an odd number of facets: one copy stays, none, all
  std::vector<long> copies_, facing_;  // facets of a part, and how many more of them face one way than the other
};

std::vector<FacetGroup> groups_of_kept(const std::vector<FacetGroup>& groups, const std::vector<char>& keep) {
  std::vector<FacetGroup> result = groups;
  std::uint32_t next = 0;
  for (FacetGroup& group : result) {
    const auto begin = keep.begin() + group.first_facet;
    const auto kept = std::count(begin, begin + group.facet_count, 1);
    group.first_facet = std::exchange(next, next + static_cast<std::uint32_t>(kept));
    group.facet_count = static_cast<std::uint32_t>(kept);
  }
  return result;
}

}  // namespace

FilteredFacets filter_facets(const TriangleSoup& welded, bool keep_collinear, bool drop_copies) {
  const std::vector<FacetKind> kinds = facet_kinds(welded);
  FilteredFacets result;
  std::vector<char> keep(kinds.size());
  for (std::size_t f = 0; f < kinds.size(); ++f) {
    const bool degenerate = kinds[f] == FacetKind::degenerate;
    keep[f] = !degenerate || (keep_collinear && !repeats_point(welded.facets[f]));
    result.degenerate += !keep[f];
  }
  if (drop_copies && std::find(kinds.begin(), kinds.end(), FacetKind::duplicate) != kinds.end()) {
    const std::vector<std::uint32_t> first = first_copies(welded, kinds);
    WallVote vote(welded, kinds, first);
    for (std::uint32_t f = 0; f < kinds.size(); ++f) {
      const bool wall = keep[f] && vote.is_wall(f), copy = first[f] != f && !vote.all_are_needed(f);
      if (wall || copy) keep[f] = 0;
      result.walls += wall;
      result.duplicate += copy && !wall;
    }
  }
  result.soup.points = welded.points;
  result.soup.groups = groups_of_kept(welded.groups, keep);
  for (std::uint32_t f = 0; f < keep.size(); ++f)
    if (keep[f]) {
      result.soup.facets.push_back(welded.facets[f]);
      result.source.push_back(f);
    }
  result.soup = weld(std::move(result.soup));
  return result;
}

}  // namespace burnish
