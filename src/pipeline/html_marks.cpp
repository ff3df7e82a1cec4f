#include "html_marks.h"

#include <algorithm>
#include <span>

#include "burnish/pipeline/html_report.h"
#include "burnish/surface/facet_normals.h"

namespace burnish {
namespace {

constexpr std::size_t kMostDrawn = 100'000;

bool has_defects(const Defects& d) {
  return d.degenerate_facets + d.duplicate_facets + d.open_edges + d.non_manifold_edges + d.non_manifold_points + d.misoriented_edges + d.self_intersecting_pairs > 0;
}

// The elements of a kind are edges, facets, or points; for these nothing is drawn but a dot.
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

// Of each listed defect the mean of its facets' normals: where to look from. That of one facet if they cancel each other, or if it has but one.
std::vector<Vec3> normals_of(const TriangleSoup& soup, const HtmlMarks& marks, DefectKind kind, std::span<const LocatedDefect> listed) {
  const auto edges = edges_of(marks, kind);
  const auto facets = facets_of(marks, kind);
  const auto first = static_cast<std::size_t>(listed.data() - marks.map.defects.data());
  const std::vector<std::uint32_t>& defect = marks.map.defect_of_element[static_cast<std::size_t>(kind)];
  std::vector<Vec3> normals(listed.size());
  for (std::size_t i = 0; i < edges.size() + facets.size(); ++i)
    if (defect[i] - first < listed.size()) normals[defect[i] - first] += unit_normal(soup, edges.empty() ? facets[i] : edges[i].facet);
  for (std::size_t d = 0; d < listed.size(); ++d) {
    const double length = norm(normals[d]);
    normals[d] = length > 0.1 ? normals[d] / length : unit_normal(soup, listed[d].facet);
  }
  return normals;
}

Json listed(const TriangleSoup& soup, const HtmlMarks& marks, DefectKind kind) {
  std::span<const LocatedDefect> defects = marks.map.of(kind);
  defects = defects.first(std::min(defects.size(), kMostListedDefects));
  const std::vector<Vec3> normals = normals_of(soup, marks, kind, defects);
  Json list = Json::array();
  for (std::size_t i = 0; i < defects.size(); ++i) {
    const LocatedDefect& d = defects[i];
    const Vec3 reach = max(d.box.upper - d.position, d.position - d.box.lower);
    list.push_back({{"position", json_of(d.position)}, {"normal", json_of(normals[i])}, {"radius", norm(reach)}, {"count", d.count}, {"length", d.length}, {"area", d.area}});
  }
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

HtmlMarks find_marks(const TriangleSoup& welded, const Defects& counted, const std::vector<std::array<std::uint32_t, 2>>& intersecting, Progress& progress) {
  HtmlMarks marks;
  if (welded.facets.empty() || !has_defects(counted)) return marks;
  QuietProgress quiet(progress);
  marks.inspection = inspect(welded, {.self_intersections = intersecting.empty() && counted.self_intersecting_pairs > 0, .elements = true}, quiet);
  if (!intersecting.empty()) marks.inspection.self_intersections = intersecting;
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
    Json& j = kinds[std::string(name(kind))] = {{"total", defects.size()}, {"listed", listed(welded, marks, kind)}};
    const std::vector<Vec3> lines = corners_of(welded, edges_of(marks, kind)), triangles = corners_of(welded, facets_of(marks, kind));
    if (!lines.empty()) j["lines"] = {{"count", lines.size() / 2}, {"corners", encoded_points(lines, quantisation)}};
    if (!triangles.empty()) j["triangles"] = {{"count", triangles.size() / 3}, {"corners", encoded_points(triangles, quantisation)}};
  }
  return kinds;
}

}  // namespace burnish
