#include "html_reduce.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <compare>

#include "burnish/core/parallel.h"

namespace burnish {
namespace {

constexpr double kFirstCell = 0.9;    // of sqrt(2 area / facets)
constexpr double kWiden = 1.25;       // of the cells, if there are too many facets
constexpr int kGrids = 40;            // widened by 1.25^40 = 7500 in the end, kept points given up long before
constexpr int kGridsWithKept = 6;
constexpr double kMostCells = 1 << 20;  // along a side, so that three numbers of cells and an octant fit into 64 bits

struct Key {
  std::uint64_t cell = 0;
  std::uint32_t point = 0;
  auto operator<=>(const Key&) const = default;
};

// Which way the surface looks at each point: a bit for the sign of each axis.
std::vector<std::uint8_t> octants(const TriangleSoup& soup) {
  std::vector<Vec3> normals(soup.points.size());
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) normals[p] += facet_normal_2a(soup, f);
  std::vector<std::uint8_t> result(normals.size());
  for (std::size_t p = 0; p < normals.size(); ++p) result[p] = static_cast<std::uint8_t>((normals[p].x < 0) | (normals[p].y < 0) << 1 | (normals[p].z < 0) << 2);
  return result;
}

std::uint64_t cell_of(const Vec3& p, std::uint64_t octant, const Vec3& lower, double cell) {
  std::uint64_t key = octant;
  for (int axis = 0; axis < 3; ++axis) key = key << 20 | static_cast<std::uint64_t>(std::min((p[axis] - lower[axis]) / cell, kMostCells - 1));
  return key;
}

// The facets left where points are replaced by those of their clusters.
void relink(const TriangleSoup& soup, const std::vector<std::uint32_t>& cluster, std::vector<Facet>& facets) {
  for (Facet f : soup.facets) {
    for (std::uint32_t& p : f) p = cluster[p];
    if (f[0] != f[1] && f[1] != f[2] && f[2] != f[0]) facets.push_back(f);
  }
}

struct Grid {
  Vec3 lower;
  double cell = 0;
};

TriangleSoup clustered(const TriangleSoup& soup, const Grid& grid, const std::vector<std::uint8_t>& octant, const std::vector<bool>& kept) {
  std::vector<Key> keys(soup.points.size());
  parallel_for(keys.size(), [&](std::size_t p) { keys[p] = {cell_of(soup.points[p], octant[p], grid.lower, grid.cell), static_cast<std::uint32_t>(p)}; });
  parallel_sort(keys);
  TriangleSoup result;
  std::vector<std::uint32_t> cluster(soup.points.size());
  for (std::size_t i = 0; i < keys.size();) {
    std::size_t members = 0;
    Vec3 sum;
    const auto mean = static_cast<std::uint32_t>(result.points.size());
    result.points.emplace_back();
    for (const std::uint64_t cell = keys[i].cell; i < keys.size() && keys[i].cell == cell; ++i) {
      const std::uint32_t p = keys[i].point;
      if (!kept.empty() && kept[p]) {
        cluster[p] = static_cast<std::uint32_t>(result.points.size());
        result.points.push_back(soup.points[p]);
        continue;
      }
      cluster[p] = mean;
      sum += soup.points[p];
      ++members;
    }
    if (members > 0) result.points[mean] = sum / static_cast<double>(members);
  }
  relink(soup, cluster, result.facets);
  return result;
}

}  // namespace

TriangleSoup reduced_for_drawing(const TriangleSoup& welded, std::size_t facets, const std::vector<bool>& kept) {
  if (welded.facets.size() <= facets) return {welded.points, welded.facets, {}, {}};
  const Box3 box = bounding_box(welded);
  const std::vector<std::uint8_t> octant = octants(welded);
  Grid grid{box.lower, std::max(kFirstCell * std::sqrt(2 * area(welded) / static_cast<double>(facets)), box.longest_side() / kMostCells)};
  TriangleSoup result;
  for (int i = 0; i < kGrids; ++i, grid.cell *= kWiden) {
    result = clustered(welded, grid, octant, i < kGridsWithKept ? kept : std::vector<bool>{});
    if (result.facets.size() <= facets) return result;
  }
  // What no grid thins out is drawn in part.
  result.facets.resize(facets);
  return result;
}

}  // namespace burnish
