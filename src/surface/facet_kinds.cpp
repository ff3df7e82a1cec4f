#include "facet_kinds.h"

#include <algorithm>

#include "burnish/core/parallel.h"
#include "burnish/surface/edge_table.h"
#include "exact_predicates.h"

namespace burnish {
namespace {

constexpr std::size_t kGrain = 16384;

bool is_degenerate(const TriangleSoup& soup, std::size_t f) {
  return repeats_point(soup.facets[f]) ||
         exactly_collinear(soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2));
}

Facet sorted(Facet f) {
  std::sort(f.begin(), f.end());
  return f;
}

// Proper facets filed under their lowest point (CSR), in the order of the facets.
struct ByLowestPoint {
  std::vector<std::uint32_t> offsets;
  std::vector<std::uint32_t> facets;

  ByLowestPoint(const TriangleSoup& soup, const std::vector<FacetKind>& kinds)
      : offsets(soup.points.size() + 1, 0) {
    const auto for_each_proper = [&](auto&& visit) {
      for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
        if (kinds[f] == FacetKind::proper) visit(f, std::ranges::min(soup.facets[f]));
    };
    for_each_proper([&](std::uint32_t, std::uint32_t lowest) { ++offsets[lowest]; });
    facets.resize(exclusive_scan_in_place(offsets));
    std::vector<std::uint32_t> next = offsets;
    for_each_proper([&](std::uint32_t f, std::uint32_t lowest) { facets[next[lowest]++] = f; });
  }
};

// Marks all but the first of each run of equal facets among `bucket`.
void mark_duplicates(std::vector<std::pair<Facet, std::uint32_t>>& bucket,
                     std::vector<FacetKind>& kinds) {
  std::sort(bucket.begin(), bucket.end());
  for (std::size_t i = 1; i < bucket.size(); ++i)
    if (bucket[i].first == bucket[i - 1].first) kinds[bucket[i].second] = FacetKind::duplicate;
}

}  // namespace

std::vector<FacetKind> facet_kinds(const TriangleSoup& welded) {
  std::vector<FacetKind> kinds(welded.facets.size(), FacetKind::proper);
  parallel_for(
      kinds.size(), [&](std::size_t f) { if (is_degenerate(welded, f)) kinds[f] = FacetKind::degenerate; },
      kGrain);
  const ByLowestPoint filed(welded, kinds);
  parallel_ranges(welded.points.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::pair<Facet, std::uint32_t>> bucket;
    for (std::size_t p = begin; p < end; ++p) {
      bucket.clear();
      for (std::uint32_t i = filed.offsets[p]; i < filed.offsets[p + 1]; ++i)
        bucket.emplace_back(sorted(welded.facets[filed.facets[i]]), filed.facets[i]);
      mark_duplicates(bucket, kinds);
    }
  });
  return kinds;
}

}  // namespace burnish
