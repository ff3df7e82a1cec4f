// Mesh arrangements with CGAL's exact constructions.
#include "burnish/surface/solid_union.h"

#include <CGAL/Constrained_Delaunay_triangulation_2.h>
#include <CGAL/Exact_predicates_exact_constructions_kernel.h>
#include <CGAL/intersections.h>
#include <CGAL/version.h>

#include <algorithm>
#include <map>
#include <optional>
#include <utility>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/weld.h"
#include "ray_winding.h"

namespace burnish {
namespace {

using Kernel = CGAL::Exact_predicates_exact_constructions_kernel;
using Point2 = Kernel::Point_2;
using Point3 = Kernel::Point_3;
using Triangulation = CGAL::Constrained_Delaunay_triangulation_2<Kernel, CGAL::Default, CGAL::Exact_intersections_tag>;

Point3 to_cgal(const Vec3& p) { return {p.x, p.y, p.z}; }

template <class T, class Variant>
const T* get_as(const Variant& v) {
#if CGAL_VERSION_NR >= 1060000000
  return std::get_if<T>(&v);
#else
  return boost::get<T>(&v);
#endif
}

// What two triangles have in common, as the segments of its outline; a point is a segment of no length.
std::vector<std::pair<Point3, Point3>> common_part(const Kernel::Triangle_3& s, const Kernel::Triangle_3& t) {
  std::vector<std::pair<Point3, Point3>> segments;
  const auto ring = [&](const auto& points, std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) segments.emplace_back(points[static_cast<int>(i)], points[static_cast<int>((i + 1) % n)]);
  };
  const auto common = CGAL::intersection(s, t);
  if (!common) return segments;
  if (const auto* p = get_as<Point3>(*common)) segments.emplace_back(*p, *p);
  if (const auto* e = get_as<Kernel::Segment_3>(*common)) segments.emplace_back(e->source(), e->target());
  if (const auto* f = get_as<Kernel::Triangle_3>(*common)) ring(*f, 3);
  if (const auto* polygon = get_as<std::vector<Point3>>(*common)) {
    for (std::size_t i = 0; i < polygon->size(); ++i) segments.emplace_back((*polygon)[i], (*polygon)[(i + 1) % polygon->size()]);
  }
  return segments;
}

// The plane of a cluster of facets, and the axis along which it is projected.
class Projection {
 public:
  Projection(const Point3& a, const Point3& b, const Point3& c) : a_(a), n_(CGAL::cross_product(b - a, c - a)) {
    const auto x = CGAL::abs(n_.x()), y = CGAL::abs(n_.y()), z = CGAL::abs(n_.z());
    axis_ = z >= x && z >= y ? 2 : y >= x ? 1 : 0;
  }

  int axis() const { return axis_; }
  const Kernel::Vector_3& normal() const { return n_; }
  bool faces_axis() const { return n_[axis_] > 0; }
  // The two coordinates that follow the axis cyclically: counter-clockwise stays so, seen against the axis.
  Point2 flat(const Point3& p) const { return {p[(axis_ + 1) % 3], p[(axis_ + 2) % 3]}; }
  Point3 lifted(const Point2& q) const {
    const int u = (axis_ + 1) % 3, v = (axis_ + 2) % 3;
    const Kernel::FT height = a_[axis_] - (n_[u] * (q.x() - a_[u]) + n_[v] * (q.y() - a_[v])) / n_[axis_];
    std::array<Kernel::FT, 3> p;
    p[static_cast<std::size_t>(axis_)] = height;
    p[static_cast<std::size_t>(u)] = q.x();
    p[static_cast<std::size_t>(v)] = q.y();
    return {p[0], p[1], p[2]};
  }

 private:
  Point3 a_;
  Kernel::Vector_3 n_;
  int axis_ = 2;
};

// A facet of the arrangement.
struct Piece {
  Facet points;
  int jump = 1;                 // how much more the winding number is behind it than in front
  std::uint32_t cluster = 0;    // whose facets it is cut from; for an uncut facet itself
  std::uint32_t source = kNoFacet;
  std::uint32_t parent = kNoFacet;  // a facet that covers it
};

class Arrangement {
 public:
  using Pairs = std::vector<std::array<std::uint32_t, 2>>;

  Arrangement(const TriangleSoup& soup, const Pairs& pairs, Progress& progress)
      : soup_(soup), pairs_(pairs), progress_(progress), clusters_(soup.facets.size()), cut_(soup.facets.size(), 0) {}

  SolidUnion unite() {
    find_clusters();
    points_ = soup_.points;
    cut_clusters();
    for (std::uint32_t f = 0; f < soup_.facets.size(); ++f)
      if (!cut_[f]) pieces_.push_back({soup_.facets[f], 1, f, f, f});
    join_patches();
    decide_patches();
    return surface();
  }

 private:
  Kernel::Triangle_3 triangle(std::uint32_t f) const {
    return {to_cgal(soup_.corner(f, 0)), to_cgal(soup_.corner(f, 1)), to_cgal(soup_.corner(f, 2))};
  }

