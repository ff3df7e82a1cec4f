#include "burnish/pipeline/html_report.h"

#include <algorithm>
#include <cmath>

#include "burnish/core/parallel.h"
#include "burnish/surface/signed_deviation.h"
#include "burnish/surface/triangle_index.h"
#include "html_assets.h"
#include "html_encode.h"
#include "html_marks.h"
#include "html_reduce.h"
#include "json.h"

namespace burnish {
namespace {

constexpr double kShownShare = 0.98;  // of the drawn points are within the scale of colours; those beyond have its ends

constexpr double kNothing = 1e-6;      // of the diagonal: distances below it are those of rounding
constexpr double kOnEdge = 1e-9;       // of the diagonal

struct Side {  // NOLINT(bugprone-exception-escape): its move is that of Json, which does not throw
  TriangleSoup drawn;  // ordered by first use
  Json json;
  std::vector<DefectiveEdge> open_edges;
};

Json json_of_mesh(const TriangleSoup& drawn, std::size_t facets, const Quantisation& quantisation) {
  return {{"lower", json_of(quantisation.lower)},
          {"step", json_of(quantisation.step)},
          {"points", drawn.points.size()},
          {"facets", drawn.facets.size()},
          {"facets_of_whole", facets},
          {"positions", encoded_points(drawn.points, quantisation)},
          {"indices", deflated_base64(packed_indices(drawn.facets))}};
}

Side draw(const TriangleSoup& soup, const Defects& counted, const std::vector<std::array<std::uint32_t, 2>>& intersecting, Progress& progress) {
  HtmlMarks marks = find_marks(soup, counted, intersecting, progress);
  progress.check();
  Side side;
  side.drawn = ordered_by_first_use(reduced_for_drawing(soup, kMostDrawnFacets, marked_points(soup, marks)));
  const Quantisation quantisation = Quantisation::of(bounding_box(soup));
  side.json = json_of_mesh(side.drawn, soup.facets.size(), quantisation);
  side.json["marks"] = json_of(soup, marks, quantisation);
  side.open_edges = std::move(marks.inspection.elements.open_edges);
  return side;
}

// 1, 2 or 5 times a power of ten, not below `value`.
double round_scale(double value) {
  const double power = std::pow(10, std::floor(std::log10(value)));
  for (const double digit : {1.0, 2.0, 5.0, 10.0})
    if (digit * power >= value * (1 - 1e-12)) return digit * power;
  return value;
}

// What the colours reach to: most of the points, but something where there is something at all, and never as little as rounding makes.
double scale_of(std::vector<double> distances, double most, double diagonal) {
  if (!(most > kNothing * diagonal)) return diagonal > 0 ? round_scale(kNothing * diagonal) : 0;
  for (double& d : distances) d = std::abs(d);
  const auto at = distances.begin() + static_cast<std::ptrdiff_t>(kShownShare * static_cast<double>(distances.size() - 1));
  std::nth_element(distances.begin(), at, distances.end());
  return round_scale(*at > 1e-3 * most ? *at : most);
}

double distance_to_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const Vec3 along = b - a;
  const double length = squared_norm(along);
  const double t = length > 0 ? std::clamp(dot(p - a, along) / length, 0.0, 1.0) : 0;
  return norm(p - (a + t * along));
}

// Of each point 1 if what is closest to it lies on an open edge, away from the point: there is no surface opposite, such as where a hole was filled.
Bytes beyond_border(const std::vector<Vec3>& points, const TriangleSoup& before, const TriangleIndex& index, const std::vector<DefectiveEdge>& open_edges) {
  const double diagonal = bounding_box(before).diagonal();
  std::vector<std::uint32_t> first(before.facets.size() + 1);  // of each facet's open edges, which are sorted by it
  std::vector<DefectiveEdge> edges = open_edges;
  std::stable_sort(edges.begin(), edges.end(), [](const DefectiveEdge& a, const DefectiveEdge& b) { return a.facet < b.facet; });
  for (const DefectiveEdge& e : edges) ++first[e.facet];
  exclusive_scan_in_place(first);
  Bytes beyond(points.size());
  parallel_for(points.size(), [&](std::size_t i) {
    const TriangleIndex::Closest c = index.closest(points[i]);
    if (c.facet == kNoFacet || c.squared_distance <= kNothing * kNothing * diagonal * diagonal) return;
    for (std::uint32_t e = first[c.facet]; e < first[c.facet + 1]; ++e)
      if (distance_to_segment(c.point, before.points[edges[e].points[0]], before.points[edges[e].points[1]]) <= kOnEdge * diagonal) beyond[i] = 1;
  });
  return beyond;
}

Json deviation_of(const TriangleSoup& drawn, const TriangleSoup& before, const std::vector<DefectiveEdge>& open_edges) {
  if (drawn.points.empty() || before.facets.empty()) return nullptr;
  const TriangleIndex index(before);
  const auto closest = [&](const Vec3& p) {
    const TriangleIndex::Closest c = index.closest(p);
    return ClosestPoint{c.point, c.squared_distance, c.facet};
  };
  const std::vector<double> distances = signed_deviation(drawn.points, before, index, closest, side_rule(before));
  double least = 0, most = 0;
  for (const double d : distances) {
    least = std::min(least, d);
    most = std::max(most, d);
  }
  const double largest = std::max(-least, most), diagonal = bounding_box(before).diagonal();
  Json json = {{"least", least}, {"most", most}, {"largest", largest}, {"differs", largest > kNothing * diagonal}, {"scale", scale_of(distances, largest, diagonal)},
               {"values", encoded_values(distances, largest)}, {"beyond_border", 0}};
  if (open_edges.empty()) return json;
  const Bytes beyond = beyond_border(drawn.points, before, index, open_edges);
  json["beyond_border"] = std::count(beyond.begin(), beyond.end(), 1);
  json["border"] = deflated_base64(beyond);
  return json;
}

Json drawing_of(const RepairReport& report, const CleanSurfaces& surfaces, Progress& progress) {
  const Side before = draw(surfaces.before, report.before, surfaces.intersecting_before, progress), after = draw(surfaces.after, report.after, {}, progress);
  progress.check();
  return {{"before", before.json}, {"after", after.json}, {"deviation", deviation_of(after.drawn, surfaces.before, before.open_edges)}};
}

// JSON that ends no script element, whatever it tells of: '<' stands in its strings only.
std::string within_script(std::string_view json) {
  std::string text;
  text.reserve(json.size());
  for (const char c : json) c == '<' ? text += "\\u003c" : text += c;
  return text;
}

// The template with each {{name}} replaced, by data or by the file of that name.
std::string filled_page(const std::string& report, const std::string& drawing) {
  std::string text;
  std::string_view rest = html_asset("page.html");
  for (std::size_t at; (at = rest.find("{{")) != std::string_view::npos;) {
    const std::size_t end = rest.find("}}", at);
    const std::string_view name = rest.substr(at + 2, end - at - 2);
    text += rest.substr(0, at);
    text += name == "report" ? std::string_view(report) : name == "drawing" ? std::string_view(drawing) : html_asset(name);
    rest.remove_prefix(end + 2);
  }
  return text.append(rest);
}

}  // namespace

std::string html_report(const RepairReport& report, const CleanSurfaces& surfaces, Progress& progress) {
  const std::string drawing = drawing_of(report, surfaces, progress).dump(-1, ' ', false, Json::error_handler_t::replace);
  return filled_page(within_script(to_json(report)), within_script(drawing));
}

}  // namespace burnish
