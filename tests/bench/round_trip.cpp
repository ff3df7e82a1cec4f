// How well a clean part comes back from the level set: normals away from creases, and creases themselves.
//
//   burnish_round_trip cell IN             the cell that resolves the part: min(mean edge / 4, longest side / 256, thinnest wall / 4)
//   burnish_round_trip judge IN OUT CELL   one line of JSON; lengths in cells, angles in degrees
//
// Creases are edges of more than 40 degrees. Lines are compared at points half a cell apart, with the nearest edge of the other surface of more
// than 30 degrees; the difference of dihedral angles is taken there. The thinnest wall is the first percentile of the area's.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "burnish/io/mesh_io.h"
#include "burnish/surface/compare.h"
#include "burnish/surface/creases.h"
#include "burnish/surface/orient.h"
#include "burnish/surface/thickness.h"
#include "burnish/surface/triangle_index.h"
#include "burnish/surface/truth_error.h"
#include "burnish/surface/weld.h"

namespace {

using namespace burnish;

constexpr double kCrease = 40, kFound = 30;
constexpr std::size_t kWalls = 20'000;

TriangleSoup load(const char* path) { return orient(weld(read_mesh(path).soup)).soup; }

double cell_of(const TriangleSoup& part) {
  const std::vector<double> walls = wall_thicknesses(part, kWalls);
  const double thinnest = walls.empty() ? bounding_box(part).diagonal() : walls[walls.size() / 100];
  return std::min({mean_edge_length(part) / 4, bounding_box(part).longest_side() / 256, thinnest / 4});
}

struct CreaseLines {
  CreaseLines(const TriangleSoup& surface, double angle) : soup(surface), creases(find_creases(surface, {.angle = angle})), index(folded(soup, creases)) {}

  double dihedral(std::size_t edge) const {
    const auto& f = creases.edges[edge].facets;
    return angle_in_degrees(facet_normal_2a(soup, f[0]), facet_normal_2a(soup, f[1]));
  }

  const TriangleSoup& soup;
  Creases creases;
  TriangleIndex index;
};

struct Figures {
  double length = 0, squares = 0, farthest = 0;
  std::vector<double> turned;  // differences of dihedral angles

  double rms() const { return length > 0 ? std::sqrt(squares / length) : 0; }
  double quantile(double q) {
    if (turned.empty()) return 0;
    std::sort(turned.begin(), turned.end());
    return turned[static_cast<std::size_t>(q * static_cast<double>(turned.size() - 1))];
  }
};

Figures compare_lines(const CreaseLines& from, const CreaseLines& to, double cell) {
  Figures figures;
  for (std::size_t e = 0; e < from.creases.edges.size(); ++e) {
    const Vec3 a = from.soup.points[from.creases.edges[e].points[0]], b = from.soup.points[from.creases.edges[e].points[1]];
    const auto steps = static_cast<int>(std::ceil(norm(b - a) / (0.5 * cell)));
    for (int i = 0; i < steps; ++i) {
      const auto hit = to.index.closest(a + (b - a) * ((i + 0.5) / steps));
      const double share = norm(b - a) / steps, distance = hit.facet == kNoFacet ? 1e9 : std::sqrt(hit.squared_distance) / cell;
      figures.length += share;
      figures.squares += share * distance * distance;
      figures.farthest = std::max(figures.farthest, distance);
      if (hit.facet != kNoFacet) figures.turned.push_back(std::abs(from.dihedral(e) - to.dihedral(hit.facet)));
    }
  }
  return figures;
}

ClosestQuery query(const TriangleIndex& index) {
  return [&](const Vec3& p) {
    const auto c = index.closest(p);
    return ClosestPoint{c.point, c.squared_distance, c.facet};
  };
}

void judge(const TriangleSoup& part, const TriangleSoup& result, double cell) {
  const TriangleIndex part_index(part), result_index(result);
  const CreaseEdges creases(part, kCrease);
  const TruthError error = truth_error(result, query(result_index), part, query(part_index), creases, {.near_crease = cell});
  const OneSidedDistance in_out = one_sided_distance(part, result_index), out_in = one_sided_distance(result, part_index);
  const CreaseLines truth(part, kCrease), found(result, kFound);
  Figures there = compare_lines(truth, found, cell), back = compare_lines(CreaseLines(result, kCrease), CreaseLines(part, kFound), cell);
  fmt::print("{{\"facets\": {}, \"normals\": {:.3f}, \"normals_near\": {:.3f}, \"in_out_max\": {:.4f}, \"in_out_rms\": {:.4f}, \"out_in_max\": {:.4f}, "
             "\"out_in_rms\": {:.4f}, \"crease_rms\": {:.4f}, \"crease_max\": {:.3f}, \"crease_back_rms\": {:.4f}, \"crease_back_max\": {:.3f}, "
             "\"dihedral_median\": {:.3f}, \"dihedral_95\": {:.3f}, \"dihedral_99\": {:.3f}}}\n",
             result.facets.size(), error.elsewhere.angle(), error.near_creases.angle(), in_out.max / cell, in_out.rms / cell, out_in.max / cell, out_in.rms / cell,
             there.rms(), there.farthest, back.rms(), back.farthest, there.quantile(0.5), there.quantile(0.95), there.quantile(0.99));
}

}  // namespace

int main(int argc, char** argv) try {
  if (argc == 3 && !std::strcmp(argv[1], "cell")) {
    fmt::print("{:.17g}\n", cell_of(load(argv[2])));
    return 0;
  }
  if (argc == 5 && !std::strcmp(argv[1], "judge")) {
    judge(load(argv[2]), load(argv[3]), std::atof(argv[4]));
    return 0;
  }
  fmt::print(stderr, "usage: burnish_round_trip cell IN | judge IN OUT CELL\n");
  return 2;
} catch (const std::exception& error) {
  fmt::print(stderr, "burnish_round_trip: {}\n", error.what());
  return 1;
}
