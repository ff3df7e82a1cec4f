// Mending with CGAL's polygon mesh processing. Its assertions stay on in this unit (src/surface/CMakeLists.txt):
// what a soup can do to it then ends in an exception, and in a refusal.
#include "mend_mesh.h"

#include <CGAL/Polygon_mesh_processing/border.h>
#include <CGAL/Polygon_mesh_processing/repair_degeneracies.h>
#include <CGAL/Polygon_mesh_processing/repair_self_intersections.h>
#include <CGAL/Polygon_mesh_processing/triangulate_hole.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <exception>
#include <limits>
#include <numeric>
#include <set>

#include "burnish/surface/edge_table.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/manifold.h"
#include "burnish/surface/shells.h"
#include "burnish/surface/weld.h"
#include "cgal_mesh.h"
#include "exact_predicates.h"
#include "point_table.h"

namespace burnish {
namespace {

namespace pmp = CGAL::Polygon_mesh_processing;
using FaceIndex = Mesh::Face_index;
using HalfedgeIndex = Mesh::Halfedge_index;

constexpr double kMostIntersecting = 0.05;   // of the facets: beyond this too little is left to hold on to
constexpr std::size_t kFewIntersecting = 64; // facets that may intersect in any case
constexpr double kMostTangled = 0.02;        // of the facets may be left out because no manifold has them
constexpr int kUntanglingRounds = 4;
constexpr int kRemovalRounds = 4;            // each grows the part that is cut out by a ring of facets
constexpr int kRings = 3;                    // of facets around those that intersect, which the removal may use
constexpr std::size_t kFairedLoop = 12;      // edges: longer loops that are not flat get a faired membrane
constexpr std::size_t kCubicLoop = 500;      // edges: up to that the search for the best filling may take cubic time
constexpr double kFlat = 0.01;               // of its size: how far a loop may leave its plane to be flat
constexpr double kSplitShare = 1e-3;         // of its fan's shortest edge: how far a doubled point is moved
constexpr double kSplitFloatSteps = 16;      // and at least: steps of float32 at its coordinates

// The mesh as a soup: point i is vertex i, whether anything uses it or not.
struct Exported {
  TriangleSoup soup;
  std::vector<FaceIndex> faces;  // behind each facet
};

class MeshMender {
 public:
  MeshMender(const TriangleSoup& input, const LocalRepairOptions& options, Progress& progress)
      : input_(input), options_(options), progress_(progress) {}

  // Everything up to intersections.
  LocalRepairResult mend() {
    build_mesh();
    remove_needles();
    separate_coincident_points();
    fill_holes();
    remove_needles();
    progress_.check();
    return result();
  }

  LocalRepairResult mend_and_cut_out() {
    mend();
    remove_self_intersections();
    return result();
  }

 private:
  void build_mesh() {
    ManifoldPieces pieces = split_into_manifold_pieces(input_);
    std::vector<std::uint32_t> kept(input_.facets.size());
    std::iota(kept.begin(), kept.end(), 0u);
    for (int round = 0; !pieces.manifold && round < kUntanglingRounds; ++round) pieces = untangled(pieces, kept);
    if (!pieces.manifold) throw Refusal{"facets meet in a way that no two-sided surface has"};
    result_.tangled_removed = input_.facets.size() - kept.size();
    mesh_.reserve(static_cast<Mesh::size_type>(pieces.soup.points.size()), static_cast<Mesh::size_type>(3 * pieces.soup.facets.size() / 2),
                  static_cast<Mesh::size_type>(pieces.soup.facets.size()));
    for (const Vec3& p : pieces.soup.points) mesh_.add_vertex(to_cgal(p));
    source_ = mesh_.add_property_map<FaceIndex, std::uint32_t>("f:source", kNoFacet).first;
    fills_ = mesh_.add_property_map<FaceIndex, char>("f:fills", 0).first;
    for (std::uint32_t f = 0; f < pieces.soup.facets.size(); ++f) {
      const Facet& facet = pieces.soup.facets[f];
      const FaceIndex face = mesh_.add_face(vertex(facet[0]), vertex(facet[1]), vertex(facet[2]));
      if (face == Mesh::null_face()) throw Refusal{"facets meet in a way that no 2-manifold has"};
      source_[face] = kept[f];
    }
  }

