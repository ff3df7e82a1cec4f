#include "burnish/surface/remesh.h"

#include <CGAL/Polygon_mesh_processing/remesh.h>

#include <algorithm>
#include <cmath>
#include <deque>
#include <utility>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/creases.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/shells.h"
#include "burnish/surface/triangle_index.h"
#include "cgal_mesh.h"

namespace burnish {
namespace {

constexpr int kAttempts = 6;                  // shells that are wrong in the last one or later stay as they are
constexpr double kTurn = 0.8660254037844386;  // cos 30 degrees: borders have corners where creases have

using Vertex = Mesh::Vertex_index;

// One shell: remeshed on its own, so that its points are projected to it and not to what is near.
class ShellRemesher {
 public:
  ShellRemesher(TriangleSoup given, const RemeshOptions& options, Progress& progress)
      : given_(std::move(given)), options_(options), progress_(progress), index_(given_),
        creases_(find_creases(given_, {.angle = options.crease_angle})), held_(given_.facets.size(), 0) {}

  const TriangleSoup& result() const { return result_; }
  std::size_t held() const { return static_cast<std::size_t>(std::count(held_.begin(), held_.end(), 1)); }
  bool all_held() const { return held() == held_.size(); }

  void run() {
    progress_.check();
    result_ = all_held() ? given_ : remeshed();
  }

  void hold_all() { std::fill(held_.begin(), held_.end(), 1); }

  // Holds what lies behind these facets of the result and behind rings of facets around them: none the first time, one more each time.
  void hold_around(const std::vector<std::uint32_t>& wrong) {
    for (const std::uint32_t f : wrong)
      for (int i = 0; i < 3; ++i) held_[index_.closest(result_.corner(f, i)).facet] = 1;
    const std::vector<char> around = with_rings(wrong, rings_++);
    const TriangleIndex of_result(result_);
    parallel_for(given_.facets.size(), [&](std::size_t f) {
      if (around[of_result.closest((given_.corner(f, 0) + given_.corner(f, 1) + given_.corner(f, 2)) / 3).facet]) held_[f] = 1;
    });
  }

 private:
  std::vector<char> with_rings(const std::vector<std::uint32_t>& facets, int rings) const {
    std::vector<char> in(result_.facets.size(), 0), at(result_.points.size(), 0);
    for (const std::uint32_t f : facets) in[f] = 1;
    for (; rings > 0; --rings) {
      for (std::size_t f = 0; f < in.size(); ++f)
        if (in[f])
          for (const std::uint32_t p : result_.facets[f]) at[p] = 1;
      for (std::size_t f = 0; f < in.size(); ++f)
        for (const std::uint32_t p : result_.facets[f]) in[f] = static_cast<char>(in[f] | at[p]);
    }
    return in;
  }

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
      if (face == Mesh::null_face()) throw Error(ErrorCode::guarantee_unmet, "the surface to remesh is no consistently oriented 2-manifold", "repair it first, as clean() does");
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

  TriangleSoup given_;
  const RemeshOptions& options_;
  Progress& progress_;
  TriangleIndex index_;
  Creases creases_;
  std::vector<char> held_;  // facets
  TriangleSoup result_;
  int rings_ = 0;
};

std::vector<TriangleSoup> shells_of(const TriangleSoup& soup) {
  constexpr std::uint32_t kNone = 0xffffffffu;
  const Shells found = find_shells(soup);
  std::vector<TriangleSoup> shells(found.shells.size());
  std::vector<std::uint32_t> shell_of(soup.points.size(), kNone), number(soup.points.size(), 0);
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const std::uint32_t shell = found.of_facet[f];
    for (const std::uint32_t p : soup.facets[f]) {
      if (shell_of[p] == shell) continue;
      if (shell_of[p] != kNone) throw Error(ErrorCode::guarantee_unmet, "the surface to remesh is no 2-manifold: shells share a point", "give each shell points of its own");
      shell_of[p] = shell;
      number[p] = static_cast<std::uint32_t>(shells[shell].points.size());
      shells[shell].points.push_back(soup.points[p]);
    }
    const Facet& c = soup.facets[f];
    shells[shell].facets.push_back({number[c[0]], number[c[1]], number[c[2]]});
  }
  return shells;
}

class Remesher {
 public:
  Remesher(const TriangleSoup& given, const RemeshOptions& options, Progress& progress) : given_(given), progress_(progress) {
    for (TriangleSoup& shell : shells_of(given)) shells_.emplace_back(std::move(shell), options, progress);
    for (ShellRemesher& shell : shells_) shell.run();
  }

  RemeshedSurface run() {
    for (int attempt = 0; attempt < 2 * kAttempts; ++attempt) {
      const TriangleSoup soup = joined();
      const std::vector<std::vector<std::uint32_t>> wrong = invalid_facets(soup);
      if (std::all_of(wrong.begin(), wrong.end(), [](const auto& facets) { return facets.empty(); })) return valid(soup);
      for (std::size_t s = 0; s < shells_.size(); ++s)
        if (!wrong[s].empty()) again(shells_[s], wrong[s], attempt);
    }
    return unchanged();
  }

 private:
  static void again(ShellRemesher& shell, const std::vector<std::uint32_t>& wrong, int attempt) {
    if (attempt + 1 < kAttempts) shell.hold_around(wrong);
    else shell.hold_all();
    shell.run();
  }

  RemeshedSurface valid(const TriangleSoup& soup) const {
    std::size_t held = 0;
    for (const ShellRemesher& shell : shells_) held += shell.held();
    return held == given_.facets.size() && held > 0 ? unchanged() : RemeshedSurface{soup, held, ""};
  }

  RemeshedSurface unchanged() const {
    return {{given_.points, given_.facets, {}}, given_.facets.size(), "remeshed, the surface would intersect itself"};
  }

  TriangleSoup joined() const {
    TriangleSoup all;
    for (const ShellRemesher& shell : shells_) {
      const auto first = static_cast<std::uint32_t>(all.points.size());
      all.points.insert(all.points.end(), shell.result().points.begin(), shell.result().points.end());
      for (const Facet& f : shell.result().facets) all.facets.push_back({f[0] + first, f[1] + first, f[2] + first});
    }
    return all;
  }

  // Of each shell's result, by their numbers there.
  std::vector<std::vector<std::uint32_t>> invalid_facets(const TriangleSoup& soup) {
    const Inspection found = inspect(soup, {.elements = true}, progress_);
    std::vector<std::uint32_t> all = found.elements.degenerate_facets;
    for (const auto& pair : found.self_intersections) all.insert(all.end(), pair.begin(), pair.end());
    std::sort(all.begin(), all.end());
    std::vector<std::vector<std::uint32_t>> wrong(shells_.size());
    std::size_t s = 0, first = 0;
    for (const std::uint32_t f : all) {
      for (; f >= first + shells_[s].result().facets.size(); ++s) first += shells_[s].result().facets.size();
      wrong[s].push_back(static_cast<std::uint32_t>(f - first));
    }
    return wrong;
  }

  const TriangleSoup& given_;
  Progress& progress_;
  std::deque<ShellRemesher> shells_;
};

}  // namespace

RemeshedSurface remesh(const TriangleSoup& manifold, const RemeshOptions& options, Progress& progress) {
  if (!(options.edge > 0) || !std::isfinite(options.edge)) throw Error(ErrorCode::usage, "the edge length to remesh to is not positive", "give a length in the units of the points");
  progress.begin_stage("remeshing");
  return Remesher(manifold, options, progress).run();
}

}  // namespace burnish