  // Facets that overlap in a plane form a cluster.
  void find_clusters() {
    for (const auto& [f, g] : pairs_) {
      cut_[f] = cut_[g] = 1;
      const Kernel::Triangle_3 s = triangle(f), t = triangle(g);
      if (CGAL::coplanar(s[0], s[1], s[2], t[0]) && CGAL::coplanar(s[0], s[1], s[2], t[1]) && CGAL::coplanar(s[0], s[1], s[2], t[2]))
        clusters_.unite(f, g);
    }
  }

  void cut_clusters() {
    std::map<std::uint32_t, std::vector<std::uint32_t>> members;
    for (std::uint32_t f = 0; f < cut_.size(); ++f)
      if (cut_[f]) members[clusters_.find(f)].push_back(f);
    std::map<std::uint32_t, std::vector<std::pair<Point3, Point3>>> segments;
    for (const auto& [f, g] : pairs_) {
      progress_.check();
      const std::uint32_t c = clusters_.find(f), d = clusters_.find(g);
      if (c == d) continue;
      for (const auto& segment : common_part(triangle(f), triangle(g)))
        for (const std::uint32_t of : {c, d}) segments[of].push_back(segment);
    }
    for (const auto& [cluster, facets] : members) {
      progress_.check();
      cut(cluster, facets, segments[cluster]);
    }
  }

  void cut(std::uint32_t cluster, const std::vector<std::uint32_t>& facets, const std::vector<std::pair<Point3, Point3>>& segments) {
    const Kernel::Triangle_3 first = triangle(facets[0]);
    const Projection plane(first[0], first[1], first[2]);
    Triangulation mesh;
    for (const std::uint32_t f : facets) {
      const Kernel::Triangle_3 t = triangle(f);
      for (int i = 0; i < 3; ++i) mesh.insert_constraint(plane.flat(t[i]), plane.flat(t[i + 1]));
    }
    for (const auto& [p, q] : segments) {
      if (p == q)
        mesh.insert(plane.flat(p));
      else
        mesh.insert_constraint(plane.flat(p), plane.flat(q));
    }
    std::vector<std::array<Point2, 3>> faces;
    for (auto face = mesh.finite_faces_begin(); face != mesh.finite_faces_end(); ++face)
      faces.push_back({face->vertex(0)->point(), face->vertex(1)->point(), face->vertex(2)->point()});
    const std::vector<Coverage> coverages = cover(plane, facets, faces);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (coverages[i].jump == 0) continue;
      const auto& c = faces[i];
      Piece piece{{number(plane.lifted(c[0])), number(plane.lifted(c[1])), number(plane.lifted(c[2]))}, coverages[i].jump, cluster, kNoFacet,
                  coverages[i].parent};
      if (!plane.faces_axis()) std::swap(piece.points[1], piece.points[2]);
      if (facets.size() == 1 && faces.size() == 1) piece.source = facets[0];
      pieces_.push_back(piece);
    }
  }

  // How many of the facets cover a face facing the cluster's way, minus those facing the other; and one that does.
  struct Coverage {
    int jump = 0;
    std::uint32_t parent = kNoFacet;
  };

  // Every facet looks at the faces whose centres are in its box.
  std::vector<Coverage> cover(const Projection& plane, const std::vector<std::uint32_t>& facets, const std::vector<std::array<Point2, 3>>& faces) {
    std::vector<Point2> centers;
    std::vector<Vec3> approximate;
    for (const auto& c : faces) {
      centers.push_back(CGAL::centroid(c[0], c[1], c[2]));
      approximate.push_back({CGAL::to_double(centers.back().x()), CGAL::to_double(centers.back().y()), 0});
    }
    const PointColumns columns(approximate);
    std::vector<Coverage> result(faces.size());
    for (const std::uint32_t f : facets) {
      progress_.check();
      const Kernel::Triangle_3 t = triangle(f);
      const std::array<Point2, 3> c{plane.flat(t[0]), plane.flat(t[1]), plane.flat(t[2])};
      const auto turn = CGAL::orientation(c[0], c[1], c[2]);
      Box3 box;
      for (const Point2& p : c) box.extend(Vec3{CGAL::to_double(p.x()), CGAL::to_double(p.y()), 0});
      columns.for_each_in(box, [&](std::uint32_t i) {
        for (std::size_t k = 0; k < 3; ++k)
          if (CGAL::orientation(c[k], c[(k + 1) % 3], centers[i]) != turn) return;
        result[i].jump += (turn == CGAL::COUNTERCLOCKWISE) == plane.faces_axis() ? 1 : -1;
        result[i].parent = f;
      });
    }
    return result;
  }

  // One number per point of space; those of the input keep theirs.
  std::uint32_t number(const Point3& p) {
    if (numbers_.empty())
      for (std::uint32_t f = 0; f < cut_.size(); ++f)
        if (cut_[f])
          for (const std::uint32_t i : soup_.facets[f]) numbers_.emplace(to_cgal(soup_.points[i]), i);
    const auto [at, is_new] = numbers_.try_emplace(p, static_cast<std::uint32_t>(points_.size()));
    if (is_new) points_.push_back({CGAL::to_double(p.x()), CGAL::to_double(p.y()), CGAL::to_double(p.z())});
    return at->second;
  }

