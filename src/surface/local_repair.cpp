#include "burnish/surface/local_repair.h"

#include <fmt/format.h>

#include <algorithm>
#include <stdexcept>
#include <utility>

#include "burnish/surface/edge_table.h"
#include "burnish/surface/facet_filter.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/solid_union.h"
#include "burnish/surface/weld.h"
#include "burnish/surface/winding.h"
#include "mend_mesh.h"
#include "point_table.h"

namespace burnish {
namespace {

constexpr std::size_t kMostPairs = 200'000;   // of facets that intersect: more is no matter of single facets
constexpr int kUnionRounds = 5;

// What goes from step to step: the soup so far, and what its facets are to the input.
struct Progressed {
  LocalRepairResult result;
  std::size_t pairs = 0;  // found so far

  // Takes a step whose sources are facets of the soup so far.
  void take(LocalRepairResult step) {
    for (std::size_t f = 0; f < step.parent.size(); ++f) step.fills_hole[f] = result.fills_hole[step.parent[f]];
    step.parent.clear();
    for (std::size_t f = 0; f < step.source.size(); ++f) {
      std::uint32_t& source = step.source[f];
      if (source == kNoFacet) continue;
      step.fills_hole[f] = step.fills_hole[f] || result.fills_hole[source];
      source = result.source[source];
    }
    // Holes that stay are found by every step.
    std::erase_if(result.holes, [](const Hole& hole) { return !hole.filled; });
    step.holes.insert(step.holes.begin(), result.holes.begin(), result.holes.end());
    step.needles_flipped += result.needles_flipped;
    step.points_split += result.points_split;
    step.largest_split = std::max(step.largest_split, result.largest_split);
    step.tangled_removed += result.tangled_removed;
    step.facets_cut += result.facets_cut;
    result = std::move(step);
  }

  // Rounds the points that are not the input's. What becomes a line or a point that way is left out. False if
  // there was nothing to round.
  bool round_new_points(const PointTable& known) {
    bool moved = false;
    for (Vec3& p : result.soup.points) {
      const Vec3 r{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      if (r == p || known.find(p) != PointTable::kFree) continue;
      p = r;
      moved = true;
    }
    if (!moved) return false;
    FilteredFacets kept = filter_facets(weld(std::move(result.soup)), true);
    for (std::uint32_t f = 0; f < kept.source.size(); ++f) {
      result.source[f] = result.source[kept.source[f]];
      result.fills_hole[f] = result.fills_hole[kept.source[f]];
    }
    result.source.resize(kept.source.size());
    result.fills_hole.resize(kept.source.size());
    result.soup = std::move(kept.soup);
    return true;
  }
};

PointTable points_of(const TriangleSoup& soup) {
  PointTable table(soup.points.size());
  for (const Vec3& p : soup.points) table.insert(p);
  return table;
}

bool has_non_manifold_edges(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  for (std::size_t e = 0; e < table.size(); ++e)
    if (table.is_non_manifold(e)) return true;
  return false;
}

LocalRepairResult as_it_is(const TriangleSoup& soup) {
  LocalRepairResult result;
  result.soup = soup;
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f) result.source.push_back(f);
  result.fills_hole.assign(soup.facets.size(), 0);
  return result;
}

LocalRepairResult united(const TriangleSoup& soup, const Pairs& pairs, Progress& progress) {
  if (pairs.size() > kMostPairs) throw Refusal{fmt::format("{} pairs of facets intersect", pairs.size())};
  // Needles bound nothing; what they join is cut where they touch it.
  const FilteredFacets proper = filter_facets(soup, false, false);
  SolidUnion solid = unite(proper.soup, proper.source.size() == soup.facets.size() ? pairs : self_intersecting_pairs(proper.soup, progress), progress);
  for (auto* list : {&solid.source, &solid.parent})
    for (std::uint32_t& f : *list)
      if (f != kNoFacet) f = proper.source[f];
  LocalRepairResult result;
  result.soup = std::move(solid.soup);
  result.source = std::move(solid.source);
  result.parent = std::move(solid.parent);
  result.fills_hole.assign(result.source.size(), 0);
  result.facets_cut = solid.facets_cut;
  return result;
}

// Unites what overlaps until nothing intersects: rounding can make facets meet that did not. Where that does not end, or the
// surface is open, what intersects is cut out. A closed chain that is no manifold is united before its points are doubled.
LocalRepairResult repair(const TriangleSoup& oriented, const LocalRepairOptions& options, Progress& progress) {
  const PointTable known = points_of(oriented);
  Progressed state{as_it_is(oriented)};
  bool mended = !is_closed_chain(oriented) || !has_non_manifold_edges(oriented);
  if (mended || !options.resolve_intersections) state.take(mend(oriented, options, progress));
  if (!options.resolve_intersections) return std::move(state.result);
  for (int round = 0; round <= kUnionRounds; ++round) {
    if (options.float32 && state.round_new_points(known)) mended = false;
    const Pairs pairs = self_intersecting_pairs(state.result.soup, progress);
    if (round == 0) state.pairs = pairs.size();
    if (!pairs.empty()) {
      if (round == kUnionRounds || !is_closed_chain(state.result.soup)) {
        state.take(mend_and_cut_out(state.result.soup, options, progress));
        break;
      }
      state.take(united(state.result.soup, pairs, progress));
      if (options.float32) state.round_new_points(known);
      mended = false;
    }
    if (!mended) state.take(mend(state.result.soup, options, progress));
    if (pairs.empty()) break;
    mended = true;
  }
  state.result.intersecting_pairs_removed = state.pairs;
  return std::move(state.result);
}

}  // namespace

LocalRepairResult repair_locally(const TriangleSoup& oriented, const LocalRepairOptions& options, Progress& progress) {
  LocalRepairResult refused;
  try {
    return repair(oriented, options, progress);
  } catch (const Refusal& refusal) {
    refused.refusal = refusal.why;
  } catch (const std::logic_error&) {  // of CGAL, by the union
    refused.refusal = "overlapping bodies are too broken to be united";
  }
  return refused;
}

}  // namespace burnish
