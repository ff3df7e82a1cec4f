// Simplification by CGAL's edge collapse: what one would use without a method of one's own.
//
//   cgal_simplify IN OUT FACETS plane|bounded|lindstrom
//
// Garland & Heckbert's planes, the same with a bound on how far normals may turn, or Lindstrom & Turk. Creases are left to the costs: constrained edges would
// not be thinned. Prints CPU seconds and peak memory as JSON, of the collapse and of the program.
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/GarlandHeckbert_plane_policies.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <fmt/format.h>

#include <cstdlib>
#include <string>

#include "burnish/core/timer.h"
#include "burnish/io/mesh_io.h"
#include "burnish/io/output_file.h"
#include "burnish/surface/weld.h"

namespace burnish::bench {
namespace {

namespace sms = CGAL::Surface_mesh_simplification;
using Kernel = CGAL::Simple_cartesian<double>;
using Mesh = CGAL::Surface_mesh<Kernel::Point_3>;

Mesh mesh_of(const TriangleSoup& soup) {
  Mesh mesh;
  for (const Vec3& p : soup.points) mesh.add_vertex({p.x, p.y, p.z});
  for (const Facet& f : soup.facets) mesh.add_face(Mesh::Vertex_index(f[0]), Mesh::Vertex_index(f[1]), Mesh::Vertex_index(f[2]));
  return mesh;
}

TriangleSoup soup_of(Mesh& mesh) {
  mesh.collect_garbage();
  TriangleSoup soup;
  for (const auto v : mesh.vertices()) soup.points.push_back({mesh.point(v).x(), mesh.point(v).y(), mesh.point(v).z()});
  for (const auto f : mesh.faces()) {
    Facet& facet = soup.facets.emplace_back();
    std::size_t i = 0;
    for (const auto v : CGAL::vertices_around_face(mesh.halfedge(f), mesh)) facet[i++] = v.idx();
  }
  return soup;
}

template <class Cost, class Placement>
void collapse(Mesh& mesh, std::size_t facets, const Cost& cost, const Placement& placement) {
  const sms::Count_stop_predicate<Mesh> stop(facets * 3 / 2);
  sms::edge_collapse(mesh, stop, CGAL::parameters::get_cost(cost).get_placement(placement));
}

void simplify(Mesh& mesh, std::size_t facets, const std::string& method) {
  if (method == "lindstrom") return collapse(mesh, facets, sms::LindstromTurk_cost<Mesh>(), sms::LindstromTurk_placement<Mesh>());
  using Policies = sms::GarlandHeckbert_plane_policies<Mesh, Kernel>;
  const Policies policies(mesh);
  if (method == "plane") return collapse(mesh, facets, policies.get_cost(), policies.get_placement());
  collapse(mesh, facets, policies.get_cost(), sms::Bounded_normal_change_placement<Policies::Get_placement>(policies.get_placement()));
}

}  // namespace
}  // namespace burnish::bench

int main(int argc, char** argv) {
  using namespace burnish;
  if (argc != 5) return 2;
  auto mesh = bench::mesh_of(weld(read_mesh(argv[1]).soup));
  const double start = process_cpu_seconds();
  bench::simplify(mesh, static_cast<std::size_t>(std::atoll(argv[3])), argv[4]);
  fmt::print("{{\"cpu_seconds\": {:.2f}, \"peak_mb\": {:.0f}}}\n", process_cpu_seconds() - start, static_cast<double>(process_peak_bytes()) / 1e6);
  OutputFile file(argv[2], true);
  write_mesh(file.fd(), argv[2], bench::soup_of(mesh), {.format = format_for_writing(argv[2])});
  file.commit();
}
