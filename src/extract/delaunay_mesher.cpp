// Mesh_3 of CGAL, for the surface alone.
//
// One call per facet instead of two: the domain says in one answer whether and where a dual edge meets the surface.
#define CGAL_MESH_3_NO_LONGER_CALLS_DO_INTERSECT_3

#include "delaunay_mesher.h"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_domain_with_polyline_features_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Spatial_sort_traits_adapter_3.h>
#include <CGAL/make_mesh_3.h>
#include <CGAL/property_map.h>
#include <CGAL/spatial_sort.h>
#include <CGAL/version.h>

#include <cmath>
#include <limits>
#include <memory>
#include <numeric>
#include <optional>
#include <tuple>
#include <utility>

#include "seeds.h"

namespace burnish::detail {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Labeled = CGAL::Labeled_mesh_domain_3<Kernel>;

Vec3 from_cgal(const Kernel::Point_3& p) { return {p.x(), p.y(), p.z()}; }
Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x, p.y, p.z}; }

// CGAL's domain of labels, 0 outside and 1 inside, with our search for crossings in place of its bisection.
class FieldDomain : public Labeled {
 public:
  FieldDomain(FieldSampler* field, const CGAL::Bbox_3& box)
      : Labeled([field](const Kernel::Point_3& p) { return field->is_inside(from_cgal(p)) ? 1 : 0; }, box), field_(field), cuboid_(box) {}

  class Construct_intersection {
   public:
    explicit Construct_intersection(const FieldDomain& domain) : domain_(domain) {}
    Intersection operator()(const Kernel::Segment_3& s) const {
      const std::optional<Vec3> p = domain_.field_->crossing(from_cgal(s.source()), from_cgal(s.target()));
      if (!p) return {};
      return Intersection(to_cgal(*p), domain_.index_from_surface_patch_index({0, 1}), 2);
    }
    Intersection operator()(const Kernel::Ray_3& r) const { return clipped(r); }
    Intersection operator()(const Kernel::Line_3& l) const { return clipped(l); }

   private:
    template <class Query>
    Intersection clipped(const Query& query) const {
      const auto part = CGAL::intersection(query, domain_.cuboid_);
      if (!part) return {};
#if CGAL_VERSION_NR >= 1060000000
      const auto* s = std::get_if<Kernel::Segment_3>(&*part);
#else
      const auto* s = boost::get<Kernel::Segment_3>(&*part);
#endif
      return s ? (*this)(*s) : Intersection();
    }
    const FieldDomain& domain_;
  };
  Construct_intersection construct_intersection_object() const { return Construct_intersection(*this); }

  bool is_inside(const Kernel::Point_3& p) const { return field_->is_inside(from_cgal(p)); }

 private:
  FieldSampler* field_;
  Kernel::Iso_cuboid_3 cuboid_;
};

using Domain = CGAL::Mesh_domain_with_polyline_features_3<FieldDomain>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain, CGAL::Default, CGAL::Sequential_tag>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation, Domain::Corner_index, Domain::Curve_index>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using EdgeCriteria = CGAL::Mesh_edge_criteria_3<Triangulation>;
using FacetCriteria = CGAL::Mesh_facet_criteria_3<Triangulation>;
using CellCriteria = CGAL::Mesh_cell_criteria_3<Triangulation>;
struct TooManyPoints {};

using Vertex = Triangulation::Vertex_handle;

// The size of facets by place.
struct Sizing {
  using FT = Kernel::FT;
  using Point_3 = Kernel::Point_3;
  using Index = Domain::Index;
  const std::function<double(const Vec3&)>* size;
  FT operator()(const Point_3& p, int, const Index&) const { return (*size)(from_cgal(p)); }
};

Criteria criteria_of(const MesherRequest& r) {
  const FacetCriteria facets = r.sizing ? FacetCriteria(r.min_angle, Sizing{&r.sizing}, r.distance) : FacetCriteria(r.min_angle, r.facet_size, r.distance);
  const EdgeCriteria edges = r.sizing ? EdgeCriteria(Sizing{&r.sizing}) : EdgeCriteria(r.edge_size > 0 ? r.edge_size : r.facet_size);
  return Criteria(edges, facets, CellCriteria(0, 0));
}

CGAL::Bbox_3 bbox_of(const Box3& box) { return {box.lower.x, box.lower.y, box.lower.z, box.upper.x, box.upper.y, box.upper.z}; }

void add_creases(const MesherRequest& request, Domain& domain) {
  std::vector<std::vector<Kernel::Point_3>> curves;
  for (const std::vector<Vec3>& crease : request.creases) {
    curves.emplace_back();
    for (const Vec3& p : crease) curves.back().push_back(to_cgal(p));
  }
  domain.add_features(curves.begin(), curves.end());
}

std::vector<std::pair<Vec3, double>> balls_of(const Complex& complex) {
  std::vector<std::pair<Vec3, double>> balls;
  const Triangulation& t = complex.triangulation();
  for (auto v = t.finite_vertices_begin(); v != t.finite_vertices_end(); ++v)
    balls.emplace_back(from_cgal(v->point().point()), std::sqrt(v->point().weight()));
  return balls;
}

