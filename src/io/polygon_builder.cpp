#include "polygon_builder.h"

#include <fmt/format.h>

#include <algorithm>

#include "counts.h"

namespace burnish {
namespace {

constexpr std::string_view kFacetHint = "re-export the file, or pass --salvage to leave such facets out";

}  // namespace

void PolygonBuilder::add_point(const Vec3& point, const char* at) {
  std::vector<Vec3>& points = file_.soup.points;
  require_room_for_point(source_, at, points.size());
  const bool broken = !is_finite(point);
  if (broken && !source_.salvage)
    source_.fail_at(at, "a point has a coordinate that is missing or not a finite number", kFacetHint);
  if (broken) broken_points_.push_back(static_cast<std::uint32_t>(points.size()));
  points.push_back(broken ? Vec3{} : point);
}

std::string PolygonBuilder::unknown_point(std::int64_t corner) const {
  return fmt::format("a polygon refers to point {} (counted from zero), the file holds {}", corner,
                     file_.soup.points.size());
}

void PolygonBuilder::add_polygon(std::span<const std::int64_t> corners, const char* at) {
  if (corners.size() < 3) return small_.add(at);
  for (const std::int64_t c : corners)
    if (c < 0 || c >= static_cast<std::int64_t>(kMaxFacets)) return add_broken_polygon(at, unknown_point(c));
  std::vector<Facet>& facets = file_.soup.facets;
  require_room_for_facets(source_, at, facets.size(), corners.size());
  const auto point = [&](std::size_t i) { return static_cast<std::uint32_t>(corners[i]); };
  for (std::size_t i = 2; i < corners.size(); ++i) {
    facets.push_back({point(0), point(i - 1), point(i)});
    if (std::max({point(0), point(i - 1), point(i)}) >= point_count())
      forward_.push_back({facets.size() - 1, at});
  }
  if (color_ != kNoColor) file_.soup.colors.resize(facets.size() - (corners.size() - 2), kNoColor);
  if (color_ != kNoColor) file_.soup.colors.resize(facets.size(), color_);
}

void PolygonBuilder::add_broken_polygon(const char* at, const std::string& message) {
  if (!source_.salvage) source_.fail_at(at, message, kFacetHint);
  dropped_.add(at);
}

void PolygonBuilder::begin_group(std::string name) {
  close_group();
  file_.soup.groups.push_back({std::move(name), static_cast<std::uint32_t>(file_.soup.facets.size()), 0});
}

// Ends the last group; one without facets is forgotten.
void PolygonBuilder::close_group() {
  std::vector<FacetGroup>& groups = file_.soup.groups;
  const auto facets = static_cast<std::uint32_t>(file_.soup.facets.size());
  if (groups.empty() && facets > 0) groups.push_back({"", 0, 0});
  if (groups.empty()) return;
  groups.back().facet_count = facets - groups.back().first_facet;
  if (groups.back().facet_count == 0) groups.pop_back();
}

bool PolygonBuilder::is_kept(const Facet& facet) const {
  return std::all_of(facet.begin(), facet.end(), [&](std::uint32_t p) {
    return p < point_count() && !std::binary_search(broken_points_.begin(), broken_points_.end(), p);
  });
}

void PolygonBuilder::check_forward_references() {
  for (const Forward& f : forward_) {
    const Facet& facet = file_.soup.facets[f.facet];
    const std::uint32_t last = *std::max_element(facet.begin(), facet.end());
    if (last < point_count()) continue;
    if (!source_.salvage) source_.fail_at(f.at, unknown_point(last), kFacetHint);
    dropped_.add(f.at);
  }
}

void PolygonBuilder::drop_broken_facets() {
  TriangleSoup& soup = file_.soup;
  std::vector<Facet> kept;
  std::vector<Color> kept_colors;
  const auto keep_range = [&](std::size_t begin, std::size_t end) {
    for (std::size_t f = begin; f < end; ++f) {
      if (!is_kept(soup.facets[f])) continue;
      kept.push_back(soup.facets[f]);
      if (!soup.colors.empty()) kept_colors.push_back(soup.colors[f]);
    }
  };
  if (soup.groups.empty()) keep_range(0, soup.facets.size());
  for (FacetGroup& g : soup.groups) {
    const auto first = static_cast<std::uint32_t>(kept.size());
    keep_range(g.first_facet, g.first_facet + g.facet_count);
    g = {std::move(g.name), first, static_cast<std::uint32_t>(kept.size()) - first};
  }
  std::erase_if(soup.groups, [](const FacetGroup& g) { return g.facet_count == 0; });
  soup.facets = std::move(kept);
  soup.colors = std::move(kept_colors);
}

MeshFile PolygonBuilder::finish(MeshFormat format) {
  file_.format = format;
  if (!file_.soup.groups.empty()) close_group();
  if (!file_.soup.colors.empty()) file_.soup.colors.resize(file_.soup.facets.size(), kNoColor);
  check_forward_references();
  if (dropped_.count() > 0 || !broken_points_.empty()) drop_broken_facets();
  if (!broken_points_.empty())
    add_warning(fmt::format("left out {} with coordinates that are not finite numbers, and their facets",
                            counted(broken_points_.size(), "point")));
  if (dropped_.count() > 0)
    add_warning(fmt::format("left out {}, the first at {}", counted(dropped_.count(), "broken polygon"),
                            source_.place(dropped_.first())));
  if (small_.count() > 0)
    add_warning(fmt::format("left out {} of fewer than three corners, the first at {}",
                            counted(small_.count(), "polygon"), source_.place(small_.first())));
  return std::move(file_);
}

}  // namespace burnish
