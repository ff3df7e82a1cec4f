// What sharpening has moved goes back, place by place, until the surface does not meet itself. [T-SHARP-9]
#include <algorithm>
#include <cmath>
#include <unordered_set>
#include <utility>

#include "burnish/surface/inspect.h"
#include "burnish/surface/shells.h"
#include "sharpening_state.h"

namespace burnish {
namespace {

constexpr int kMostRounds = 24;
constexpr double kFar = 0.2;      // cells: points that have moved less are not suspected at first
constexpr double kBucket = 2;     // cells
constexpr std::uint8_t kOnM = 3;  // steps back

using Indices = std::vector<std::uint32_t>;

void make_unique(Indices& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

class Settler {
 public:
  explicit Settler(detail::SharpeningState& state) : mesh_(state.mesh), points_(state.points), steps_(state.steps_back), before_(state.before), edits_(state.edits) {}

  Indices run(Progress& progress) { return run(suspects(), progress); }

  // These facets alone are suspected at first.
  Indices run(Indices facets, Progress& progress) {
    Indices broken;
    for (int round = 0; round < kMostRounds; ++round) {
      progress.check();
      broken = intersecting(facets, progress);
      const Indices wrong = broken.empty() ? points_of(misnested()) : points_of(broken);
      if (wrong.empty()) return {};
      const Indices changed = step_back_around(wrong);
      if (changed.empty()) return wrong;
      facets = facets_near(facets_at(changed));
    }
    return points_of(broken);
  }

  // Half the way, three quarters, then all of it; then the mesh around is what it was before its shape was improved; then their neighbours go.
  // Returns the points that changed.
  Indices step_back_around(const Indices& points) {
    Indices changed = step_back(points);
    if (changed.empty()) changed = undo_edits(facets_at(points));
    if (changed.empty()) changed = step_back(points_of(facets_at(points)));
    return changed;
  }

  // All of that at once.
  Indices take_back(const Indices& points) {
    Indices changed = undo_edits(facets_at(points));
    const Indices moved = put_on_m(points);
    changed.insert(changed.end(), moved.begin(), moved.end());
    if (changed.empty()) changed = put_on_m(points_of(facets_at(points)));
    make_unique(changed);
    return changed;
  }

  Indices misnested() const {
    TriangleSoup soup{points_, {}, {}};
    const Indices alive = alive_facets();
    for (const std::uint32_t f : alive) soup.facets.push_back(mesh_.facets[f]);
    const Shells shells = find_shells(soup);
    Indices found;
    for (std::size_t i = 0; i < alive.size(); ++i)
      if (is_misnested(shells.shells[shells.of_facet[i]])) found.push_back(alive[i]);
    return found;
  }

  Indices alive_facets() const {
    Indices alive;
    for (std::uint32_t f = 0; f < mesh_.facets.size(); ++f)
      if (!detail::is_gone(mesh_.facets[f])) alive.push_back(f);
    return alive;
  }

  Indices points_of(const Indices& facets) const {
    Indices points;
    for (const std::uint32_t f : facets) points.insert(points.end(), mesh_.facets[f].begin(), mesh_.facets[f].end());
    make_unique(points);
    return points;
  }

  Indices facets_at(const Indices& points) const {
    std::vector<char> marked(points_.size(), 0);
    for (const std::uint32_t p : points) marked[p] = 1;
    Indices facets;
    for (std::uint32_t f = 0; f < mesh_.facets.size(); ++f) {
      const auto [a, b, c] = mesh_.facets[f];
      if ((marked[a] || marked[b] || marked[c]) && a != b) facets.push_back(f);
    }
    return facets;
  }

  Indices facets_near(const Indices& facets) const {
    std::unordered_set<std::int64_t> touched;
    for (const std::uint32_t f : facets) any_bucket(f, [&](std::int64_t bucket) { return touched.insert(bucket), false; });
    Indices near;
    for (const std::uint32_t f : alive_facets())
      if (any_bucket(f, [&](std::int64_t bucket) { return touched.contains(bucket); })) near.push_back(f);
    return near;
  }

 private:
  Indices suspects() const {
    Indices points;
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      if (mesh_.on_crease(p) || squared_norm(points_[p] - mesh_.start[p]) > kFar * kFar) points.push_back(p);
    return facets_at(points);
  }

  // Visits the buckets of the lattice that a facet's box touches, until one is what is looked for.
  template <class Visit>
  bool any_bucket(std::uint32_t f, Visit&& visit) const {
    const Vec3 &a = points_[mesh_.facets[f][0]], &b = points_[mesh_.facets[f][1]], &c = points_[mesh_.facets[f][2]];
    const auto bucket = [](double x) { return static_cast<std::int64_t>(std::floor(x / kBucket)); };
    const auto first = [&](double Vec3::*x) { return bucket(std::min({a.*x, b.*x, c.*x})); };
    const auto last = [&](double Vec3::*x) { return bucket(std::max({a.*x, b.*x, c.*x})); };
    for (std::int64_t i = first(&Vec3::x); i <= last(&Vec3::x); ++i)
      for (std::int64_t j = first(&Vec3::y); j <= last(&Vec3::y); ++j)
        for (std::int64_t k = first(&Vec3::z); k <= last(&Vec3::z); ++k)
          if (visit((i & 0x1fffff) << 42 | (j & 0x1fffff) << 21 | (k & 0x1fffff))) return true;
    return false;
  }

  Indices intersecting(const Indices& facets, Progress& progress) const {
    TriangleSoup part{points_, {}, {}};
    for (const std::uint32_t f : facets) part.facets.push_back(mesh_.facets[f]);
    Indices found;
    for (const auto& pair : self_intersecting_pairs(part, progress))
      for (const std::uint32_t i : pair) found.push_back(facets[i]);
    make_unique(found);
    return found;
  }

  // Returns those that were elsewhere.
  Indices put_on_m(const Indices& points) {
    Indices changed;
    for (const std::uint32_t p : points) {
      steps_[p] = kOnM;
      if (!(std::exchange(points_[p], mesh_.start[p]) == mesh_.start[p])) changed.push_back(p);
    }
    return changed;
  }

  Indices step_back(const Indices& points) {
    Indices changed;
    for (const std::uint32_t p : points) {
      if (steps_[p] == kOnM || points_[p] == mesh_.start[p]) continue;
      points_[p] = ++steps_[p] == kOnM ? mesh_.start[p] : (points_[p] + mesh_.start[p]) * 0.5;
      changed.push_back(p);
    }
    return changed;
  }

  // Facets that were changed together go back together, and their points to M.
  Indices undo_edits(const Indices& facets) {
    std::unordered_set<std::uint32_t> clusters;
    for (const std::uint32_t f : facets)
      if (mesh_.facets[f] != before_[f]) clusters.insert(edits_.find(f));
    Indices changed, restored;
    for (std::uint32_t f = 0; f < before_.size() && !clusters.empty(); ++f) {
      if (mesh_.facets[f] == before_[f] || !clusters.contains(edits_.find(f))) continue;
      if (!detail::is_gone(mesh_.facets[f])) changed.insert(changed.end(), mesh_.facets[f].begin(), mesh_.facets[f].end());
      mesh_.facets[f] = before_[f];
      restored.push_back(f);
    }
    const Indices points = points_of(restored);
    changed.insert(changed.end(), points.begin(), points.end());
    make_unique(changed);
    put_on_m(changed);
    return changed;
  }

  detail::SharpenMesh& mesh_;
  std::vector<Vec3>& points_;
  std::vector<std::uint8_t>& steps_;
  const std::vector<Facet>& before_;
  UnionFind& edits_;
};

}  // namespace

namespace detail {

// Facets are left out if they are gone, points if no facet has them; all else keeps its order.
SharpenedSurface collected(const SharpeningState& state) {
  const SharpenMesh& mesh = state.mesh;
  SharpenedSurface result;
  std::vector<std::uint32_t> number(state.points.size(), 0);
  for (const Facet& f : mesh.facets)
    if (!is_gone(f))
      for (const std::uint32_t v : f) number[v] = 1;
  for (std::uint32_t v = 0; v < number.size(); ++v) {
    if (!number[v]) continue;
    const bool there = !mesh.stays(v) && state.points[v] == mesh.target[v];
    ++(there ? result.moved : result.kept);
    number[v] = static_cast<std::uint32_t>(result.soup.points.size());
    result.soup.points.push_back(state.points[v]);
    result.parents.push_back(mesh.parents[v]);
    result.kind.push_back(mesh.kind[v]);
  }
  for (const Facet& f : mesh.facets)
    if (!is_gone(f)) result.soup.facets.push_back({number[f[0]], number[f[1]], number[f[2]]});
  result.cut = state.cut;
  return result;
}

}  // namespace detail

std::vector<std::uint32_t> Sharpening::settle(Progress& progress) {
  Indices vertices;
  for (const std::uint32_t p : Settler(*state_).run(progress)) vertices.insert(vertices.end(), state_->mesh.parents[p].begin(), state_->mesh.parents[p].end());
  make_unique(vertices);
  return vertices;
}

bool Sharpening::take_back(const std::vector<std::uint32_t>& facets, Progress& progress) {
  Settler settler(*state_);
  const Indices alive = settler.alive_facets();
  Indices broken;
  for (const std::uint32_t f : facets) broken.push_back(alive[f]);
  const Indices changed = settler.take_back(settler.points_of(facets.empty() ? settler.misnested() : broken));
  if (!changed.empty()) settler.run(settler.facets_near(settler.facets_at(changed)), progress);
  return !changed.empty();
}

SharpenedSurface Sharpening::surface() const { return detail::collected(*state_); }

}  // namespace burnish
