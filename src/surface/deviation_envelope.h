// How far a mesh may leave the surface it was made from, watched while its edges collapse. Private to src/surface.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "burnish/surface/triangle_index.h"
#include "burnish/surface/triangle_soup.h"
#include "collapsible_mesh.h"

namespace burnish {

// Each point of the given surface, and the middle of each edge that sticks out by more than a share of the deviation, belongs to a facet of the mesh that is within the deviation of it: when a collapse replaces facets, their points
// go to the nearest of the new ones, and where one is too far from all of them the collapse is refused. The other way round, the new point and
// middles of the new edges and facets ask the given surface. [T-SIMP-4]
class DeviationEnvelope {
 public:
  // Shares of the deviation: collapses keep to the first; the rest is for what is between the places that are looked at.
  static constexpr double kShare = 0.85;

  // `index`: of the given surface; must outlive the object.
  DeviationEnvelope(const TriangleSoup& given, const TriangleIndex& index, double deviation);

  // Whether h may collapse to `to` within this share of the deviation. Remembers what `accept` needs.
  bool admits(const CollapsibleMesh& mesh, std::uint32_t h, const Vec3& to, double share);
  // The collapse that was asked for last has happened.
  void accept();

 private:
  struct NewFacet {
    std::uint32_t facet;
    std::array<Vec3, 3> corners;  // the new point first
    Vec3 center;                  // of a ball that holds it
    double radius;
  };
  void gather(const CollapsibleMesh& mesh, std::uint32_t v, std::uint32_t other, const Vec3& to);
  bool near_given(const Vec3& p) const;
  bool hold_points();

  void track(const Vec3& p, std::uint32_t facet);
  void track_bent_edges(const TriangleSoup& given);

  std::vector<Vec3> points_;          // that belong to facets
  const TriangleIndex& index_;
  double deviation_;
  double squared_ = 0;                // of the share that is asked for
  std::vector<std::uint32_t> first_;  // point of each facet's list
  std::vector<std::uint32_t> next_;   // of each point, in its facet's list
  std::vector<NewFacet> facets_;
  std::vector<std::uint32_t> old_facets_;
  std::vector<std::array<std::uint32_t, 2>> homes_;  // point, new facet
};

}  // namespace burnish
