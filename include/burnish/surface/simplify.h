// Simplification: fewer facets for the same surface, by edge collapses in the order of quadric errors.
//
// Guarantees, of every result:
//
//   1. A closed 2-manifold stays one, with the same genus and shells; a sheet keeps its borders. No two facets intersect and none is degenerate:
//      looked at with exact predicates (`inspect`), not hoped for. Where collapses went wrong, all is done again and those places stay finer.
//   2. Creases (`find_creases`) and borders stay chains of edges. Chains are thinned along their way; their corners stay bit for bit. Only where
//      the asked count cannot be reached so, sharper ones alone are kept: `SimplifiedSurface::crease_angle`; of all results within the deviation,
//      the one with the fewest facets counts, of equal ones the first. Short ones with a free end are noise: below 4 mean
//      edges, or 2 of the result's.
//   3. With `deviation`: every point of the given soup has the result within it (tracked through all collapses), and in the end `verified_samples` of each
//      surface, its points and places spread over its area, were found to have the other one within it. Between samples nothing is proved.
//   4. Same bits for any number of threads and on every run, and for the soup multiplied by a power of two.
//
// Accuracy: quadrics sum areas times squared distances, so that the rms distance is what is kept small: it falls with order 2 in the edge length
// on smooth surfaces. Method: Garland & Heckbert 1997, areas as weights, planes upright on creases and borders; the points of the given surface are
// handed from facet to facet as in Ciampalini et al. 1997.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "burnish/core/progress.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct SimplifyOptions {
  // Stop at this many facets: exactly, or one fewer or more. Not given: go on as far as `deviation` allows.
  std::optional<std::size_t> facets{};
  // The largest distance between both surfaces, both ways, in the soup's units. Stronger than `facets`.
  std::optional<double> deviation{};
  // Degrees between normals: sharper edges are creases.
  double crease_angle = 40;
  // Degrees: no collapse makes an angle smaller than this, or smaller than those that are around it already.
  double least_angle = 1;
};

struct SimplifiedSurface {
  TriangleSoup soup;             // welded; points in the order of the given ones; no groups, no colours
  std::size_t collapsed = 0;     // edges
  bool reached = false;          // the asked count. Without one: true
  double crease_angle = 0;       // degrees: edges that were sharper stayed. That of the options, unless these left no room for `facets`; 180: none
  std::string why_not;           // one sentence if not reached, or if nothing could be done
  Deviation deviation;           // measured at samples and points
  std::size_t verified_samples = 0;  // of each surface, for `deviation`
  int rounds = 0;                // until all of it was valid: 1 as a rule, 0 if nothing could be done
  std::size_t held_points = 0;   // of the given surface, where collapses were held back after the first round
};

// Simplifies a surface that is valid: 2-manifold, consistently oriented, without self-intersections; closed or not. If no valid result is
// found in kSimplifyRounds rounds with the creases of the asked angle, the given surface is the result and `why_not` tells.
// Throws Error{guarantee_unmet} if the soup is no oriented 2-manifold, Error{usage} for a deviation that is negative or not a number.
// Cost: about 10 us for each facet that goes, 40 us with `deviation`, and as much again for each further round and
// each of up to three angles at which creases are given up; on one thread. Memory: 500 bytes a facet.
SimplifiedSurface simplify(const TriangleSoup& manifold, const SimplifyOptions& options, Progress& progress = no_progress());

inline constexpr int kSimplifyRounds = 8;

}  // namespace burnish
