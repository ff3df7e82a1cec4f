// Carrying names and colours over to another surface of the same model: a repaired one has new facets, but what
// was painted or named on the old ones still means the place.
#pragma once

#include <cstdint>
#include <span>

#include "burnish/surface/triangle_index.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Gives each facet of `to` the group and the colour of the facet of `from` that is closest to its centroid: of
// several at the same distance, the one the index meets first. `index_of_from` is the index of the same facets, and
// both soups are in the same units.
//
// The facets of `to` are then reordered: those of a group become one run, runs in the order of `from`, facets
// within a run in the order they had. Groups that got no facet are left out; of groups with equal names each
// stays its own. Points stay as they are. Whatever groups and colours `to` had are replaced.
//
// Nothing happens when `from` has neither groups nor colours, or no facets. The same bits for any number of threads.
// Cost: one query of the index per facet of `to`, 1 to 2 us each near a surface of a million facets; none for one group without colours.
void transfer_attributes(const TriangleSoup& from, const TriangleIndex& index_of_from, TriangleSoup& to);

// The same with what the caller knows already: source_facets[f] is the facet of `from` that facet f of `to` takes
// after, or kNoFacet, for which the index is asked. One entry per facet of `to`.
void transfer_attributes(const TriangleSoup& from, const TriangleIndex& index_of_from, TriangleSoup& to,
                         std::span<const std::uint32_t> source_facets);

}  // namespace burnish
