#include "burnish/extract/trim.h"

#include <algorithm>
#include <unordered_map>

#include "burnish/surface/edge_table.h"
#include "burnish/surface/weld.h"

namespace burnish {
namespace {

constexpr double kFromEnds = 0.02;  // of an edge: cuts stay that far from its ends

class Trimmer {
 public:
  Trimmer(const TriangleSoup& soup, const std::vector<double>& values) : soup_(soup), values_(values) { result_.points = soup.points; }

  TriangleSoup trim() {
    for (const Facet& facet : soup_.facets) {
      const auto kept = std::count_if(facet.begin(), facet.end(), [&](std::uint32_t p) { return stays(p); });
      if (kept == 3) result_.facets.push_back(facet);
      if (kept == 1) cut_to_corner(facet);
      if (kept == 2) cut_off_corner(facet);
    }
    return weld(std::move(result_));
  }

 private:
  bool stays(std::uint32_t p) const { return values_[p] >= 0; }

  // The facet turned so that the corner of which there is one kind only comes first.
  Facet turned_to(Facet facet, bool kind) const {
    while (stays(facet[0]) != kind) std::rotate(facet.begin(), facet.begin() + 1, facet.end());
    return facet;
  }

  void cut_to_corner(const Facet& facet) {
    const auto [a, b, c] = turned_to(facet, true);
    result_.facets.push_back({a, cut(a, b), cut(a, c)});
  }

  void cut_off_corner(const Facet& facet) {
    const auto [a, b, c] = turned_to(facet, false);
    const std::uint32_t ab = cut(a, b), ac = cut(a, c);
    result_.facets.push_back({ab, b, c});
    result_.facets.push_back({ab, c, ac});
  }

  std::uint32_t cut(std::uint32_t p, std::uint32_t q) {
    if (p > q) std::swap(p, q);
    const auto [at, is_new] = cuts_.try_emplace(std::uint64_t{p} << 32 | q, static_cast<std::uint32_t>(result_.points.size()));
    if (is_new) {
      const double t = std::clamp(values_[p] / (values_[p] - values_[q]), kFromEnds, 1 - kFromEnds);
      result_.points.push_back(soup_.points[p] + (soup_.points[q] - soup_.points[p]) * t);
    }
    return at->second;
  }

  const TriangleSoup& soup_;
  const std::vector<double>& values_;
  TriangleSoup result_;
  std::unordered_map<std::uint64_t, std::uint32_t> cuts_;
};

}  // namespace

TriangleSoup trim_negative(const TriangleSoup& welded, const std::vector<double>& values) { return Trimmer(welded, values).trim(); }

}  // namespace burnish
