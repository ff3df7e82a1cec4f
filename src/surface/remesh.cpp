#include "burnish/surface/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/surface/creases.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/triangle_index.h"
#include "cgal_mesh.h"

namespace burnish {
namespace {

constexpr int kAttempts = 6;
constexpr double kTurn = 0.8660254037844386;  // cos 30 degrees: borders have corners where creases have
constexpr double kReach = 2;                  // edges: facets this near to an intersection are held

using Vertex = Mesh::Vertex_index;

class Remesher {
 public:
  Remesher(const TriangleSoup& given, const RemeshOptions& options, Progress& progress)
      : given_(given), options_(options), progress_(progress), index_(given),
        creases_(find_creases(given, {.angle = options.crease_angle})), held_(given.facets.size(), 0) {}

  RemeshedSurface run() {
    double reach = kReach;
    for (int attempt = 0; attempt < kAttempts; ++attempt, reach *= 2) {
      const TriangleSoup soup = remeshed();
      const std::vector<std::uint32_t> wrong = invalid_facets(soup);
      if (wrong.empty()) return {soup, held(), ""};
      for (const std::uint32_t f : wrong) hold_near(soup, f, reach * options_.edge);
      if (held() == held_.size()) break;
    }
    return {{given_.points, given_.facets, {}}, held_.size(), "remeshed, the surface would intersect itself"};
  }

 private:
  std::size_t held() const { return static_cast<std::size_t>(std::count(held_.begin(), held_.end(), 1)); }

  TriangleSoup remeshed() {
    Mesh mesh;
    const std::vector<Mesh::Face_index> faces = build(mesh);
    auto creases = mesh.add_property_map<Mesh::Edge_index, bool>("e:crease", false).first;
    auto corners = mesh.add_property_map<Vertex, bool>("v:corner", false).first;
    mark_creases(mesh, creases, corners);
    mark_border_corners(mesh, corners);
    std::size_t steps = 0;
    const auto project = [&](Vertex v) {
      if (++steps % 4096 == 0) progress_.check();
      return to_cgal(index_.closest(from_cgal(mesh.point(v))).point);
    };
    if (!faces.empty())
      CGAL::Polygon_mesh_processing::isotropic_remeshing(faces, options_.edge, mesh,
                                                         CGAL::parameters::number_of_iterations(static_cast<unsigned>(options_.rounds))
                                                             .edge_is_constrained_map(creases)
                                                             .vertex_is_constrained_map(corners)
                                                             .projection_functor(project));
    mesh.collect_garbage();
    return soup_of(mesh);
  }

  // The facets that are not held.
  std::vector<Mesh::Face_index> build(Mesh& mesh) const {
    for (const Vec3& p : given_.points) mesh.add_vertex(to_cgal(p));
    std::vector<Mesh::Face_index> faces;
    for (std::size_t f = 0; f < given_.facets.size(); ++f) {
      const Facet& c = given_.facets[f];
      const Mesh::Face_index face = mesh.add_face(Vertex(c[0]), Vertex(c[1]), Vertex(c[2]));
      if (face == Mesh::null_face()) throw Error(ErrorCode::guarantee_unmet, "the surface to remesh is no consistently oriented 2-manifold");
      if (!held_[f]) faces.push_back(face);
    }
    return faces;
  }

  template <class EdgeMap, class VertexMap>
  void mark_creases(const Mesh& mesh, EdgeMap& creases, VertexMap& corners) const {
    for (const CreaseEdge& e : creases_.edges) creases[mesh.edge(mesh.halfedge(Vertex(e.points[0]), Vertex(e.points[1])))] = true;
    for (const std::uint32_t p : creases_.corners) corners[Vertex(p)] = true;
  }

  template <class VertexMap>
  static void mark_border_corners(const Mesh& mesh, VertexMap& corners) {
    for (const Mesh::Halfedge_index h : mesh.halfedges()) {
      if (!mesh.is_border(h)) continue;
      const Vec3 at = from_cgal(mesh.point(mesh.target(h)));
      const Vec3 in = at - from_cgal(mesh.point(mesh.source(h))), out = from_cgal(mesh.point(mesh.target(mesh.next(h)))) - at;
      if (dot(in, out) < kTurn * norm(in) * norm(out)) corners[mesh.target(h)] = true;
    }
  }

  static TriangleSoup soup_of(const Mesh& mesh) {
    TriangleSoup soup;
    for (const Vertex v : mesh.vertices()) soup.points.push_back(from_cgal(mesh.point(v)));
    for (const Mesh::Face_index f : mesh.faces()) {
      Facet& facet = soup.facets.emplace_back();
      std::size_t i = 0;
      for (const Vertex v : CGAL::vertices_around_face(mesh.halfedge(f), mesh)) facet[i++] = v.idx();
    }
    return soup;
  }

  std::vector<std::uint32_t> invalid_facets(const TriangleSoup& soup) {
    const Inspection found = inspect(soup, {.elements = true}, progress_);
    std::vector<std::uint32_t> wrong = found.elements.degenerate_facets;
    for (const auto& pair : found.self_intersections) wrong.insert(wrong.end(), pair.begin(), pair.end());
    return wrong;
  }

  void hold_near(const TriangleSoup& soup, std::uint32_t f, double reach) {
    std::vector<std::uint32_t> near;
    const Vec3 at = (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3;
    index_.facets_near(at, reach * reach, near);
    for (const std::uint32_t g : near) held_[g] = 1;
  }

  const TriangleSoup& given_;
  const RemeshOptions& options_;
  Progress& progress_;
  TriangleIndex index_;
  Creases creases_;
  std::vector<char> held_;  // facets
};

}  // namespace

RemeshedSurface remesh(const TriangleSoup& manifold, const RemeshOptions& options, Progress& progress) {
  if (!(options.edge > 0) || !std::isfinite(options.edge)) throw Error(ErrorCode::usage, "the edge length to remesh to is not positive");
  progress.begin_stage("remeshing");
  return Remesher(manifold, options, progress).run();
}

}  // namespace burnish
