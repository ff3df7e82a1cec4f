#include "burnish/surface/edge_table.h"

#include <algorithm>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

// A use still waiting in the bucket of its edge's lower point.
struct Filed {
  std::uint32_t upper;
  EdgeUse use;
};

template <class Visit>
void for_each_side(const Facet& facet, Visit&& visit) {
  if (repeats_point(facet)) return;
  for (std::uint8_t side = 0; side < 3; ++side) {
    const std::uint32_t from = facet[side];
    const std::uint32_t to = facet[side == 2 ? 0 : side + 1u];
    visit(std::min(from, to), std::max(from, to), side, from < to);
  }
}

// Where the bucket of each point begins; one entry more for the end of the last.
std::vector<std::uint32_t> bucket_offsets(const TriangleSoup& soup) {
  std::vector<std::uint32_t> offsets(soup.points.size() + 1, 0);
  for (const Facet& facet : soup.facets)
    for_each_side(facet, [&](std::uint32_t lower, std::uint32_t, std::uint8_t, bool) { ++offsets[lower]; });
  exclusive_scan_in_place(offsets);
  return offsets;
}

std::vector<Filed> file_by_lower_point(const TriangleSoup& soup, std::vector<std::uint32_t> next,
                                       std::size_t count) {
  std::vector<Filed> filed(count);
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    for_each_side(soup.facets[f], [&](std::uint32_t lower, std::uint32_t upper, std::uint8_t side, bool fwd) {
      filed[next[lower]++] = {upper, {f, side, fwd}};
    });
  return filed;
}

void sort_buckets(std::vector<Filed>& filed, const std::vector<std::uint32_t>& offsets) {
  constexpr std::size_t kGrain = 16384;
  parallel_for(
      offsets.size() - 1,
      [&](std::size_t p) {
        std::sort(filed.begin() + offsets[p], filed.begin() + offsets[p + 1],
                  [](const Filed& a, const Filed& b) {
                    return a.upper != b.upper ? a.upper < b.upper : a.use.facet < b.use.facet;
                  });
      },
      kGrain);
}

}  // namespace

EdgeTable::EdgeTable(const TriangleSoup& welded) : facet_count_(welded.facets.size()) {
  const std::vector<std::uint32_t> offsets = bucket_offsets(welded);
  std::vector<Filed> filed = file_by_lower_point(welded, offsets, offsets.back());
  sort_buckets(filed, offsets);

  uses_.reserve(filed.size());
  edges_.reserve(filed.size() / 2 + 1);
  first_use_.reserve(filed.size() / 2 + 2);
  for (std::uint32_t p = 0; p + 1 < offsets.size(); ++p) {
    for (std::uint32_t i = offsets[p]; i < offsets[p + 1]; ++i) {
      if (i == offsets[p] || filed[i].upper != filed[i - 1].upper) {
        edges_.push_back({p, filed[i].upper});
        first_use_.push_back(i);
      }
      uses_.push_back(filed[i].use);
    }
  }
  first_use_.push_back(static_cast<std::uint32_t>(filed.size()));
}

std::vector<std::array<std::uint32_t, 3>> EdgeTable::edges_of_facets() const {
  std::vector<std::array<std::uint32_t, 3>> result(facet_count_, {kNoEdge, kNoEdge, kNoEdge});
  for (std::uint32_t e = 0; e < size(); ++e)
    for (const EdgeUse& use : uses(e)) result[use.facet][use.side] = e;
  return result;
}

}  // namespace burnish
