// What sharpening has moved goes back, place by place, until the surface does not meet itself. [T-SHARP-9]
#include <algorithm>
#include <array>
#include <numeric>
#include <unordered_set>
#include <utility>

#include "../surface/box_tree.h"
#include "burnish/core/parallel.h"
#include "burnish/surface/inspect.h"
#include "burnish/surface/shells.h"
#include "sharpening_state.h"

namespace burnish {
namespace {

constexpr int kMostRounds = 24;
constexpr double kFar = 0.2;      // cells: points that have moved less are not suspected at first
constexpr std::uint8_t kOnM = 3;  // steps back
constexpr std::size_t kMany = 3;   // one facet of so many

using Indices = std::vector<std::uint32_t>;
using Pairs = std::vector<std::array<std::uint32_t, 2>>;  // of facets

void append(Indices& to, const Indices& more) { to.insert(to.end(), more.begin(), more.end()); }

void make_unique(Indices& indices) {
  std::sort(indices.begin(), indices.end());
  indices.erase(std::unique(indices.begin(), indices.end()), indices.end());
}

class Settler {
 public:
  explicit Settler(detail::SharpeningState& state)
      : state_(state), mesh_(state.mesh), points_(state.points), steps_(state.steps_back), before_(state.before), edits_(state.edits) {
    written_.points.resize(points_.size());
    parallel_for(points_.size(), [&](std::size_t p) { written_.points[p] = written(points_[p]); });
  }

  Indices run(Progress& progress) { return run(suspects(), progress); }

  // These facets alone are suspected at first.
  Indices run(Indices facets, Progress& progress) {
    Pairs broken;
    for (int round = 0;; ++round) {
      progress.check();
      broken = intersecting(facets, progress);
      if (broken.empty())
        for (const std::uint32_t f : misnested()) broken.push_back({f, f});
      if (broken.empty()) return {};
      Indices changed = round < kMostRounds ? step_back_around(broken) : Indices{};
      if (changed.empty()) return points_of(facets_of(broken));
      // What could not change is looked at again, too.
      append(changed, points_of(facets_of(broken)));
      facets = facets_near(facets_at(changed));
    }
  }

  // Half the way, three quarters, then all of it; then the mesh around is what it was before its shape was improved; then their neighbours go.
  // Returns the points that changed.
  Indices step_back_around(const Pairs& broken) {
    Indices on_m;
    for (const auto& [f, g] : broken)
      if (is_on_m(f) && is_on_m(g)) on_m.insert(on_m.end(), {f, g});
    Indices changed = step_back(points_of(facets_of(broken)));
    if (on_m.empty()) return changed;
    const Indices around = facets_at(points_of(on_m));
    Indices more = undo_edits(around);
    if (more.empty()) more = put_on_m(points_of(around));
    append(changed, more);
    return changed;
  }

  // All of that at once.
  Indices take_back(const Indices& points) {
    Indices changed = undo_edits(facets_at(points));
    append(changed, put_on_m(points));
    if (changed.empty()) changed = put_on_m(points_of(facets_at(points)));
    make_unique(changed);
    return changed;
  }

