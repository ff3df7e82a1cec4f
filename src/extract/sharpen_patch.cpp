#include "sharpen_patch.h"

#include <cmath>
#include <numeric>

namespace burnish::detail {
namespace {

// Cosines between a facet and what it should face: no worse than curvature explains, and turned over.
constexpr double kFacesWell = 0.9;
constexpr double kTurnedOver = 0.2;
constexpr double kNoDirection = 1e-6;  // sine of the least angle of a facet without direction

}  // namespace

Patch::Patch(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s)
    : mesh_(mesh), points_(points), edits_(edits), s_(s), around_(mesh.facets, points.size()), list_of_(points.size(), kNone), facing_of_(mesh.facets.size(), kNone) {
  find_facings_between_creases();
}

// The targets' way to face, before anything changes.
void Patch::find_facings_between_creases() {
  std::vector<std::uint32_t> between;
  for (std::uint32_t f = 0; f < mesh_.facets.size(); ++f) {
    const Facet& c = mesh_.facets[f];
    if (is_alive(f) && mesh_.on_crease(c[0]) && mesh_.on_crease(c[1]) && mesh_.on_crease(c[2])) between.push_back(f);
  }
  facings_.resize(between.size());
  parallel_for(between.size(), [&](std::size_t i) {
    const Facet& c = mesh_.facets[between[i]];
    const Vec3 n = cross(mesh_.start[c[1]] - mesh_.start[c[0]], mesh_.start[c[2]] - mesh_.start[c[0]]);
    const double length = norm(n);
    const Vec3 before = length > 0 ? n / length : n;
    const ReferenceSurface::Foot foot = s_.closest((mesh_.target[c[0]] + mesh_.target[c[1]] + mesh_.target[c[2]]) / 3, 2, before);
    facings_[i] = foot.found() ? s_.normal(foot.facet) : before;
    facing_of_[between[i]] = static_cast<std::uint32_t>(i);
  }, 64);
}

std::span<const std::uint32_t> Patch::facets_at(std::uint32_t v) const {
  return list_of_[v] == kNone ? around_[v] : std::span<const std::uint32_t>(lists_[list_of_[v]]);
}

std::vector<std::uint32_t>& Patch::own_list(std::uint32_t v) {
  if (list_of_[v] == kNone) {
    list_of_[v] = static_cast<std::uint32_t>(lists_.size());
    lists_.emplace_back(around_[v].begin(), around_[v].end());
  }
  return lists_[list_of_[v]];
}

void Patch::set_facing(std::uint32_t f, const Vec3& facing) {
  if (facing_of_[f] == kNone) {
    facing_of_[f] = static_cast<std::uint32_t>(facings_.size());
    facings_.push_back(facing);
  } else {
    facings_[facing_of_[f]] = facing;
  }
}

void Patch::keep_facing(std::uint32_t f) {
  if (facing_of_[f] == kNone) set_facing(f, facing(f));
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
  return facing_when(facet(f), facing_of_[f] == kNone ? Vec3{} : facings_[facing_of_[f]]);
}

double Patch::quality(const Vec3& a, const Vec3& b, const Vec3& c, const Vec3& facing) {
  const Vec3 n = cross(b - a, c - a);
  const double length = norm(n), sine = least_sine(a, b, c);
  if (!(sine > kNoDirection)) return -1;
  const double cosine = squared_norm(facing) > 0 ? dot(n, facing) / length : 1;
  if (cosine < kTurnedOver) return -1;
  return sine * std::min(1.0, (cosine - kTurnedOver) / (kFacesWell - kTurnedOver));
}

double Patch::quality_when(const Facet& c, std::uint32_t v, const Vec3& at, const Vec3& facing) const {
  const auto where = [&](std::uint32_t w) -> const Vec3& { return w == v ? at : points_[w]; };
  return quality(where(c[0]), where(c[1]), where(c[2]), facing);
}

std::vector<std::uint32_t> Patch::all_poor_facets() const {
  std::vector<std::uint32_t> facets(mesh_.facets.size());
  std::iota(facets.begin(), facets.end(), 0u);
  return poor_of(facets);
}

std::vector<std::uint32_t> Patch::poor_facets_of(std::vector<std::uint32_t> facets) const {
  parallel_sort(facets);
  facets.erase(std::unique(facets.begin(), facets.end()), facets.end());
  return poor_of(facets);
}

std::vector<std::uint32_t> Patch::poor_of(const std::vector<std::uint32_t>& facets) const {
  std::vector<char> poor(facets.size());
  parallel_for(poor.size(), [&](std::size_t i) {
    const std::uint32_t f = facets[i];
    poor[i] = is_alive(f) && !is_frozen(f) && quality(f) < kPoor;
  });
  std::vector<std::uint32_t> found;
  for (std::size_t i = 0; i < poor.size(); ++i)
    if (poor[i]) found.push_back(facets[i]);
  return found;
}

void Patch::sort_worst_first(std::vector<std::uint32_t>& facets) const {
  std::vector<std::pair<double, std::uint32_t>> keyed(facets.size());
  parallel_for(facets.size(), [&](std::size_t i) { keyed[i] = {quality(facets[i]), facets[i]}; });
  parallel_sort(keyed);
  for (std::size_t i = 0; i < facets.size(); ++i) facets[i] = keyed[i].second;
}

// The facet pqr becomes psr, qps becomes sqr.
void Patch::flip(std::uint32_t p, std::uint32_t q) {
  const auto [f, g] = facets_at_edge(p, q);
  const std::uint32_t r = opposite(f, p, q), s = opposite(g, p, q);
  keep_facing(f), keep_facing(g);
  edits_.unite(f, g);
  set_facing(g, Vec3(facings_[facing_of_[f]]));
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