  // Leaves out the facets at edges that could not be made manifold; what they leave open is filled later.
  ManifoldPieces untangled(const ManifoldPieces& pieces, std::vector<std::uint32_t>& kept) const {
    const EdgeTable table(pieces.soup);
    std::vector<char> drop(pieces.soup.facets.size(), 0);
    for (std::size_t e = 0; e < table.size(); ++e)
      if (table.is_non_manifold(e) || table.is_misoriented(e))
        for (const EdgeUse& use : table.uses(e)) drop[use.facet] = 1;
    TriangleSoup rest{input_.points, {}, {}};
    std::vector<std::uint32_t> left;
    for (std::size_t f = 0; f < kept.size(); ++f)
      if (!drop[f]) {
        left.push_back(kept[f]);
        rest.facets.push_back(input_.facets[kept[f]]);
      }
    kept = std::move(left);
    if (static_cast<double>(input_.facets.size() - kept.size()) > kMostTangled * static_cast<double>(input_.facets.size()))
      throw Refusal{"too many facets meet in a way that no two-sided surface has"};
    return split_into_manifold_pieces(rest);
  }

  static Mesh::Vertex_index vertex(std::uint32_t i) { return Mesh::Vertex_index(i); }

  void remove_needles() {
    std::vector<FaceIndex> needles;
    for (const FaceIndex f : mesh_.faces())
      if (is_degenerate(f)) needles.push_back(f);
    if (needles.empty()) return;
    result_.needles_flipped += needles.size();
    pmp::remove_degenerate_faces(needles, mesh_);
    for (const FaceIndex f : mesh_.faces())
      if (is_degenerate(f)) throw Refusal{"facets without an area could not be flipped away"};
  }

  bool is_degenerate(FaceIndex f) const {
    const std::array<Vec3, 3> c = corners(f);
    return c[0] == c[1] || c[1] == c[2] || c[2] == c[0] || exactly_collinear(c[0], c[1], c[2]);
  }

  std::array<Mesh::Vertex_index, 3> face_vertices(FaceIndex f) const {
    const HalfedgeIndex h = mesh_.halfedge(f);
    return {mesh_.source(h), mesh_.target(h), mesh_.target(mesh_.next(h))};
  }
  std::array<Vec3, 3> corners(FaceIndex f) const {
    const auto v = face_vertices(f);
    return {from_cgal(mesh_.point(v[0])), from_cgal(mesh_.point(v[1])), from_cgal(mesh_.point(v[2]))};
  }

  // --- holes

  void fill_holes() {
    std::vector<HalfedgeIndex> loops;
    pmp::extract_boundary_cycles(mesh_, std::back_inserter(loops));
    for (const HalfedgeIndex loop : loops) {
      Hole hole = measure_hole(loop_points(loop));
      if (!options_.max_hole || hole.width() <= *options_.max_hole) {
        hole.area = fill(loop, hole);
        hole.filled = true;
      }
      result_.holes.push_back(hole);
      progress_.check();
    }
    std::stable_sort(result_.holes.begin(), result_.holes.end(), [](const Hole& a, const Hole& b) { return a.perimeter > b.perimeter; });
  }

  std::vector<Vec3> loop_points(HalfedgeIndex loop) const {
    std::vector<Vec3> points;
    for (const HalfedgeIndex h : CGAL::halfedges_around_face(loop, mesh_)) points.push_back(from_cgal(mesh_.point(mesh_.source(h))));
    return points;
  }

  bool is_flat(HalfedgeIndex loop) const {
    const std::vector<Vec3> points = loop_points(loop);
    Vec3 normal;
    Box3 box;
    for (std::size_t i = 0; i < points.size(); ++i) {
      normal += cross(points[i] - points[0], points[(i + 1) % points.size()] - points[0]);
      box.extend(points[i]);
    }
    if (!(norm(normal) > 0)) return false;
    normal = normal / norm(normal);
    double low = 0, high = 0;
    for (const Vec3& p : points) {
      low = std::min(low, dot(normal, p - points[0]));
      high = std::max(high, dot(normal, p - points[0]));
    }
    return high - low <= kFlat * box.diagonal();
  }

  // Fills one loop and returns the area of what fills it. Flat loops by a constrained Delaunay triangulation, short ones
  // by the triangulation of least weight, long ones by a membrane (fairing without a condition on the tangents).
  double fill(HalfedgeIndex loop, const Hole& hole) {
    std::vector<FaceIndex> faces;
    const auto fast = CGAL::parameters::use_delaunay_triangulation(true).do_not_use_cubic_algorithm(hole.edges > kCubicLoop);
    if (is_flat(loop))
      pmp::triangulate_hole(mesh_, loop, std::back_inserter(faces), fast.use_2d_constrained_delaunay_triangulation(true));
    if (faces.empty() && hole.edges > kFairedLoop) {
      std::vector<Mesh::Vertex_index> inner;
      pmp::triangulate_and_refine_hole(mesh_, loop, std::back_inserter(faces), std::back_inserter(inner), fast);
      relax(inner);
    }
    if (faces.empty()) pmp::triangulate_hole(mesh_, loop, std::back_inserter(faces), fast);
    if (faces.empty())
      throw Refusal{fmt::format("the hole of {} edges at ({:.6g}, {:.6g}, {:.6g}) could not be triangulated", hole.edges, hole.position.x,
                                hole.position.y, hole.position.z)};
    double area = 0;
    for (const FaceIndex f : faces) {
      fills_[f] = 1;
      const auto c = corners(f);
      area += 0.5 * norm(cross(c[1] - c[0], c[2] - c[0]));
    }
    return area;
  }

