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
#include "mend_mesh.h"
#include "point_table.h"

namespace burnish {
namespace {

constexpr std::size_t kMostPairs = 200'000;   // of facets that intersect: more is no matter of single facets
constexpr int kUnionRounds = 5;

bool is_closed(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  for (std::size_t e = 0; e < table.size(); ++e)
    if (table.is_open(e)) return false;
  return true;
}

// What goes from step to step: the soup so far, and what its facets are to the input.
struct Progressed {
  LocalRepairResult result;
  std::size_t pairs = 0;  // found so far

  // Takes a step whose sources are facets of the soup so far.
  void take(LocalRepairResult step) {
    for (std::size_t f = 0; f < step.source.size(); ++f) {
      std::uint32_t& source = step.source[f];
      if (source == kNoFacet) continue;
      step.fills_hole[f] = step.fills_hole[f] || result.fills_hole[source];
      source = result.source[source];
    }
    step.holes.insert(step.holes.begin(), result.holes.begin(), result.holes.end());
    step.needles_flipped += result.needles_flipped;
    step.points_split += result.points_split;
    step.largest_split = std::max(step.largest_split, result.largest_split);
    step.tangled_removed += result.tangled_removed;
    step.facets_cut += result.facets_cut;
    result = std::move(step);
  }

  // Rounds the points that are not the input's. What becomes a line or a point that way is left out.
  void round_new_points(const PointTable& known) {
    bool moved = false;
    for (Vec3& p : result.soup.points) {
      const Vec3 r{static_cast<float>(p.x), static_cast<float>(p.y), static_cast<float>(p.z)};
      if (r == p || known.find(p) != PointTable::kFree) continue;
      p = r;
      moved = true;
    }
    if (!moved) return;
    FilteredFacets kept = filter_facets(weld(std::move(result.soup)), true);
    for (std::uint32_t f = 0; f < kept.source.size(); ++f) {
      result.source[f] = result.source[kept.source[f]];
      result.fills_hole[f] = result.fills_hole[kept.source[f]];
    }
    result.source.resize(kept.source.size());
    result.fills_hole.resize(kept.source.size());
    result.soup = std::move(kept.soup);
  }
};

PointTable points_of(const TriangleSoup& soup) {
  PointTable table(soup.points.size());
  for (const Vec3& p : soup.points) table.insert(p);
  return table;
}

// Unites what overlaps until nothing intersects: rounding can make facets meet that did not. Where that does not end, or the
// surface is open, what intersects is cut out.
LocalRepairResult repair(const TriangleSoup& oriented, const LocalRepairOptions& options, Progress& progress) {
  const PointTable known = points_of(oriented);
  Progressed state{mend(oriented, options, progress)};
  for (int round = 0;; ++round) {
    if (options.float32) state.round_new_points(known);
    const Pairs pairs = self_intersecting_pairs(state.result.soup, progress);
    if (pairs.empty() && round == 0) return std::move(state.result);
    if (pairs.empty()) break;
    if (round == 0) state.pairs = pairs.size();
    if (pairs.size() > kMostPairs) throw Refusal{fmt::format("{} pairs of facets intersect", pairs.size())};
    if (round == kUnionRounds || !is_closed(state.result.soup)) {
      state.take(mend_and_cut_out(state.result.soup, options, progress));
      break;
    }
    const SolidUnion united = unite(state.result.soup, pairs, progress);
    LocalRepairResult step;
    step.soup = united.soup;
    step.source = united.source;
    for (const std::uint32_t f : united.parent) step.fills_hole.push_back(state.result.fills_hole[f]);
    step.facets_cut = united.facets_cut;
    state.take(std::move(step));
    if (options.float32) state.round_new_points(known);
    state.take(mend(state.result.soup, options, progress));
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
