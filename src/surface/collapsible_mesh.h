// A triangle mesh whose edges can be collapsed. Private to src/surface.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// Half-edge h = 3 f + i runs from corner i of facet f to the next one, as EdgeUse's side i. A 2-manifold, with borders or without.
class CollapsibleMesh {
 public:
  static constexpr std::uint32_t kNone = 0xffffffffu;

  // Throws Error{guarantee_unmet} if the soup is no consistently oriented 2-manifold.
  explicit CollapsibleMesh(const TriangleSoup& welded);

  static std::uint32_t next(std::uint32_t h) { return h % 3 == 2 ? h - 2 : h + 1; }
  static std::uint32_t previous(std::uint32_t h) { return h % 3 == 0 ? h + 2 : h - 1; }
  std::uint32_t origin(std::uint32_t h) const { return origin_[h]; }
  std::uint32_t target(std::uint32_t h) const { return origin_[next(h)]; }
  std::uint32_t opposite(std::uint32_t h) const { return opposite_[h]; }  // kNone at a border
  // One number for both half-edges of an edge.
  std::uint32_t edge(std::uint32_t h) const { return opposite_[h] == kNone || h < opposite_[h] ? h : opposite_[h]; }
  bool alive(std::uint32_t facet) const { return origin_[3 * facet] != kNone; }
  bool used(std::uint32_t v) const { return out_[v] != kNone; }
  bool on_border(std::uint32_t v) const { return opposite_[out_[v]] == kNone; }
  std::size_t facets() const { return live_; }
  std::size_t half_edges() const { return origin_.size(); }
  std::size_t points() const { return points_.size(); }
  const Vec3& point(std::uint32_t v) const { return points_[v]; }

  // Edges with a mark: creases, and every border.
  bool sharp(std::uint32_t h) const { return sharp_[h] || opposite_[h] == kNone; }
  void mark_sharp(std::uint32_t h);

  // Visits the half-edges that leave v, counter-clockwise; at a border from one side to the other.
  template <class Visit>
  void around(std::uint32_t v, Visit&& visit) const {
    const std::uint32_t first = out_[v];
    for (std::uint32_t h = first; h != kNone;) {
      visit(h);
      h = opposite_[previous(h)];
      if (h == first) return;
    }
  }

  // Whether merging both ends of h keeps a 2-manifold of the same topology: the link condition (Dey et al. 1999). Also, no two sharp edges may fall onto
  // each other.
  bool collapsible(std::uint32_t h);
  // Merges the target of h into its origin, which moves to `to`. The facets at h are gone.
  void collapse(std::uint32_t h, const Vec3& to);

  // What is left, points in their old order; `from[i]` is the number that point i of the result had here.
  TriangleSoup soup(std::vector<std::uint32_t>& from) const;

 private:
  void link(std::uint32_t a, std::uint32_t b, bool sharp);
  void remove_facet(std::uint32_t h);
  void start_at_border(std::uint32_t v, std::uint32_t h);
  std::size_t facets_around(std::uint32_t v) const;

  std::vector<Vec3> points_;
  std::vector<std::uint32_t> origin_;    // kNone for the half-edges of facets that are gone
  std::vector<std::uint32_t> opposite_;
  std::vector<std::uint32_t> out_;       // a half-edge that leaves the point: at a border the one without opposite
  std::vector<char> sharp_;
  std::vector<std::uint32_t> seen_;      // stamps of points
  std::uint32_t stamp_ = 0;
  std::size_t live_ = 0;
};

}  // namespace burnish