  // Moves the points inside a patch towards the mean of their neighbours: a discrete membrane. [T-CAP-3]
  void relax(const std::vector<Mesh::Vertex_index>& inner) {
    constexpr int kPasses = 100;
    for (int pass = 0; pass < kPasses; ++pass)
      for (const Mesh::Vertex_index v : inner) {
        Vec3 sum;
        double count = 0;
        for (const Mesh::Vertex_index w : CGAL::vertices_around_target(mesh_.halfedge(v), mesh_)) {
          sum += from_cgal(mesh_.point(w));
          ++count;
        }
        mesh_.point(v) = to_cgal(sum / count);
      }
  }

  // --- self-intersections

  Exported exported() const {
    Exported result;
    result.soup.points.reserve(mesh_.num_vertices());
    for (std::uint32_t v = 0; v < mesh_.num_vertices(); ++v) result.soup.points.push_back(from_cgal(mesh_.point(vertex(v))));
    for (const FaceIndex f : mesh_.faces()) {
      const auto v = face_vertices(f);
      result.soup.facets.push_back({v[0].idx(), v[1].idx(), v[2].idx()});
      result.faces.push_back(f);
    }
    return result;
  }

  void remove_self_intersections() {
    Exported now = exported();
    Pairs pairs = self_intersecting_pairs(now.soup, progress_);
    if (pairs.empty()) return;
    refuse_hopeless(now.soup, pairs);
    const std::size_t before = pairs.size();
    for (int round = 0; round < kRemovalRounds && !pairs.empty(); ++round) {
      pmp::experimental::remove_self_intersections(around(now, pairs), mesh_, CGAL::parameters::preserve_genus(false));
      now = exported();
      pairs = self_intersecting_pairs(now.soup, progress_);
      progress_.check();
    }
    if (!pairs.empty()) throw Refusal{fmt::format("{} of {} pairs of intersecting facets remain", pairs.size(), before)};
    require_no_new_holes();
    result_.intersecting_pairs_removed = before;
  }

  // The facets that intersect, and some rings around them: what may be cut out. CGAL looks for intersections among all
  // that it is given, again and again.
  std::vector<FaceIndex> around(const Exported& now, const Pairs& pairs) const {
    std::set<FaceIndex> found;
    for (const auto& pair : pairs)
      for (const std::uint32_t f : pair) found.insert(now.faces[f]);
    std::vector<FaceIndex> ring(found.begin(), found.end());
    for (int r = 0; r < kRings; ++r) {
      std::vector<FaceIndex> next;
      for (const FaceIndex f : ring)
        for (const Mesh::Vertex_index v : face_vertices(f))
          for (const FaceIndex g : CGAL::faces_around_target(mesh_.halfedge(v), mesh_))
            if (g != Mesh::null_face() && found.insert(g).second) next.push_back(g);
      ring = std::move(next);
    }
    return {found.begin(), found.end()};
  }

  // Facets of different shells that intersect ask for a union, which cutting and filling is not.
  static void refuse_hopeless(const TriangleSoup& soup, const Pairs& pairs) {
    std::set<std::uint32_t> facets;
    const Shells shells = find_shells(soup);
    for (const auto& [f, g] : pairs) {
      if (shells.of_facet[f] != shells.of_facet[g]) throw Refusal{"bodies overlap: their union is needed"};
      facets.insert({f, g});
    }
    if (facets.size() > kFewIntersecting && static_cast<double>(facets.size()) > kMostIntersecting * static_cast<double>(soup.facets.size()))
      throw Refusal{fmt::format("{} of {} facets intersect others", facets.size(), soup.facets.size())};
  }

  void require_no_new_holes() const {
    std::vector<HalfedgeIndex> loops;
    pmp::extract_boundary_cycles(mesh_, std::back_inserter(loops));
    const auto open = std::count_if(result_.holes.begin(), result_.holes.end(), [](const Hole& h) { return !h.filled; });
    if (loops.size() != static_cast<std::size_t>(open)) throw Refusal{"cutting out facets that intersect left holes that could not be filled"};
  }

  // --- points that coincide

