#include "sharpen_patch.h"

#include <cmath>

namespace burnish::detail {
namespace {

// Cosines between a facet and what it should face: no worse than curvature explains, and turned over.
constexpr double kFacesWell = 0.9;
constexpr double kTurnedOver = 0.2;
constexpr double kNoDirection = 1e-6;  // sine of the least angle of a facet without direction

}  // namespace

Patch::Patch(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s)
    : mesh_(mesh), points_(points), edits_(edits), s_(s), around_(mesh.facets, points.size()) {
  // The targets' way to face, before anything changes.
  for (std::uint32_t f = 0; f < mesh.facets.size(); ++f) {
    const Facet& c = mesh.facets[f];
    if (!is_alive(f) || !(mesh.on_crease(c[0]) && mesh.on_crease(c[1]) && mesh.on_crease(c[2]))) continue;
    const Vec3 n = cross(mesh.start[c[1]] - mesh.start[c[0]], mesh.start[c[2]] - mesh.start[c[0]]);
    const double length = norm(n);
    const ReferenceSurface::Foot foot = s.closest((mesh.target[c[0]] + mesh.target[c[1]] + mesh.target[c[2]]) / 3, 2, length > 0 ? n / length : n);
    own_facing_[f] = foot.found() ? s.normal(foot.facet) : length > 0 ? n / length : n;
  }
}

std::span<const std::uint32_t> Patch::facets_at(std::uint32_t v) const {
  const auto own = changed_.find(v);
  return own == changed_.end() ? around_[v] : std::span<const std::uint32_t>(own->second);
}

std::vector<std::uint32_t>& Patch::own_list(std::uint32_t v) {
  const auto [own, fresh] = changed_.try_emplace(v);
  if (fresh) own->second.assign(around_[v].begin(), around_[v].end());
  return own->second;
}

bool Patch::is_ring_frozen(std::uint32_t v) const {
  const auto facets = facets_at(v);
  return std::any_of(facets.begin(), facets.end(), [&](std::uint32_t f) { return is_frozen(f); });
}

bool Patch::are_linked(std::uint32_t p, std::uint32_t q) const {
  const auto facets = facets_at(p);
  return std::any_of(facets.begin(), facets.end(), [&](std::uint32_t f) { return has(f, q); });
}

std::uint32_t Patch::after(std::uint32_t f, std::uint32_t v) const {
  const Facet& c = facet(f);
  return v == c[0] ? c[1] : v == c[1] ? c[2] : c[0];
}

std::uint32_t Patch::opposite(std::uint32_t f, std::uint32_t p, std::uint32_t q) const {
  const std::uint32_t next = after(f, p);
  return next == q ? after(f, q) : next;
}

std::uint32_t Patch::smooth_vertex(std::uint32_t f) const {
  for (const std::uint32_t v : facet(f))
    if (!mesh_.on_crease(v) && !mesh_.stays(v)) return v;
  return kNoFacet;
}

std::array<std::uint32_t, 2> Patch::facets_at_edge(std::uint32_t p, std::uint32_t q) const {
  std::array<std::uint32_t, 2> found{kNoFacet, kNoFacet};
  for (const std::uint32_t f : facets_at(p))
    if (has(f, q)) found[after(f, p) == q ? 0 : 1] = f;
  return found[0] == kNoFacet || found[1] == kNoFacet ? std::array<std::uint32_t, 2>{kNoFacet, kNoFacet} : found;
}

bool Patch::may_collapse(std::uint32_t p, std::uint32_t q) const {
  const auto [f, g] = facets_at_edge(p, q);
  if (f == kNoFacet) return false;
  const std::uint32_t r = opposite(f, p, q), s = opposite(g, p, q);
  if (r == s || facets_at(r).size() <= 3 || facets_at(s).size() <= 3) return false;
  for (const std::uint32_t h : facets_at(p)) {
    const std::uint32_t v = after(h, p);
    if (v != q && v != r && v != s && are_linked(v, q)) return false;
  }
  return true;
}

Vec3 Patch::facing_when(const Facet& c, const Vec3& otherwise) const {
  const Vec3 smooth = facing_of(mesh_, s_, c);
  return squared_norm(smooth) > 0 ? smooth : otherwise;
}

Vec3 Patch::facing(std::uint32_t f) const {
  const auto own = own_facing_.find(f);
  return facing_when(facet(f), own == own_facing_.end() ? Vec3{} : own->second);
}

double Patch::quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& facing) {
  const Vec3 n = cross(b - a, c - a);
  const double length = norm(n), sine = least_sine(a, b, c);
  if (!(sine > kNoDirection)) return -1;
  const double cosine = squared_norm(facing) > 0 ? dot(n, facing) / length : 1;
  if (cosine < kTurnedOver) return -1;
  return sine * std::min(1.0, (cosine - kTurnedOver) / (kFacesWell - kTurnedOver));
}