// Along a space-filling curve, so that each is near to the one before it.
void insert_seeds(const std::vector<Vec3>& seeds, const Domain& domain, Complex& complex) {
  std::vector<Kernel::Point_3> points;
  points.reserve(seeds.size());
  for (const Vec3& p : seeds) points.push_back(to_cgal(p));
  std::vector<std::size_t> order(points.size());
  std::iota(order.begin(), order.end(), std::size_t{0});
  using Map = CGAL::Pointer_property_map<Kernel::Point_3>::type;
  const CGAL::Spatial_sort_traits_adapter_3<Kernel, Map> traits(CGAL::make_property_map(points));
  CGAL::spatial_sort(order.begin(), order.end(), traits);
  Triangulation::Cell_handle near;
  for (const std::size_t i : order) {
    const Vertex v = complex.triangulation().insert(Triangulation::Weighted_point(points[i]), near);
    if (v == Vertex()) continue;  // hidden by a protecting ball
    near = v->cell();
    if (complex.in_dimension(v) >= 0 && complex.in_dimension(v) < 2) continue;
    complex.set_dimension(v, 2);
    complex.set_index(v, domain.index_from_surface_patch_index({0, 1}));
  }
}

bool is_outside(const Triangulation& t, const Domain& domain, Triangulation::Cell_handle c) {
  return t.is_infinite(c) || !domain.is_inside(t.dual(c));
}

// Facets in the order of the triangulation's container, which is that of creation; points in the order in which facets use them.
MesherResult facets_of(const Complex& complex, const Domain& domain) {
  MesherResult result;
  const Triangulation& t = complex.triangulation();
  constexpr std::uint32_t none = std::numeric_limits<std::uint32_t>::max();
  std::vector<std::uint32_t> number;
  const auto number_of = [&](Vertex v) {
    const std::size_t stamp = v->time_stamp();
    if (stamp >= number.size()) number.resize(2 * stamp + 1, none);
    if (number[stamp] == none) {
      number[stamp] = static_cast<std::uint32_t>(result.soup.points.size());
      result.soup.points.push_back(from_cgal(v->point().point()));
      result.on_crease.push_back(v->in_dimension() < 2);
    }
    return number[stamp];
  };
  for (auto f = complex.facets_in_complex_begin(); f != complex.facets_in_complex_end(); ++f) {
    Facet facet;
    for (int i = 0; i < 3; ++i) facet[static_cast<std::size_t>(i)] = number_of(f->first->vertex(Triangulation::vertex_triple_index(f->second, i)));
    // vertex_triple_index turns counter-clockwise seen from the cell: outwards if that is outside.
    if (!is_outside(t, domain, f->first)) std::swap(facet[1], facet[2]);
    result.soup.facets.push_back(facet);
  }
  return result;
}

// Adds points until all facets meet the criteria. Not until the surface is a manifold as well: looking for where it is not costs a third of all time, and
// on rough fields there was no end to it.
void refine(const MesherRequest& request, const Domain& domain, const Criteria& criteria, Complex& complex) {
  namespace p = CGAL::parameters;
  CGAL::Mesh_error_code code = CGAL::CGAL_MESH_3_NO_ERROR;
#if CGAL_VERSION_NR >= 1060000000
  const auto limits = p::maximal_number_of_vertices(request.max_points).pointer_to_error_code(&code);
  CGAL::refine_mesh_3(complex, domain, criteria, p::no_perturb().no_exude().surface_only().mesh_3_options(limits));
#else
  const auto limits = p::mesh_3_options(p::maximal_number_of_vertices = request.max_points, p::pointer_to_error_code = &code);
  CGAL::refine_mesh_3(complex, domain, criteria, p::no_perturb(), p::no_exude(), p::no_reset_c3t3(), limits, p::non_manifold());
#endif
  if (code != CGAL::CGAL_MESH_3_NO_ERROR) throw TooManyPoints{};
}

void protect_creases(const MesherRequest& request, const Criteria& criteria, Domain& domain, Complex& complex) {
  if (request.creases.empty()) return;
  add_creases(request, domain);
  CGAL::Mesh_error_code code = CGAL::CGAL_MESH_3_NO_ERROR;
  CGAL::Mesh_3::internal::init_c3t3_with_features(complex, domain, criteria, false, request.max_points, &code);
  if (code != CGAL::CGAL_MESH_3_NO_ERROR) throw TooManyPoints{};
}

MesherResult mesh(FieldSampler& field, const MesherRequest& request, const SeedsFor& seeds_for) {
  Domain domain(&field, bbox_of(request.box));
  const Criteria criteria = criteria_of(request);
  Complex complex;
  protect_creases(request, criteria, domain, complex);
  insert_seeds(seeds_for(balls_of(complex)), domain, complex);
  refine(request, domain, criteria, complex);
  return facets_of(complex, domain);
}

}  // namespace

MesherResult mesh_surface(FieldSampler& field, const MesherRequest& request, const SeedsFor& seeds_for) {
  MesherResult failed;
  try {
    return mesh(field, request, seeds_for);
  } catch (const TooManyPoints&) {
    failed.failure = "more than " + std::to_string(request.max_points) + " points";
    failed.at_limit = true;
  } catch (const TooManyCalls&) {
    failed.failure = "more evaluations of the field than allowed";
    failed.at_limit = true;
  } catch (const CGAL::Failure_exception& e) {
    failed.failure = std::string("the mesher gave up: ") + e.what();
  }
  return failed;
}

}  // namespace burnish::detail
