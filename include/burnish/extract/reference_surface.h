// ReferenceSurface: the surface that an extracted one is to lie on, with its creases.
//
// An extracted surface knows its field at nodes alone, and cuts off what is sharp. The facets that the field was made from know
// better. They are looked up here: the closest point that faces the same way, the closest point of the creases, and whether two places are
// on the same *sheet*, i.e. connected by facets without passing a crease.
//
//   const ReferenceSurface s(to_lattice(solid, frame), find_creases(to_lattice(solid, frame)));
//   const ReferenceSurface::Foot foot = s.closest(vertex, 1.0, normal);
#pragma once

#include <array>
#include <cstdint>
#include <limits>
#include <vector>

#include "burnish/surface/creases.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

class ReferenceSurface {
 public:
  // `surface`: welded and oriented outwards, in lattice coordinates. It may have open and non-manifold edges, copies, intersections.
  // `creases`: of that soup. About a second per million facets.
  ReferenceSurface(TriangleSoup surface, Creases creases);

  const TriangleSoup& soup() const { return soup_; }
  const Creases& creases() const { return creases_; }
  bool has_creases() const { return !creases_.empty(); }
  // Unit length; zero of a facet without area.
  const Vec3& normal(std::uint32_t facet) const { return normals_[facet]; }
  // The number of the facet's sheet: the facets that can be reached from it without passing a crease, however long the way. With creases only.
  std::uint32_t sheet(std::uint32_t facet) const { return sheet_.empty() ? 0 : sheet_[facet]; }

  struct Foot {
    Vec3 point;
    double squared_distance = std::numeric_limits<double>::infinity();
    std::uint32_t facet = kNoFacet;  // of the surface, or the number of the crease edge
    bool found() const { return facet != kNoFacet; }
  };
  // The closest point within a distance whose facet does not turn its back to `facing`, a unit vector: their angle is below 107 degrees
  // (the tip of a wedge is seen from both of its faces, a wall from one). A facet without area faces every way. `hint`, a facet that
  // may be near, only saves time. 1 us where hints are good.
  Foot closest(const Vec3& p, double within, const Vec3& facing, std::uint32_t hint = kNoFacet) const;
  // The closest such point on the sheet of facet f.
  Foot closest_on_sheet(const Vec3& p, double within, const Vec3& facing, std::uint32_t f) const;

  // The closest point of any crease. `hint`, a crease edge that may be near, only saves time.
  Foot closest_on_creases(const Vec3& p, double within, std::uint32_t hint = kNoFacet) const;
  // Whether there is any within the distance; `hint` as above, and set to the edge that was found.
  bool is_near_creases(const Vec3& p, double within, std::uint32_t& hint) const;
  // That of a crease between the sheets of facets f and g, if one is within the distance; else of one that bounds the sheet with the lower
  // number (so that all who ask for two sheets that do not meet get the same one), else of any. `hint` as above.
  Foot closest_between(const Vec3& p, double within, std::uint32_t f, std::uint32_t g, std::uint32_t hint = kNoFacet) const;

  // Whether a crease lies between the sheets of f and g.
  bool parts(std::uint32_t crease_edge, std::uint32_t f, std::uint32_t g) const { return sheets_at_crease_[crease_edge] == sheets_of(f, g); }
  // Sheets that meet at a corner (of creases().corners), and whether that of a facet is one of them.
  std::size_t sheets_at_corner(std::size_t corner) const { return sheets_at_corner_[corner].size(); }
  bool sheet_meets_corner(std::uint32_t facet, std::size_t corner) const;

  // Whether a path over facets leads from f to g within the ball, across edges that are no creases. Always true for f == g.
  // Looks at 4096 facets at most; beyond that the answer is yes.
  bool connected(std::uint32_t f, std::uint32_t g, const Vec3& centre, double radius) const;

 private:
  void link_facets();
  void list_sheets_at_corners();
  void list_sheets_at_creases();
  double squared_distance_to_crease(const Vec3& p, std::uint32_t edge) const;
  static Edge ascending(std::uint32_t a, std::uint32_t b) { return a < b ? Edge{a, b} : Edge{b, a}; }
  Edge sheets_of(std::uint32_t f, std::uint32_t g) const { return ascending(sheet_[f], sheet_[g]); }

  TriangleSoup soup_;
  Creases creases_;
  std::vector<Vec3> normals_;
  TriangleIndex index_;
  TriangleSoup crease_edges_;  // folded to triangles {a, b, b}
  TriangleIndex crease_index_;
  // With creases only: the facet across each side, kNoFacet at creases and where not two facets meet; and the sheets in the whole.
  std::vector<std::array<std::uint32_t, 3>> across_;
  std::vector<std::uint32_t> sheet_;
  std::vector<std::vector<std::uint32_t>> sheets_at_corner_;  // ascending
  std::vector<Edge> sheets_at_crease_;                        // per crease edge, lower one first
  std::vector<Edge> meeting_sheets_;                          // of all crease edges, ascending, each once
};

}  // namespace burnish
