// A mesh whose facets change a few at a time: neighbours, qualities, and the three changes.
#pragma once

#include <algorithm>
#include <array>
#include <span>
#include <utility>
#include <vector>

#include "sharpen_mesh.h"

namespace burnish::detail {

inline constexpr double kPoor = 0.2588190451025208;  // sin 15 degrees

// Facets that are gone are {0, 0, 0}. Only what has changed is kept apart from the mesh's own arrays.
class Patch {
 public:
  Patch(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s);

  const SharpenMesh& mesh() const { return mesh_; }
  const Facet& facet(std::uint32_t f) const { return mesh_.facets[f]; }
  const Vec3& point(std::uint32_t v) const { return points_[v]; }
  bool is_alive(std::uint32_t f) const { return facet(f)[0] != facet(f)[1]; }
  bool has(std::uint32_t f, std::uint32_t v) const { return facet(f)[0] == v || facet(f)[1] == v || facet(f)[2] == v; }
  bool is_frozen(std::uint32_t f) const { return mesh_.has_fixed_corner(facet(f)); }
  std::span<const std::uint32_t> facets_at(std::uint32_t v) const;
  bool is_ring_frozen(std::uint32_t v) const;
  bool are_linked(std::uint32_t p, std::uint32_t q) const;
  // The vertex that follows v in a facet; the third one of a facet with p and q.
  std::uint32_t after(std::uint32_t f, std::uint32_t v) const;
  std::uint32_t opposite(std::uint32_t f, std::uint32_t p, std::uint32_t q) const;
  // The first vertex of a facet that is on no crease and does not stay; kNoFacet if there is none.
  std::uint32_t smooth_vertex(std::uint32_t f) const;
  // The facet that runs from p to q, and the one that runs back; kNoFacet twice unless there are both.
  std::array<std::uint32_t, 2> facets_at_edge(std::uint32_t p, std::uint32_t q) const;
  // Whether the surface stays a 2-manifold: p and q have two common neighbours, those of their facets (link condition).
  bool may_collapse(std::uint32_t p, std::uint32_t q) const;

  // What a facet should face: S's normal at its smooth vertices, else what it was made with.
  Vec3 facing(std::uint32_t f) const;
  Vec3 facing_when(const Facet& c, const Vec3& otherwise) const;
  // The sine of the least angle, less where a facet does not face what it should, -1 if it is turned over.
  double quality(std::uint32_t f) const { return quality(facet(f), facing(f)); }
  double quality(const Facet& c, const Vec3& facing) const { return quality(point(c[0]), point(c[1]), point(c[2]), facing); }
  // The same with vertex v elsewhere.
  double quality_when(const Facet& c, std::uint32_t v, const Vec3& at, const Vec3& facing) const;

  std::vector<std::uint32_t> all_poor_facets() const;
  // Those of the facets, ascending and each once.
  std::vector<std::uint32_t> poor_facets_of(std::vector<std::uint32_t> facets) const;
  void sort_worst_first(std::vector<std::uint32_t>& facets) const;

  void flip(std::uint32_t p, std::uint32_t q);
  void collapse(std::uint32_t p, std::uint32_t q);
  void slide(std::uint32_t p, const Vec3& to, std::uint32_t sheet);

 private:
  static double quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& facing);
  void find_facings_between_creases();
  std::vector<std::uint32_t> poor_of(const std::vector<std::uint32_t>& facets) const;
  std::vector<std::uint32_t>& own_list(std::uint32_t v);
  void set_facing(std::uint32_t f, const Vec3& facing);
  void keep_facing(std::uint32_t f);

  static constexpr std::uint32_t kNone = kNoFacet;

  SharpenMesh& mesh_;
  std::vector<Vec3>& points_;
  UnionFind& edits_;
  const ReferenceSurface& s_;
  FacetsAround around_;
  // What differs from `around_`, and the facing of facets without smooth vertices; the first two say where: kNone for most.
  std::vector<std::uint32_t> list_of_, facing_of_;  // per vertex; per facet
  std::vector<std::vector<std::uint32_t>> lists_;   // facets, ascending
  std::vector<Vec3> facings_;
};

}  // namespace burnish::detail
