// Sharpening: an extracted surface takes on the facets, creases and corners of the surface that its field was made from.
//
// A lattice shows nothing that is smaller than a cell: the extracted surface M cuts off convex edges and fills concave ones, by up to half a cell.
// Where the reference surface S is known, no guess is needed:
//
// 1. Every vertex of M gets its closest point on S, on the side that it is seen from.
// 2. An edge of M is *crossed* where the closest facets of its ends are not connected without passing a crease. A vertex close to a crossing
//    becomes a crease vertex, the nearest one to a corner that corner; edges that are still crossed are cut in two there. So the creases run
//    along edges (marching triangles on M).
// 3. All vertices move: to S, to the crease, to the corner. Facets below 15 degrees, and those that the move turned over, are improved: edges that are
//    no creases are flipped, short ones collapsed, vertices slid along S.
// 4. A vertex goes back, half the way, three quarters, then all of it, while a facet at it is turned over or without area.
//
// **Guarantees.** Closed, 2-manifold and oriented like M. A vertex that stays and the edges at it are M's, bit for bit. No facet is turned over
// against the normals of S or M around it; that facets far from each other on M do not meet after moving is likely (vertices move by
// less than a cell, to a surface without intersections) and not certain: Sharpening::settle takes back what does.
//
// **Limits.** Before an edge sharper than about 60 degrees the solid is thinner than a cell for a cell or more, and M itself is torn there: parts of the
// edge are kept as M has them, and may intersect. Strips of S narrower than a cell, and corners closer than two, may lose a corner or their end.
//
// **Accuracy.** Vertices lie on S to rounding where they are not kept; creases are chains of edges between points of S's creases. What is left is
// the chord of S's curvature, kappa l^2 / 8 for edges of length l.
//
// Cost: 0.8 us a facet of M for closest points, 0.4 us more for the shape (measured on 800,000 facets without creases); up to twice that with many creases. Same bits for any number of threads.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/extract/reference_surface.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

struct SharpenOptions {
  double reach = 1;         // cells: vertices farther from S stay where they are (caps, details the lattice did not resolve)
  double crease_reach = 3;  // cells: farther from M no crease is looked for; the tip of a wedge of 20 degrees is 2.8 cells from the last node inside
  bool improve = true;      // of step 3; without it facets that are turned over are taken back only
  // Where a point comes to lie in the file that the result is for, at the precision of its numbers; whatever its units are. Settling looks for intersections
  // there, so that rounding makes no new ones. Keeps orientations up to rounding; called from several threads. Empty: where it is.
  std::function<Vec3(const Vec3&)> written = {};
};

// What a point of the result is.
enum class SharpenedKind : std::uint8_t { smooth, crease, corner };

struct SharpenedSurface {
  TriangleSoup soup;                                  // in lattice coordinates
  std::vector<std::array<std::uint32_t, 2>> parents;  // per point: the vertices of M it stands for. Equal: that vertex; else it is on their edge
  std::vector<SharpenedKind> kind;                    // per point
  std::size_t moved = 0;                              // points on S, its creases and corners
  std::size_t cut = 0;                                // points made by cutting edges, before some were collapsed
  std::size_t kept = 0;                               // points that stay as asked, are out of reach, or were taken back in part or as a whole
};

// `m`: closed, 2-manifold, oriented outwards, in lattice coordinates. `stays`: per vertex of m, 1: it and the edges at it are left alone; empty: none.
// Throws Error{interrupted}.
SharpenedSurface sharpen(const TriangleSoup& m, const ReferenceSurface& s, const std::vector<std::uint8_t>& stays = {},
                         const SharpenOptions& options = {}, Progress& progress = no_progress());

namespace detail {
struct SharpeningState;
}

// The same, and what it has moved can be taken back where the result, as written, meets itself. No closest point is looked up again for that: a round costs what
// looking for intersections around the last changes costs.
class Sharpening {
 public:
  Sharpening(const TriangleSoup& m, const ReferenceSurface& s, const std::vector<std::uint8_t>& stays = {}, const SharpenOptions& options = {},
             Progress& progress = no_progress());
  Sharpening(Sharpening&&) noexcept;
  Sharpening& operator=(Sharpening&&) noexcept;
  ~Sharpening();

  SharpenedSurface surface() const;  // as it is now

  // Takes back, place by place, what intersects, is turned inside out as a whole or lies in another shell as no solid's does, until nothing does:
  // its points half the way to M, three quarters, the whole of it; then what was flipped and collapsed around them; then their neighbours. Returns the
  // vertices of M where that did not help, empty as a rule: set `stays` there. Only points of creases, and those that have moved by more
  // than a fifth of a cell, are suspected at first: inspect the result. At most 24 rounds. Throws Error{interrupted}.
  std::vector<std::uint32_t> settle(Progress& progress = no_progress());

  // All of that at once around these facets of surface(), without any around shells that are misnested; and settles around them. False if all there is
  // as M has it.
  bool take_back(const std::vector<std::uint32_t>& facets, Progress& progress = no_progress());

 private:
  std::unique_ptr<detail::SharpeningState> state_;
};

}  // namespace burnish
