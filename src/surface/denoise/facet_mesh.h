// Who is next to whom on a surface that is being denoised, and the facets' geometry while its points move.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/surface/triangle_soup.h"

namespace burnish::denoising {

// Rows of numbers of different length.
struct Rows {
  std::vector<std::uint64_t> first;  // row i is [first[i], first[i + 1])
  std::vector<std::uint32_t> entries;

  std::span<const std::uint32_t> operator[](std::size_t i) const { return {entries.data() + first[i], first[i + 1] - first[i]}; }
  std::size_t size() const { return first.size() - 1; }
};

inline constexpr std::size_t kMostAround = 24;

// The connectivity of a welded, oriented soup; points may move under it.
struct FacetMesh {
  explicit FacetMesh(const TriangleSoup& welded);

  std::vector<Facet> facets;
  std::vector<std::array<std::uint32_t, 3>> across;  // behind each side: the other facet of an edge with two opposite uses, or kNoFacet
  Rows facets_of_point;                              // facets that repeat a point are left out everywhere
  Rows ring;                                         // of each facet: others that share a point with it; around points with more than
                                                     // kMostAround facets only those across its edges
  Rows two_rings;                                    // of each facet: its ring, and the rings of those
  bool closed = false;                               // directed edges cancel: there is a volume
};

// Facets at some position of the points. A facet without area has normal 0.
struct FacetGeometry {
  FacetGeometry(const FacetMesh& mesh, const std::vector<Vec3>& points);
  void update(const FacetMesh& mesh, const std::vector<Vec3>& points);

  std::vector<Vec3> normal, centroid;
  std::vector<double> area;
};

// Mean length of the sides of all facets, those without area too; 0 without any.
double mean_edge(const FacetMesh& mesh, const std::vector<Vec3>& points);

// The direction of v, or `otherwise` where it has none.
Vec3 unit_or(const Vec3& v, const Vec3& otherwise);

// Unit normals of points: the angle-free mean of their facets' normals weighted by area; 0 where there is none.
std::vector<Vec3> point_normals(const FacetMesh& mesh, const std::vector<Vec3>& facet_normals, const std::vector<double>& area);

}  // namespace burnish::denoising
