#include "prepare_input.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>
#include <vector>

#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/weld.h"

namespace burnish {
namespace {

constexpr double kUnmatchedShare = 0.05;  // of the edges, beyond which open edges are welded within a tolerance
constexpr double kWeldShare = 0.1;        // of the median edge: that tolerance
constexpr double kSheetCapShare = 0.75;   // caps larger than this part of the input's area
constexpr double kSheetRoundness = 0.05;  // and whose solid is flat by this measure are sheets
constexpr double kFlatRoundness = 1e-7;   // below this there is nothing inside

double median_edge(const TriangleSoup& soup) {
  std::vector<double> lengths;
  lengths.reserve(soup.facets.size() * 3);
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (int i = 0; i < 3; ++i) lengths.push_back(norm(soup.corner(f, (i + 1) % 3) - soup.corner(f, i)));
  if (lengths.empty()) return 0;
  const auto middle = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 2);
  std::nth_element(lengths.begin(), middle, lengths.end());
  return *middle;
}

double open_share(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  std::size_t open = 0;
  for (std::size_t e = 0; e < table.size(); ++e) open += table.is_open(e);
  return table.size() ? static_cast<double>(open) / static_cast<double>(table.size()) : 0;
}

// 36 pi V^2 / A^3: 1 for a ball, 0 for what is flat. [T-SHEET-1]
double isoperimetric_quotient(const TriangleSoup& soup) {
  const double a = area(soup), v = signed_volume(soup);
  return a > 0 ? 36 * std::numbers::pi * v * v / (a * a * a) : 0;
}

TriangleSoup drop_useless_facets(const TriangleSoup& soup, RepairActions& actions) {
  CleanedFacets cleaned = drop_degenerate_and_duplicate_facets(soup);
  actions.degenerate_facets_dropped += cleaned.degenerate;
  actions.duplicate_facets_dropped += cleaned.duplicate;
  return std::move(cleaned.soup);
}

}  // namespace

TriangleSoup prepare_input(const TriangleSoup& welded, RepairActions& actions) {
  TriangleSoup soup = drop_useless_facets(welded, actions);
  // [T-WELD-2]
  if (open_share(soup) > kUnmatchedShare) {
    const double tolerance = kWeldShare * median_edge(soup);
    WeldedNear near = weld_boundaries(soup, tolerance);
    if (near.points_moved > 0) {
      actions.points_welded_within_tolerance = near.points_moved;
      actions.weld_tolerance = tolerance;
      soup = drop_useless_facets(near.soup, actions);
    }
  }
  OrientedSoup oriented = orient(soup);
  actions.facets_flipped = oriented.facets_flipped;
  CappedSoup capped = cap_boundary(oriented.soup);
  actions.open_loops_capped = capped.loops;
  actions.cap_area = capped.cap_area;
  return std::move(capped.soup);
}

std::optional<Error> reason_for_no_solid(const TriangleSoup& welded, const TriangleSoup& prepared, const Defects& before,
                                         const RepairActions& actions) {
  const double input_area = area(welded);
  if (prepared.facets.empty() || input_area <= 0)
    return Error(ErrorCode::guarantee_unmet, fmt::format("no solid: none of the {} facets has an area", welded.facets.size()),
                 "re-export the model; every facet in this file is a line or a point");
  const double roundness = isoperimetric_quotient(prepared);
  if (actions.cap_area > kSheetCapShare * input_area && roundness < kSheetRoundness)
    return Error(ErrorCode::guarantee_unmet,
                 fmt::format("no solid: an open sheet; its {} open edges in {} loops would need caps of {:.0f} % of the input's area",
                             before.open_edges, before.open_loops, 100 * actions.cap_area / input_area),
                 "close the model, or give the sheet a thickness, before cleaning it as a solid");
  if (roundness < kFlatRoundness)
    return Error(ErrorCode::guarantee_unmet,
                 fmt::format("no solid: the surface encloses a volume of {:.3g} with an area of {:.3g}: it is flat, or its parts cancel",
                             std::abs(signed_volume(prepared)), input_area),
                 "give the sheet a thickness, or check that the facets' orientation is consistent");
  return std::nullopt;
}

}  // namespace burnish
