#include "geometry.h"

#include <CGAL/AABB_tree.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/orient_polygon_soup.h>
#include <CGAL/Polygon_mesh_processing/orientation.h>
#include <CGAL/Polygon_mesh_processing/polygon_soup_to_polygon_mesh.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/version.h>
#if CGAL_VERSION_MAJOR >= 6
#include <CGAL/AABB_traits_3.h>
#include <CGAL/AABB_triangle_primitive_3.h>
#else
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_triangle_primitive.h>
#endif

#include <algorithm>
#include <cmath>
#include <iterator>
#include <random>
#include <utility>
#include <vector>

namespace judge {
namespace {

namespace PMP = CGAL::Polygon_mesh_processing;
using Exact = CGAL::Exact_predicates_inexact_constructions_kernel;
using SurfaceMesh = CGAL::Surface_mesh<Exact::Point_3>;

// Distances need no exact predicates, only rounding errors far below what is judged.
using Fast = CGAL::Simple_cartesian<double>;
using Triangles = std::vector<Fast::Triangle_3>;
#if CGAL_VERSION_MAJOR >= 6
using Primitive = CGAL::AABB_triangle_primitive_3<Fast, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits_3<Fast, Primitive>>;
#else
using Primitive = CGAL::AABB_triangle_primitive<Fast, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Fast, Primitive>>;
#endif

// A misoriented mesh is turned first: halfedges cannot express it.
SurfaceMesh surface_mesh(const Mesh& mesh, bool oriented) {
  std::vector<Exact::Point_3> points;
  for (const Point& p : mesh.points) points.emplace_back(p[0], p[1], p[2]);
  std::vector<std::vector<std::size_t>> facets;
  for (const Facet& f : mesh.facets) facets.push_back({f[0], f[1], f[2]});
  if (!oriented) PMP::orient_polygon_soup(points, facets);
  SurfaceMesh result;
  PMP::polygon_soup_to_polygon_mesh(points, facets, result);
  return result;
}

// Facets with an area: the others are no part of the surface, and have no plane to project to.
Triangles triangles_with_area(const Mesh& mesh) {
  Triangles triangles;
  for (const Facet& f : mesh.facets) {
    const auto corner = [&](int i) {
      const Point& p = mesh.points[f[i]];
      return Fast::Point_3(p[0], p[1], p[2]);
    };
    const Fast::Triangle_3 triangle(corner(0), corner(1), corner(2));
    if (std::sqrt(triangle.squared_area()) > 0) triangles.push_back(triangle);
  }
  return triangles;
}

std::vector<double> running_areas(const Triangles& triangles) {
  std::vector<double> sums;
  double sum = 0;
  for (const auto& triangle : triangles) sums.push_back(sum += std::sqrt(triangle.squared_area()));
  return sums;
}

Fast::Point_3 point_of(const Fast::Triangle_3& triangle, double u, double v) {
  if (u + v > 1) u = 1 - u, v = 1 - v;
  return triangle[0] + u * (triangle[1] - triangle[0]) + v * (triangle[2] - triangle[0]);
}

// One random point in each of `count` strips of equal area.
std::vector<Fast::Point_3> sample(const Triangles& triangles, std::size_t count) {
  const std::vector<double> sums = running_areas(triangles);
  std::mt19937 random(1);
  const auto uniform = [&] { return static_cast<double>(random()) / 4294967296.0; };
  std::vector<Fast::Point_3> points;
  std::size_t f = 0;
  for (std::size_t i = 0; i < count; ++i) {
    const double at = (static_cast<double>(i) + uniform()) / static_cast<double>(count) * sums.back();
    while (f + 1 < triangles.size() && sums[f] < at) ++f;
    const double u = uniform(), v = uniform();
    points.push_back(point_of(triangles[f], u, v));
  }
  return points;
}

double distance(const Tree& tree, const Fast::Point_3& point) {
  return std::sqrt(tree.squared_distance(point));
}

}  // namespace

Embedding inspect_embedding(const Mesh& mesh, bool manifold, bool closed, bool oriented) {
  Embedding result;
  if (!manifold || mesh.facets.empty()) return result;
  const SurfaceMesh surface = surface_mesh(mesh, oriented);
  std::vector<std::pair<SurfaceMesh::Face_index, SurfaceMesh::Face_index>> pairs;
  PMP::self_intersections(surface, std::back_inserter(pairs));
  result.self_intersections = pairs.size();
  result.bounds_volume = closed && oriented && pairs.empty() && PMP::does_bound_a_volume(surface);
  return result;
}

Distances measure(const Mesh& from, const Mesh& to, std::size_t samples, double far) {
  Distances result;
  const Triangles source = triangles_with_area(from), target = triangles_with_area(to);
  if (source.empty() || target.empty() || samples == 0) return result;
  Tree tree(target.begin(), target.end());
  tree.accelerate_distance_queries();
  double squares = 0;
  std::size_t distant = 0;
  for (const auto& point : sample(source, samples)) {
    const double d = distance(tree, point);
    squares += d * d;
    distant += d > far;
    result.max = std::max(result.max, d);
  }
  const std::size_t step = from.points.size() / samples + 1;
  for (std::size_t i = 0; i < from.points.size(); i += step) {
    const Point& p = from.points[i];
    result.max = std::max(result.max, distance(tree, Fast::Point_3(p[0], p[1], p[2])));
  }
  result.samples = samples;
  result.rms = std::sqrt(squares / static_cast<double>(samples));
  result.far_share = static_cast<double>(distant) / static_cast<double>(samples);
  return result;
}

double area(const Mesh& mesh) {
  const std::vector<double> sums = running_areas(triangles_with_area(mesh));
  return sums.empty() ? 0 : sums.back();
}

}  // namespace judge
