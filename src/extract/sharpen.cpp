// The idea of embedding creases by cutting the edges they cross: marching triangles. Snapping vertices to them keeps facets large (isosurface
// stuffing, Labelle & Shewchuk 2007, does the same to nodes).
#include "burnish/extract/sharpen.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sharpen_mesh.h"

namespace burnish {
namespace detail {

Vec3 facing_of(const SharpenMesh& mesh, const ReferenceSurface& s, const Facet& f) {
  Vec3 sum;
  for (const std::uint32_t v : f)
    if (!mesh.stays(v) && !mesh.on_crease(v)) sum = sum + s.normal(mesh.sheet[v]);
  const double length = norm(sum);
  return length > 0 ? sum / length : Vec3{};
}

}  // namespace detail

namespace {

using namespace detail;

std::vector<Vec3> vertex_normals(const TriangleSoup& m) {
  std::vector<Vec3> normals(m.points.size());
  for (std::size_t f = 0; f < m.facets.size(); ++f) {
    const Vec3 n = facet_normal_2a(m, f);
    for (const std::uint32_t v : m.facets[f]) normals[v] = normals[v] + n;
  }
  parallel_for(normals.size(), [&](std::size_t v) {
    const double length = norm(normals[v]);
    if (length > 0) normals[v] = normals[v] / length;
  });
  return normals;
}

// Step 1. [T-SHARP-1]
SharpenMesh with_feet(const TriangleSoup& m, const ReferenceSurface& s, const std::vector<std::uint8_t>& stays, double reach) {
  const std::size_t n = m.points.size();
  SharpenMesh mesh{m.facets, m.points, m.points, {}, {}, {}};
  mesh.sheet.assign(n, kNoFacet);
  mesh.kind.assign(n, SharpenedKind::smooth);
  mesh.parents.resize(n);
  const std::vector<Vec3> normals = vertex_normals(m);
  parallel_ranges(n, kDefaultGrain, [&](std::size_t begin, std::size_t end) {
    std::uint32_t hint = kNoFacet;
    for (std::size_t v = begin; v < end; ++v) {
      mesh.parents[v] = {static_cast<std::uint32_t>(v), static_cast<std::uint32_t>(v)};
      if (!stays.empty() && stays[v]) continue;
      const ReferenceSurface::Foot foot = s.closest(m.points[v], reach, normals[v], hint);
      if (!foot.found()) continue;
      mesh.target[v] = foot.point;
      mesh.sheet[v] = hint = foot.facet;
    }
  });
  return mesh;
}

// Drops facets that are gone and points that none uses any more; all else keeps its order.
SharpenedSurface collected(SharpenMesh&& mesh, std::vector<Vec3>&& points) {
  SharpenedSurface result;
  std::vector<std::uint32_t> number(points.size(), 0);
  std::erase_if(mesh.facets, [](const Facet& f) { return f[0] == f[1]; });
  for (const Facet& f : mesh.facets)
    for (const std::uint32_t v : f) number[v] = 1;
  std::uint32_t used = 0;
  for (std::uint32_t v = 0; v < points.size(); ++v) {
    if (!number[v]) continue;
    const bool there = !mesh.stays(v) && points[v] == mesh.target[v];
    ++(there ? result.moved : result.kept);
    points[used] = points[v];
    mesh.parents[used] = mesh.parents[v];
    mesh.kind[used] = mesh.kind[v];
    number[v] = used++;
  }
  points.resize(used);
  mesh.parents.resize(used);
  mesh.kind.resize(used);
  for (Facet& f : mesh.facets)
    for (std::uint32_t& v : f) v = number[v];
  result.soup.points = std::move(points);
  result.soup.facets = std::move(mesh.facets);
  result.parents = std::move(mesh.parents);
  result.kind = std::move(mesh.kind);
  return result;
}

}  // namespace

SharpenedSurface sharpen(const TriangleSoup& m, const ReferenceSurface& s, const std::vector<std::uint8_t>& stays, const SharpenOptions& options,
                         Progress& progress) {
  progress.check();
  SharpenMesh mesh = with_feet(m, s, stays, options.reach);
  progress.check();
  std::size_t cut = 0;
  if (s.has_creases()) {
    const std::vector<Crossing> crossings = embed_creases(mesh, s, options, progress);
    cut_edges(mesh, crossings);
    unfold_creases(mesh, s);
    cut = crossings.size();
  }
  // Most facets that moving turns over are those of slivers, and gone once these are improved; only what is left is taken back.
  std::vector<Vec3> points = mesh.target;
  if (options.improve) improve_shape(mesh, points, s, progress);
  const bool complete = take_back(mesh, points, s, progress);
  if (options.improve && !complete) improve_shape(mesh, points, s, progress);
  SharpenedSurface result = collected(std::move(mesh), std::move(points));
  result.cut = cut;
  return result;
}

}  // namespace burnish
