#include "burnish/surface/inspect.h"

#include <algorithm>
#include <utility>

#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/shells.h"
#include "facet_kinds.h"

namespace burnish {
namespace {

void count_edges(const EdgeTable& edges, Defects& defects) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    defects.open_edges += edges.is_open(e);
    defects.non_manifold_edges += edges.is_non_manifold(e);
    defects.misoriented_edges += edges.is_misoriented(e);
  }
}

void list_edges(const EdgeTable& edges, DefectiveElements& elements) {
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const DefectiveEdge edge{edges.edge(e), edges.uses(e)[0].facet};
    if (edges.is_open(e)) elements.open_edges.push_back(edge);
    if (edges.is_non_manifold(e)) elements.non_manifold_edges.push_back(edge);
    if (edges.is_misoriented(e)) elements.misoriented_edges.push_back(edge);
  }
}

std::vector<std::uint32_t> facets_of_kind(const std::vector<FacetKind>& kinds, FacetKind kind) {
  std::vector<std::uint32_t> facets;
  for (std::uint32_t f = 0; f < kinds.size(); ++f)
    if (kinds[f] == kind) facets.push_back(f);
  return facets;
}

// Sets of facets connected through edges, facets that use no edge aside.
std::size_t count_components(const TriangleSoup& soup, const EdgeTable& edges) {
  UnionFind sets(soup.facets.size());
  for (std::size_t e = 0; e < edges.size(); ++e)
    for (const EdgeUse& use : edges.uses(e)) sets.unite(edges.uses(e)[0].facet, use.facet);
  std::size_t count = 0;
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    count += sets.is_representative(f) && !repeats_point(soup.facets[f]);
  return count;
}

std::size_t count_open_loops(const TriangleSoup& soup, const EdgeTable& edges) {
  UnionFind sets(soup.points.size());
  std::vector<char> on_loop(soup.points.size(), 0);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    if (!edges.is_open(e)) continue;
    const auto [a, b] = edges.edge(e);
    sets.unite(a, b);
    on_loop[a] = on_loop[b] = 1;
  }
  std::size_t count = 0;
  for (std::uint32_t p = 0; p < soup.points.size(); ++p) count += on_loop[p] && sets.is_representative(p);
  return count;
}

// The corner of the use's facet at the edge's lower point, or at its upper one.
std::uint32_t corner_at(const EdgeUse& use, bool lower) {
  const std::uint32_t from = use.side;
  const std::uint32_t to = use.side == 2 ? 0 : use.side + 1u;
  return 3 * use.facet + (use.forward == lower ? from : to);
}

// Points at which more than one fan of facets remains once corners of facets that meet in an edge are joined.
std::vector<std::uint32_t> points_with_several_fans(const TriangleSoup& soup, const EdgeTable& edges) {
  UnionFind fans(3 * soup.facets.size());
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses(e);
    for (std::size_t i = 1; i < uses.size(); ++i)
      for (const bool lower : {true, false}) fans.unite(corner_at(uses[0], lower), corner_at(uses[i], lower));
  }
  std::vector<std::uint8_t> fans_at(soup.points.size(), 0);
  for (std::uint32_t c = 0; c < 3 * soup.facets.size(); ++c) {
    const Facet& facet = soup.facets[c / 3];
    if (repeats_point(facet) || !fans.is_representative(c)) continue;
    std::uint8_t& count = fans_at[facet[c % 3]];
    count = static_cast<std::uint8_t>(std::min(2, count + 1));
  }
  std::vector<std::uint32_t> several;
  for (std::uint32_t p = 0; p < fans_at.size(); ++p)
    if (fans_at[p] > 1) several.push_back(p);
  return several;
}

void measure(const TriangleSoup& soup, Defects& defects) {
  defects.facets = soup.facets.size();
  defects.points = soup.points.size();
  defects.volume = signed_volume(soup);
  defects.area = area(soup);
  defects.mean_edge = mean_edge_length(soup);
  defects.box = bounding_box(soup);
}

}  // namespace

Inspection inspect(const TriangleSoup& welded, const InspectOptions& options, Progress& progress) {
  Inspection result;
  Defects& defects = result.defects;
  measure(welded, defects);
  progress.check();
  const std::vector<FacetKind> kinds = facet_kinds(welded);
  const auto count_kind = [&](FacetKind kind) {
    return static_cast<std::size_t>(std::count(kinds.begin(), kinds.end(), kind));
  };
  defects.degenerate_facets = count_kind(FacetKind::degenerate);
  defects.duplicate_facets = count_kind(FacetKind::duplicate);
  if (options.elements) {
    result.elements.degenerate_facets = facets_of_kind(kinds, FacetKind::degenerate);
    result.elements.duplicate_facets = facets_of_kind(kinds, FacetKind::duplicate);
  }
  progress.check();

  {
    const EdgeTable edges(welded);
    progress.check();
    count_edges(edges, defects);
    defects.components = count_components(welded, edges);
    defects.open_loops = count_open_loops(welded, edges);
    progress.check();
    std::vector<std::uint32_t> points = points_with_several_fans(welded, edges);
    defects.non_manifold_points = points.size();
    if (options.elements) {
      list_edges(edges, result.elements);
      result.elements.non_manifold_points = std::move(points);
    }
  }
  progress.check();

  if (options.self_intersections) {
    result.self_intersections = self_intersecting_pairs(welded, progress);
    defects.self_intersecting_pairs = result.self_intersections.size();
    defects.self_intersections_counted = true;
    if (result.self_intersections.size() > options.max_collected_pairs)
      result.self_intersections.resize(options.max_collected_pairs);
    if (defects.closed_manifold() && defects.self_intersecting_pairs == 0)
      defects.misnested_shells = defects.components == 1 ? !(defects.volume > 0) : count_misnested(find_shells(welded));
  }
  return result;
}

std::vector<std::uint32_t> non_manifold_points(const TriangleSoup& welded) {
  return points_with_several_fans(welded, EdgeTable(welded));
}

}  // namespace burnish
