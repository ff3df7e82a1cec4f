#include "burnish/surface/transfer.h"

#include <algorithm>
#include <cassert>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

bool has_attributes(const TriangleSoup& soup) {
  return !soup.facets.empty() && !(soup.groups.empty() && soup.colors.empty());
}

std::vector<std::uint32_t> closest_facets(const TriangleIndex& index, const TriangleSoup& to,
                                          std::span<const std::uint32_t> known) {
  std::vector<std::uint32_t> sources(to.facets.size(), kNoFacet);
  parallel_for(to.facets.size(), [&](std::size_t f) {
    if (!known.empty()) sources[f] = known[f];
    if (sources[f] == kNoFacet)
      sources[f] = index.closest((to.corner(f, 0) + to.corner(f, 1) + to.corner(f, 2)) / 3.0).facet;
    if (sources[f] == kNoFacet) sources[f] = 0;  // so far away that its square overflows
  });
  return sources;
}

// The number of the group that holds a facet. Groups cover all facets; of several that begin at the same
// facet only the last has any.
std::uint32_t group_of(const std::vector<FacetGroup>& groups, std::uint32_t facet) {
  const auto behind =
      std::upper_bound(groups.begin(), groups.end(), facet,
                       [](std::uint32_t f, const FacetGroup& g) { return f < g.first_facet; });
  assert(behind != groups.begin());
  return static_cast<std::uint32_t>(behind - groups.begin() - 1);
}

// Sorts the facets of `to`, and `sources` with them, by the group of their source, and names the runs.
void sort_into_groups(const std::vector<FacetGroup>& groups, TriangleSoup& to,
                      std::vector<std::uint32_t>& sources) {
  const std::size_t n = to.facets.size();
  std::vector<std::uint32_t> group(n), next(groups.size() + 1, 0);
  parallel_for(n, [&](std::size_t f) { group[f] = group_of(groups, sources[f]); });
  for (const std::uint32_t g : group) ++next[g];
  exclusive_scan_in_place(next);
  for (std::size_t g = 0; g < groups.size(); ++g)
    if (next[g + 1] > next[g]) to.groups.push_back({groups[g].name, next[g], next[g + 1] - next[g]});
  std::vector<Facet> facets(n);
  std::vector<std::uint32_t> sorted(n);
  for (std::size_t f = 0; f < n; ++f) {
    const std::uint32_t place = next[group[f]]++;
    facets[place] = to.facets[f];
    sorted[place] = sources[f];
  }
  to.facets = std::move(facets);
  sources = std::move(sorted);
}

}  // namespace

void transfer_attributes(const TriangleSoup& from, const TriangleIndex& index_of_from, TriangleSoup& to,
                         std::span<const std::uint32_t> source_facets) {
  if (!has_attributes(from)) return;
  assert(source_facets.empty() || source_facets.size() == to.facets.size());
  // One name is that of all facets, wherever they are.
  const bool all_alike = from.colors.empty() && from.groups.size() == 1;
  std::vector<std::uint32_t> sources = all_alike ? std::vector<std::uint32_t>(to.facets.size(), 0) : closest_facets(index_of_from, to, source_facets);
  to.groups.clear();
  to.colors.clear();
  if (!from.groups.empty()) sort_into_groups(from.groups, to, sources);
  if (from.colors.empty()) return;
  to.colors.resize(to.facets.size());
  parallel_for(to.facets.size(), [&](std::size_t f) { to.colors[f] = from.colors[sources[f]]; });
}

void transfer_attributes(const TriangleSoup& from, const TriangleIndex& index_of_from, TriangleSoup& to) {
  transfer_attributes(from, index_of_from, to, {});
}

}  // namespace burnish