  // The surface is a 2-manifold: if it is one shell, its volume tells.
  Indices misnested() {
    const Indices alive = alive_facets();
    const TriangleSoup& soup = soup_of(alive);
    if (count_connected(soup) == 1) return signed_volume(soup) > 0 ? Indices{} : alive;
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

  // Those whose boxes meet that of one of these, themselves among them; all there are, where finding out which would take longer than they do.
  Indices facets_near(const Indices& facets) {
    if (facets.empty()) return {};
    Indices near = alive_facets();
    if (facets.size() * kMany > near.size()) return near;
    const TriangleSoup& soup = soup_of(facets);
    Indices all(facets.size());
    std::iota(all.begin(), all.end(), 0u);
    const BoxTree tree(soup, std::move(all));
    std::vector<char> meets(near.size(), 0);
    parallel_for(near.size(), [&](std::size_t i) {
      Box3 box;
      for (const std::uint32_t p : mesh_.facets[near[i]]) box.extend(soup.points[p]);
      tree.facets_meeting(box, [&](std::uint32_t) { meets[i] = 1; });
    });
    std::size_t kept = 0;
    for (std::size_t i = 0; i < near.size(); ++i)
      if (meets[i]) near[kept++] = near[i];
    near.resize(kept);
    return near;
  }

 private:
  // What is near to points of creases, points that have moved, and facets that are not M's.
  Indices suspects() {
    Indices points;
    for (std::uint32_t p = 0; p < points_.size(); ++p)
      if (mesh_.on_crease(p) || squared_norm(points_[p] - mesh_.start[p]) > kFar * kFar) points.push_back(p);
    Indices facets = facets_at(points);
    for (std::uint32_t f = 0; f < before_.size(); ++f)
      if (mesh_.facets[f] != before_[f] && !detail::is_gone(mesh_.facets[f])) facets.push_back(f);
    make_unique(facets);
    return facets_near(facets);
  }

  Vec3 written(const Vec3& p) const { return state_.written ? state_.written(p) : p; }

  // These facets as written, until it is asked for others.
  const TriangleSoup& soup_of(const Indices& facets) {
    written_.facets.clear();
    written_.facets.reserve(facets.size());
    for (const std::uint32_t f : facets) written_.facets.push_back(mesh_.facets[f]);
    return written_;
  }

  Pairs intersecting(const Indices& facets, Progress& progress) {
    Pairs found = self_intersecting_pairs(soup_of(facets), progress);
    for (auto& [f, g] : found) f = facets[f], g = facets[g];
    return found;
  }

  static Indices facets_of(const Pairs& pairs) {
    Indices facets;
    for (const auto& pair : pairs) facets.insert(facets.end(), pair.begin(), pair.end());
    make_unique(facets);
    return facets;
  }

  // Returns those that were elsewhere.
  Indices put_on_m(const Indices& points) {
    Indices changed;
    for (const std::uint32_t p : points) {
      steps_[p] = kOnM;
      if (points_[p] == mesh_.start[p]) continue;
      move(p, mesh_.start[p]);
      changed.push_back(p);
    }
    return changed;
  }

  void move(std::uint32_t p, const Vec3& to) {
    points_[p] = to;
    written_.points[p] = written(to);
  }

  bool is_on_m(std::uint32_t f) const {
    const Facet& c = mesh_.facets[f];
    return std::all_of(c.begin(), c.end(), [&](std::uint32_t p) { return steps_[p] == kOnM || points_[p] == mesh_.start[p]; });
  }

  Indices step_back(const Indices& points) {
    Indices changed;
    for (const std::uint32_t p : points) {
      if (steps_[p] == kOnM || points_[p] == mesh_.start[p]) continue;
      move(p, ++steps_[p] == kOnM ? mesh_.start[p] : (points_[p] + mesh_.start[p]) * 0.5);
      changed.push_back(p);
    }
    return changed;
  }

  // Facets that were changed together go back together, and their points to M. [T-SHARP-9]
  Indices undo_edits(const Indices& facets) {
    Indices changed, next = facets;
    while (!next.empty()) {
      const Indices restored = restore(next, changed);
      next = at_crowded_edges(restored);
    }
    make_unique(changed);
    put_on_m(changed);
    return changed;
  }

  // The clusters of these facets. Returns the facets that are restored, and adds the points of what was there and of what is now.
  Indices restore(const Indices& facets, Indices& changed) {
    std::unordered_set<std::uint32_t> clusters;
    for (const std::uint32_t f : facets)
      if (mesh_.facets[f] != before_[f]) clusters.insert(edits_.find(f));
    Indices restored;
    for (std::uint32_t f = 0; f < before_.size() && !clusters.empty(); ++f) {
      if (mesh_.facets[f] == before_[f] || !clusters.contains(edits_.find(f))) continue;
      if (!detail::is_gone(mesh_.facets[f])) changed.insert(changed.end(), mesh_.facets[f].begin(), mesh_.facets[f].end());
      mesh_.facets[f] = before_[f];
      restored.push_back(f);
    }
    append(changed, points_of(restored));
    return restored;
  }

  // Facets at edges of these that have more than two: another change has made the edge that is back now, or would not have been made beside it.
  Indices at_crowded_edges(const Indices& restored) const {
    struct Use {
      std::array<std::uint32_t, 2> edge;
      std::uint32_t facet;
      auto operator<=>(const Use&) const = default;
    };
    std::vector<Use> uses;
    if (restored.empty()) return {};
    for (const std::uint32_t f : facets_at(points_of(restored)))
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t a = mesh_.facets[f][i], b = mesh_.facets[f][(i + 1) % 3];
        uses.push_back({{std::min(a, b), std::max(a, b)}, f});
      }
    std::sort(uses.begin(), uses.end());
    Indices crowded;
    for (std::size_t i = 0, j; i < uses.size(); i = j) {
      for (j = i; j < uses.size() && uses[j].edge == uses[i].edge; ++j) {}
      if (j - i > 2)
        for (std::size_t k = i; k < j; ++k) crowded.push_back(uses[k].facet);
    }
    return crowded;
  }

  const detail::SharpeningState& state_;
  detail::SharpenMesh& mesh_;
  std::vector<Vec3>& points_;
  std::vector<std::uint8_t>& steps_;
  const std::vector<Facet>& before_;
  UnionFind& edits_;
  TriangleSoup written_;  // all points, facets for a time
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