double Patch::quality_when(std::uint32_t f, std::uint32_t v, const Vec3& at) const {
  const auto where = [&](std::uint32_t w) -> const Vec3& { return w == v ? at : points_[w]; };
  const auto [a, b, c] = facet(f);
  return quality(where(a), where(b), where(c), facing(f));
}

std::vector<std::uint32_t> Patch::all_poor_facets() const {
  std::vector<char> poor(mesh_.facets.size());
  parallel_for(poor.size(), [&](std::size_t f) {
    const auto i = static_cast<std::uint32_t>(f);
    poor[f] = is_alive(i) && !is_frozen(i) && quality(i) < kPoor;
  });
  std::vector<std::uint32_t> found;
  for (std::uint32_t f = 0; f < poor.size(); ++f)
    if (poor[f]) found.push_back(f);
  return found;
}

std::vector<std::uint32_t> Patch::poor_facets_at(std::vector<std::uint32_t> facets) const {
  std::sort(facets.begin(), facets.end());
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  std::erase_if(facets, [&](std::uint32_t f) { return !is_alive(f) || is_frozen(f) || quality(f) >= kPoor; });
  return facets;
}

void Patch::sort_worst_first(std::vector<std::uint32_t>& facets) const {
  std::vector<std::pair<double, std::uint32_t>> keyed(facets.size());
  for (std::size_t i = 0; i < facets.size(); ++i) keyed[i] = {quality(facets[i]), facets[i]};
  std::sort(keyed.begin(), keyed.end());
  for (std::size_t i = 0; i < facets.size(); ++i) facets[i] = keyed[i].second;
}

// The facet pqr becomes psr, qps becomes sqr.
void Patch::flip(std::uint32_t p, std::uint32_t q) {
  const auto [f, g] = facets_at_edge(p, q);
  const std::uint32_t r = opposite(f, p, q), s = opposite(g, p, q);
  keep_facing(f), keep_facing(g);
  edits_.unite(f, g);
  own_facing_[g] = own_facing_[f];
  mesh_.facets[f] = {p, s, r};
  mesh_.facets[g] = {s, q, r};
  std::erase(own_list(p), g);
  std::erase(own_list(q), f);
  const auto insert = [&](std::uint32_t v, std::uint32_t h) {
    auto& list = own_list(v);
    list.insert(std::lower_bound(list.begin(), list.end(), h), h);
  };
  insert(r, g);
  insert(s, f);
}

void Patch::collapse(std::uint32_t p, std::uint32_t q) {
  const std::vector<std::uint32_t> facets = own_list(p);
  for (const std::uint32_t f : facets) {
    edits_.unite(facets.front(), f);
    if (has(f, q)) {
      for (const std::uint32_t v : facet(f))
        if (v != p) std::erase(own_list(v), f);
      mesh_.facets[f] = {0, 0, 0};
      continue;
    }
    keep_facing(f);
    for (std::uint32_t& v : mesh_.facets[f])
      if (v == p) v = q;
    auto& list = own_list(q);
    list.insert(std::lower_bound(list.begin(), list.end(), f), f);
  }
  own_list(p).clear();
}

void Patch::slide(std::uint32_t p, const Vec3& to, std::uint32_t sheet) {
  points_[p] = mesh_.target[p] = to;
  mesh_.sheet[p] = sheet;
}

}  // namespace burnish::detail