  void join_patches() {
    TriangleSoup all;
    all.points = points_;
    for (const Piece& piece : pieces_) all.facets.push_back(piece.points);
    const EdgeTable table(all);
    patches_ = UnionFind(pieces_.size());
    for (std::size_t e = 0; e < table.size(); ++e) {
      const auto uses = table.uses(e);
      if (uses.size() == 2 && !table.is_misoriented(e) && pieces_[uses[0].facet].jump == pieces_[uses[1].facet].jump)
        patches_.unite(uses[0].facet, uses[1].facet);
    }
  }

  double twice_area(const Piece& p) const {
    return norm(cross(points_[p.points[1]] - points_[p.points[0]], points_[p.points[2]] - points_[p.points[0]]));
  }

  // The winding number in front of each patch, by a ray from the centre of its largest piece.
  void decide_patches() {
    std::map<std::uint32_t, std::uint32_t> largest;
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      const auto [at, is_new] = largest.try_emplace(patches_.find(i), i);
      if (!is_new && twice_area(pieces_[i]) > twice_area(pieces_[at->second])) at->second = i;
    }
    std::array<std::vector<std::uint32_t>, 3> by_axis;
    for (const auto& [patch, i] : largest) by_axis[static_cast<std::size_t>(dominant_axis(pieces_[i]))].push_back(i);
    front_.assign(pieces_.size(), 0);
    for (int axis = 0; axis < 3; ++axis) cast_rays(axis, by_axis[static_cast<std::size_t>(axis)]);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) front_[i] = front_[largest[patches_.find(i)]];
  }

  Vec3 normal(const Piece& p) const {
    return cross(points_[p.points[1]] - points_[p.points[0]], points_[p.points[2]] - points_[p.points[0]]);
  }
  int dominant_axis(const Piece& p) const {
    const Vec3 n = normal(p);
    const double x = std::abs(n.x), y = std::abs(n.y), z = std::abs(n.z);
    return z >= x && z >= y ? 2 : y >= x ? 1 : 0;
  }

  void cast_rays(int axis, const std::vector<std::uint32_t>& from) {
    if (from.empty()) return;
    const auto turned = [axis](const Vec3& p) { return Vec3{p[(axis + 1) % 3], p[(axis + 2) % 3], p[axis]}; };
    std::vector<Vec3> starts;
    for (const std::uint32_t i : from) {
      const Facet& f = pieces_[i].points;
      starts.push_back(turned((points_[f[0]] + points_[f[1]] + points_[f[2]]) / 3.0));
    }
    const PointColumns columns(starts);
    std::vector<int> above(from.size(), 0);
    for (std::uint32_t f = 0; f < soup_.facets.size(); ++f) {
      const std::array<Vec3, 3> corners{turned(soup_.corner(f, 0)), turned(soup_.corner(f, 1)), turned(soup_.corner(f, 2))};
      Box3 box;
      for (const Vec3& c : corners) box.extend(c);
      const std::uint32_t cluster = clusters_.find(f);
      columns.for_each_in(box, [&](std::uint32_t i) {
        if (box.upper.z >= starts[i].z && clusters_.find(pieces_[from[i]].cluster) != cluster) above[i] += passes(corners, starts[i]);
      });
    }
    for (std::size_t i = 0; i < from.size(); ++i)
      front_[from[i]] = normal(pieces_[from[i]])[axis] > 0 ? above[i] : above[i] - pieces_[from[i]].jump;
  }

  SolidUnion surface() {
    SolidUnion result;
    result.soup.points = std::move(points_);
    std::vector<char> shown(soup_.facets.size(), 0);
    for (std::uint32_t i = 0; i < pieces_.size(); ++i) {
      Piece piece = pieces_[i];
      const bool in_front = front_[i] >= 1, behind = front_[i] + piece.jump >= 1;
      if (in_front == behind) continue;
      if (in_front) std::swap(piece.points[1], piece.points[2]);
      result.soup.facets.push_back(piece.points);
      result.source.push_back(in_front ? kNoFacet : piece.source);
      result.parent.push_back(piece.parent);
      if (piece.source != kNoFacet) shown[piece.source] = 1;
    }
    for (std::size_t f = 0; f < cut_.size(); ++f) {
      result.facets_cut += cut_[f];
      result.facets_absorbed += !cut_[f] && !shown[f];
    }
    result.soup = weld(std::move(result.soup));
    return result;
  }

  const TriangleSoup& soup_;
  const Pairs& pairs_;
  Progress& progress_;
  UnionFind clusters_;
  std::vector<char> cut_;  // facets that intersect others
  std::vector<Vec3> points_;
  std::map<Point3, std::uint32_t> numbers_;
  std::vector<Piece> pieces_;
  UnionFind patches_{0};
  std::vector<int> front_;  // winding number in front of each piece
};

}  // namespace

SolidUnion unite(const TriangleSoup& closed, const std::vector<std::array<std::uint32_t, 2>>& intersecting, Progress& progress) {
  return Arrangement(closed, intersecting, progress).unite();
}

}  // namespace burnish
