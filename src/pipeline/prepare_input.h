// From a welded soup to oriented, useful facets, and the closed chain they belong to; or the reason why there is no
// solid in it.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <string_view>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/pipeline/options.h"
#include "burnish/pipeline/report.h"
#include "burnish/surface/boundary_caps.h"
#include "burnish/surface/shells.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// What a facet of the input is to the repair.
enum class FacetFate : std::uint8_t {
  used,
  useless,   // repeats a point, a copy, a wall between two bodies
  absorbed,  // of a component inside the solid
  sheet,     // of a component without thickness
  nothing,   // of a component that encloses nothing: the solid is on neither of its sides
  dropped,   // of a component that is not wanted
  fragment,  // of a stray fragment, dirt beside the model
};

// The reason as reports have it; empty for `used`.
std::string_view reason(FacetFate fate);

struct PreparedInput {
  TriangleSoup oriented;               // welded; facets without an area stay, they close what they close
  std::vector<std::uint32_t> source;   // facet of the input behind each of its facets
  std::vector<FacetFate> fates;        // of the input's facets
  CappedSoup capped;                   // `oriented` with a cap on every loop
  Shells shells;                       // of the capped soup
  std::vector<FacetFate> shell_fates;  // used; absorbed, or nothing, for shells that touch no other and bound no solid
  bool bodies_overlap = false;         // facets of different shells intersect
};

// Facet pairs of the welded input that intersect.
using FacetPairs = std::vector<std::array<std::uint32_t, 2>>;

// Leaves out useless facets, joins points of open edges (within `gap` if it is set; else within a tolerance if too many
// edges stay unmatched), orients facets and shells as `options.nesting` says, drops components that are not wanted,
// caps. Says what it did in report.actions and report.components.
PreparedInput prepare_input(const TriangleSoup& welded, const FacetPairs& intersecting, const CleanOptions& options,
                            RepairReport& report);

// Tells the loops of the prepared input as report.holes, the largest first.
void tell_holes(const PreparedInput& prepared, RepairReport& report);

// Why the prepared soup bounds no solid: nothing with an area, or openings too large for a cap to be more than a guess.
std::optional<Error> reason_for_no_solid(const TriangleSoup& welded, const PreparedInput& prepared, const Defects& before);

}  // namespace burnish
