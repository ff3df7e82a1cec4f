#include "html_marks.h"

#include <algorithm>
#include <span>

#include "burnish/pipeline/html_report.h"

namespace burnish {
namespace {

constexpr std::size_t kMostDrawn = 100'000;

bool has_defects(const Defects& d) {
  return d.degenerate_facets + d.duplicate_facets + d.open_edges + d.non_manifold_edges + d.non_manifold_points + d.misoriented_edges + d.self_intersecting_pairs > 0;
}

// The middle of what the kind's elements are: edges, facets, or points (nothing is drawn for these but the mark itself).
std::span<const DefectiveEdge> edges_of(const HtmlMarks& marks, DefectKind kind) {
  const DefectiveElements& e = marks.inspection.elements;
  if (kind == DefectKind::open_loop) return e.open_edges;
  if (kind == DefectKind::non_manifold_edge) return e.non_manifold_edges;
  if (kind == DefectKind::misoriented_edge) return e.misoriented_edges;
  return {};
}

std::span<const std::uint32_t> facets_of(const HtmlMarks& marks, DefectKind kind) {
  const DefectiveElements& e = marks.inspection.elements;
  if (kind == DefectKind::degenerate_facet) return e.degenerate_facets;
  if (kind == DefectKind::duplicate_facet) return e.duplicate_facets;
  if (kind == DefectKind::self_intersection) return marks.map.intersecting_facets;
  return {};
}

Vec3 unit_normal(const TriangleSoup& soup, std::uint32_t facet) {
  if (facet >= soup.facets.size()) return {};
  const Vec3 normal = facet_normal_2a(soup, facet);
  const double length = norm(normal);
  return length > 0 ? normal / length : Vec3{};
}

Json json_of(const TriangleSoup& soup, const LocatedDefect& d) {
  const Vec3 reach = max(d.box.upper - d.position, d.position - d.box.lower);
  return {{"position", burnish::json_of(d.position)}, {"normal", burnish::json_of(unit_normal(soup, d.facet))}, {"radius", norm(reach)},
          {"count", d.count}, {"length", d.length}, {"area", d.area}};
}

Json listed(const TriangleSoup& soup, std::span<const LocatedDefect> defects) {
  Json list = Json::array();
  for (const LocatedDefect& d : defects.first(std::min(defects.size(), kMostListedDefects))) list.push_back(json_of(soup, d));
  return list;
}

std::vector<Vec3> corners_of(const TriangleSoup& soup, std::span<const DefectiveEdge> edges) {
  std::vector<Vec3> corners;
  for (const DefectiveEdge& e : edges.first(std::min(edges.size(), kMostDrawn)))
    for (const std::uint32_t p : e.points) corners.push_back(soup.points[p]);
  return corners;
}

std::vector<Vec3> corners_of(const TriangleSoup& soup, std::span<const std::uint32_t> facets) {
  std::vector<Vec3> corners;
  for (const std::uint32_t f : facets.first(std::min(facets.size(), kMostDrawn)))
    for (const std::uint32_t p : soup.facets[f]) corners.push_back(soup.points[p]);
  return corners;
}

}  // namespace

HtmlMarks find_marks(const TriangleSoup& welded, const Defects& counted, Progress& progress) {
  HtmlMarks marks;
  if (welded.facets.empty() || !has_defects(counted)) return marks;
  QuietProgress quiet(progress);
  marks.inspection = inspect(welded, {.self_intersections = counted.self_intersecting_pairs > 0, .elements = true}, quiet);
  marks.map = locate_defects(welded, marks.inspection);
  return marks;
}

std::vector<bool> marked_points(const TriangleSoup& welded, const HtmlMarks& marks) {
  if (marks.map.defects.empty()) return {};
  std::vector<bool> marked(welded.points.size());
  for (const DefectKind kind : kAllDefectKinds) {
    for (const DefectiveEdge& e : edges_of(marks, kind))
      for (const std::uint32_t p : e.points) marked[p] = true;
    for (const std::uint32_t f : facets_of(marks, kind))
      for (const std::uint32_t p : welded.facets[f]) marked[p] = true;
  }
  return marked;
}

Json json_of(const TriangleSoup& welded, const HtmlMarks& marks, const Quantisation& quantisation) {
  Json kinds = Json::object();
  for (const DefectKind kind : kAllDefectKinds) {
    const std::span<const LocatedDefect> defects = marks.map.of(kind);
    if (defects.empty()) continue;
    Json& j = kinds[std::string(name(kind))] = {{"total", defects.size()}, {"listed", listed(welded, defects)}};
    const std::vector<Vec3> lines = corners_of(welded, edges_of(marks, kind)), triangles = corners_of(welded, facets_of(marks, kind));
    if (!lines.empty()) j["lines"] = {{"count", lines.size() / 2}, {"corners", encoded_points(lines, quantisation)}};
    if (!triangles.empty()) j["triangles"] = {{"count", triangles.size() / 3}, {"corners", encoded_points(triangles, quantisation)}};
  }
  return kinds;
}

}  // namespace burnish
