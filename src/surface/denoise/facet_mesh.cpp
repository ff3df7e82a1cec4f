#include "facet_mesh.h"

#include <algorithm>

#include "burnish/core/parallel.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/winding.h"

namespace burnish::denoising {
namespace {

// Rows that `fill(i, row)` appends to, sorted and without repetition.
template <class Fill>
Rows rows_of(std::size_t count, Fill&& fill) {
  Rows rows;
  rows.first.assign(count + 1, 0);
  std::vector<std::vector<std::uint32_t>> parts((count + kDefaultGrain - 1) / kDefaultGrain);
  parallel_ranges(count, kDefaultGrain, [&](std::size_t begin, std::size_t end) {
    std::vector<std::uint32_t> row, &part = parts[begin / kDefaultGrain];
    for (std::size_t i = begin; i < end; ++i) {
      row.clear();
      fill(i, row);
      std::sort(row.begin(), row.end());
      row.erase(std::unique(row.begin(), row.end()), row.end());
      rows.first[i] = row.size();
      part.insert(part.end(), row.begin(), row.end());
    }
  });
  rows.entries.resize(exclusive_scan_in_place(rows.first));
  parallel_for(parts.size(), [&](std::size_t c) {
    std::copy(parts[c].begin(), parts[c].end(), rows.entries.begin() + static_cast<std::ptrdiff_t>(rows.first[c * kDefaultGrain]));
  }, 1);
  return rows;
}

Rows facets_around_points(const TriangleSoup& soup) {
  Rows rows;
  rows.first.assign(soup.points.size() + 1, 0);
  for (const Facet& f : soup.facets)
    if (!repeats_point(f))
      for (const std::uint32_t p : f) ++rows.first[p];
  rows.entries.resize(exclusive_scan_in_place(rows.first));
  std::vector<std::uint64_t> next(rows.first);
  for (std::uint32_t f = 0; f < soup.facets.size(); ++f)
    if (!repeats_point(soup.facets[f]))
      for (const std::uint32_t p : soup.facets[f]) rows.entries[next[p]++] = f;
  return rows;
}

}  // namespace

FacetMesh::FacetMesh(const TriangleSoup& welded)
    : facets(welded.facets), across(welded.facets.size(), {kNoFacet, kNoFacet, kNoFacet}), facets_of_point(facets_around_points(welded)),
      closed(is_closed_chain(welded)) {
  const EdgeTable edges(welded);
  for (std::size_t e = 0; e < edges.size(); ++e) {
    const auto uses = edges.uses(e);
    if (uses.size() == 2 && uses[0].forward != uses[1].forward) {
      across[uses[0].facet][uses[0].side] = uses[1].facet;
      across[uses[1].facet][uses[1].side] = uses[0].facet;
    }
  }
  ring = rows_of(facets.size(), [&](std::size_t f, std::vector<std::uint32_t>& row) {
    if (repeats_point(facets[f])) return;
    for (const std::uint32_t g : across[f])
      if (g != kNoFacet) row.push_back(g);
    for (const std::uint32_t p : facets[f])
      if (facets_of_point[p].size() <= kMostAround)
        for (const std::uint32_t g : facets_of_point[p])
          if (g != f) row.push_back(g);
  });
  two_rings = rows_of(facets.size(), [&](std::size_t f, std::vector<std::uint32_t>& row) {
    for (const std::uint32_t g : ring[f]) {
      row.push_back(g);
      for (const std::uint32_t h : ring[g])
        if (h != f) row.push_back(h);
    }
  });
}

FacetGeometry::FacetGeometry(const FacetMesh& mesh, const std::vector<Vec3>& points)
    : normal(mesh.facets.size()), centroid(mesh.facets.size()), area(mesh.facets.size()) {
  update(mesh, points);
}

void FacetGeometry::update(const FacetMesh& mesh, const std::vector<Vec3>& points) {
  parallel_for(mesh.facets.size(), [&](std::size_t f) {
    const Vec3 &a = points[mesh.facets[f][0]], &b = points[mesh.facets[f][1]], &c = points[mesh.facets[f][2]];
    const Vec3 twice = cross(b - a, c - a);
    area[f] = 0.5 * norm(twice);
    normal[f] = unit_or(twice, {});
    centroid[f] = (a + b + c) / 3.0;
  });
}

double mean_edge(const FacetMesh& mesh, const std::vector<Vec3>& points) {
  if (mesh.facets.empty()) return 0;
  const auto add = [](double a, double b) { return a + b; };
  const double sum = parallel_reduce(mesh.facets.size(), kDefaultGrain, 0.0, [&](std::size_t begin, std::size_t end) {
    double part = 0;
    for (std::size_t f = begin; f < end; ++f)
      for (std::size_t i = 0; i < 3; ++i) part += norm(points[mesh.facets[f][(i + 1) % 3]] - points[mesh.facets[f][i]]);
    return part;
  }, add);
  return sum / (3.0 * static_cast<double>(mesh.facets.size()));
}

Vec3 unit_or(const Vec3& v, const Vec3& otherwise) {
  const double length = norm(v);
  return length > 0 ? v / length : otherwise;
}

std::vector<Vec3> point_normals(const FacetMesh& mesh, const std::vector<Vec3>& facet_normals, const std::vector<double>& area) {
  std::vector<Vec3> normals(mesh.facets_of_point.size());
  parallel_for(normals.size(), [&](std::size_t p) {
    Vec3 sum;
    for (const std::uint32_t f : mesh.facets_of_point[p]) sum += facet_normals[f] * area[f];
    normals[p] = unit_or(sum, {});
  });
  return normals;
}

}  // namespace burnish::denoising
