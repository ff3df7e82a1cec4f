// The idea of embedding creases by cutting the edges they cross: marching triangles. Snapping vertices to them keeps facets large (isosurface
// stuffing, Labelle & Shewchuk 2007, does the same to nodes).
#include "burnish/extract/sharpen.h"

#include <algorithm>
#include <cmath>
#include <utility>

#include "sharpen_mesh.h"
#include "sharpening_state.h"

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

}  // namespace

SharpenedSurface sharpen(const TriangleSoup& m, const ReferenceSurface& s, const std::vector<std::uint8_t>& stays, const SharpenOptions& options,
                         Progress& progress) {
  return Sharpening(m, s, stays, options, progress).surface();
}

Sharpening::Sharpening(Sharpening&&) noexcept = default;
Sharpening& Sharpening::operator=(Sharpening&&) noexcept = default;
Sharpening::~Sharpening() = default;

Sharpening::Sharpening(const TriangleSoup& m, const ReferenceSurface& s, const std::vector<std::uint8_t>& stays, const SharpenOptions& options,
                       Progress& progress)
    : state_(std::make_unique<SharpeningState>()) {
  progress.check();
  state_->written = options.written;
  SharpenMesh& mesh = state_->mesh = with_feet(m, s, stays, options.reach);
  progress.check();
  if (s.has_creases()) {
    const std::vector<Crossing> crossings = embed_creases(mesh, s, options, progress);
    cut_edges(mesh, crossings);
    unfold_creases(mesh, s);
    state_->cut = crossings.size();
  }
  state_->before = mesh.facets;
  state_->edits = UnionFind(mesh.facets.size());
  state_->steps_back.assign(mesh.start.size(), 0);
  // Most facets that moving turns over are those of slivers, and gone once these are improved; only what is left is taken back.
  std::vector<Vec3>& points = state_->points = mesh.target;
  if (options.improve) improve_shape(mesh, points, state_->edits, s, progress);
  const bool complete = detail::take_back(mesh, points, s, progress);
  if (options.improve && !complete) improve_shape(mesh, points, state_->edits, s, progress);
}

}  // namespace burnish
