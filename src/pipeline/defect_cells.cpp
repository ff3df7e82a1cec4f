#include "defect_cells.h"

#include <string>

namespace burnish {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;

// In the order of DefectKind; told apart by the colour-blind, too.
constexpr std::array<std::array<std::uint8_t, 3>, kDefectKinds> kColors = {{
    {214, 39, 40},    // open_loop: red
    {148, 103, 189},  // non_manifold_edge: purple
    {227, 119, 194},  // non_manifold_point: pink
    {31, 119, 180},   // misoriented_edge: blue
    {140, 86, 75},    // degenerate_facet: brown
    {23, 190, 207},   // duplicate_facet: cyan
    {255, 127, 14},   // self_intersection: orange
}};

class CellMaker {
 public:
  CellMaker(const TriangleSoup& soup, const DefectMap& map)
      : soup_(soup), map_(map), point_of_(soup.points.size(), kNone) {
    cells_.mark_name = "defect";
    for (const DefectKind kind : kAllDefectKinds)
      cells_.kinds.push_back({std::string(name(kind)), kColors[static_cast<std::size_t>(kind)]});
  }

  void add_positions() {
    for (const LocatedDefect& defect : map_.defects) {
      cells_.verts.push_back(static_cast<std::uint32_t>(cells_.points.size()));
      cells_.points.push_back(defect.position);
      cells_.marks.push_back({static_cast<std::uint32_t>(defect.kind), cells_.verts.back()});
    }
  }

  void add_lines(DefectKind kind, const std::vector<DefectiveEdge>& edges) {
    for (const auto& [points, facet] : edges) cells_.lines.push_back({point(points[0]), point(points[1])});
    add_marks(kind);
  }

  void add_polys(DefectKind kind, const std::vector<std::uint32_t>& facets) {
    for (const std::uint32_t f : facets) {
      const Facet& corners = soup_.facets[f];
      cells_.polys.push_back({point(corners[0]), point(corners[1]), point(corners[2])});
    }
    add_marks(kind);
  }

  MarkedCells take() { return std::move(cells_); }

 private:
  std::uint32_t point(std::uint32_t p) {
    if (point_of_[p] == kNone) {
      point_of_[p] = static_cast<std::uint32_t>(cells_.points.size());
      cells_.points.push_back(soup_.points[p]);
    }
    return point_of_[p];
  }

  void add_marks(DefectKind kind) {
    const auto k = static_cast<std::uint32_t>(kind);
    for (const std::uint32_t defect : map_.defect_of_element[k]) cells_.marks.push_back({k, defect});
  }

  const TriangleSoup& soup_;
  const DefectMap& map_;
  std::vector<std::uint32_t> point_of_;
  MarkedCells cells_;
};

}  // namespace

MarkedCells defect_cells(const TriangleSoup& welded, const DefectiveElements& elements,
                         const DefectMap& map) {
  CellMaker maker(welded, map);
  maker.add_positions();
  maker.add_lines(DefectKind::open_loop, elements.open_edges);
  maker.add_lines(DefectKind::non_manifold_edge, elements.non_manifold_edges);
  maker.add_lines(DefectKind::misoriented_edge, elements.misoriented_edges);
  maker.add_polys(DefectKind::degenerate_facet, elements.degenerate_facets);
  maker.add_polys(DefectKind::duplicate_facet, elements.duplicate_facets);
  maker.add_polys(DefectKind::self_intersection, map.intersecting_facets);
  return maker.take();
}

}  // namespace burnish