  void separate_coincident_points() {
    PointTable table(mesh_.num_vertices());
    std::vector<std::vector<Mesh::Vertex_index>> groups;  // of equal coordinates, those that are shared
    std::vector<std::uint32_t> group_of;                  // by number in the table, kNone for a single one
    std::vector<Mesh::Vertex_index> first_of;
    constexpr std::uint32_t kNone = 0xffffffffu;
    for (const Mesh::Vertex_index v : mesh_.vertices()) {
      if (mesh_.is_isolated(v)) continue;
      const std::uint32_t number = table.insert(from_cgal(mesh_.point(v)));
      if (number == first_of.size()) {
        first_of.push_back(v);
        group_of.push_back(kNone);
        continue;
      }
      if (group_of[number] == kNone) {
        group_of[number] = static_cast<std::uint32_t>(groups.size());
        groups.push_back({first_of[number]});
      }
      groups[group_of[number]].push_back(v);
    }
    for (const auto& group : groups) separate(group);
  }

  // Moves all but the point with the most facets a little inwards.
  void separate(const std::vector<Mesh::Vertex_index>& group) {
    const auto most = std::max_element(group.begin(), group.end(), [&](auto a, auto b) { return mesh_.degree(a) < mesh_.degree(b); });
    for (const Mesh::Vertex_index v : group) {
      if (v == *most) continue;
      const Vec3 at = from_cgal(mesh_.point(v));
      Vec3 outwards;
      double shortest = std::numeric_limits<double>::infinity();
      for (const HalfedgeIndex h : CGAL::halfedges_around_target(v, mesh_)) {
        shortest = std::min(shortest, norm(from_cgal(mesh_.point(mesh_.source(h))) - at));
        if (mesh_.is_border(h)) continue;
        const auto c = corners(mesh_.face(h));
        const Vec3 n = cross(c[1] - c[0], c[2] - c[0]);
        outwards += n / std::max(norm(n), std::numeric_limits<double>::min());
      }
      if (!(norm(outwards) > 0)) throw Refusal{fmt::format("fans that touch at ({:.6g}, {:.6g}, {:.6g}) could not be moved apart", at.x, at.y, at.z)};
      const double step = std::max({std::abs(at.x), std::abs(at.y), std::abs(at.z)}) * 0x1p-23;
      const double far = std::max(kSplitShare * shortest, kSplitFloatSteps * step);
      mesh_.point(v) = to_cgal(at - outwards * (far / norm(outwards)));
      ++result_.points_split;
      result_.largest_split = std::max(result_.largest_split, far);
    }
  }

  // --- the result

  LocalRepairResult result() {
    LocalRepairResult copy = result_;
    Exported now = exported();
    for (std::size_t f = 0; f < now.faces.size(); ++f) {
      copy.source.push_back(restore(now.soup, f, source_[now.faces[f]]));
      copy.fills_hole.push_back(fills_[now.faces[f]]);
    }
    copy.soup = weld(std::move(now.soup));
    return copy;
  }

  // Turns facet f to begin where its source does. Returns the source, or kNoFacet if their points are not the same.
  std::uint32_t restore(TriangleSoup& soup, std::size_t f, std::uint32_t source) const {
    if (source == kNoFacet) return kNoFacet;
    Facet& facet = soup.facets[f];
    for (int shift = 0; shift < 3; ++shift) {
      if (soup.corner(f, 0) == input_.corner(source, 0) && soup.corner(f, 1) == input_.corner(source, 1) &&
          soup.corner(f, 2) == input_.corner(source, 2))
        return source;
      std::rotate(facet.begin(), facet.begin() + 1, facet.end());
    }
    return kNoFacet;
  }

  const TriangleSoup& input_;
  const LocalRepairOptions& options_;
  Progress& progress_;
  Mesh mesh_;
  Mesh::Property_map<FaceIndex, std::uint32_t> source_;
  Mesh::Property_map<FaceIndex, char> fills_;
  LocalRepairResult result_;
};

// Runs a step of CGAL's: its failures are refusals.
template <class Step>
LocalRepairResult guarded(Step&& step) {
  try {
    return step();
  } catch (const CGAL::Failure_exception&) {
    throw Refusal{"the mesh is too broken for local operations"};
  }
}

}  // namespace

LocalRepairResult mend(const TriangleSoup& oriented, const LocalRepairOptions& options, Progress& progress) {
  return guarded([&] { return MeshMender(oriented, options, progress).mend(); });
}

LocalRepairResult mend_and_cut_out(const TriangleSoup& oriented, const LocalRepairOptions& options, Progress& progress) {
  return guarded([&] { return MeshMender(oriented, options, progress).mend_and_cut_out(); });
}

}  // namespace burnish
