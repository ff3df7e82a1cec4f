// Improving facets below 15 degrees by the best of a flip, a collapse or a slide, one at a time, worst first.
#include <algorithm>
#include <array>
#include <cmath>
#include <tuple>
#include <unordered_map>
#include <utility>

#include "sharpen_mesh.h"
#include "sharpen_patch.h"

namespace burnish::detail {
namespace {

constexpr int kRounds = 6;
constexpr double kGain = 0.02;          // of the least sine: less is not worth a change
constexpr double kSameSheet = 0.7;      // cosine between facets across an edge that may be flipped
constexpr double kFlat = 0.996;         // cosine: sides of an edge that face more alike are one
constexpr double kChord = 0.1;          // of an edge's length: how far a crease edge's middle may be from the crease
constexpr double kLonger = 1.5;         // times the longest edge around: what a collapse may make
constexpr double kSlideReach = 1;       // cells
// Cells: how far the surface may move by a flip or a collapse; more where a facet is turned over.
constexpr double kMayMove = 0.1, kMayMoveToTurn = 0.3;

enum class Action : std::uint8_t { none, flip, collapse, slide };

// Of several facets: the worst quality, or how many are turned over, as a negative number. So turning them back one by one is a gain.
class Worst {
 public:
  void add(double quality) {
    if (quality < 0) ++turned_;
    least_ = std::min(least_, quality);
  }
  double value() const { return turned_ > 0 ? -static_cast<double>(turned_) : least_; }

 private:
  int turned_ = 0;
  double least_ = 1;
};

struct Change {
  Action action = Action::none;
  std::uint32_t p = 0, q = 0;  // flip: the edge; collapse: p goes to q; slide: p
  Vec3 to{};                   // slide
  std::uint32_t sheet = 0;     // slide
  double quality = 0;          // the worst of the facets that it changes
  double gain = 0;
};

class Improver {
 public:
  Improver(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s) : s_(s), patch_(mesh, points, edits, s) {}

  void run(Progress& progress) {
    std::vector<std::uint32_t> poor = patch_.all_poor_facets();
    for (int round = 0; round < kRounds && !poor.empty(); ++round) {
      changed_.clear();
      patch_.sort_worst_first(poor);
      std::size_t n = 0;
      for (const std::uint32_t f : poor) {
        if (++n % 1024 == 0) progress.check();
        if (patch_.is_alive(f) && patch_.quality(f) < kPoor) improve(f);
      }
      poor = patch_.poor_facets_at(changed_);
    }
  }

 private:
  void improve(std::uint32_t f) {
    const Facet c = patch_.facet(f);
    best_ = {};
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t p = c[i], q = c[(i + 1) % 3];
      try_flip(p, q);
      try_collapse(p, q);
      try_collapse(q, p);
    }
    // Closest points cost most: vertices slide where nothing else makes the facet good.
    for (std::size_t i = 0; i < 3 && best_.quality < kPoor; ++i) try_slide(c[i]);
    apply();
  }

  // The one after which things are best; if facets stay turned over, that which turns most of them back.
  void propose(Change change, double now, double then) {
    change.quality = then;
    change.gain = then - now;
    if (change.gain <= kGain) return;
    const auto key = [](const Change& c) { return std::pair(std::min(c.quality, 0.0) == 0, c.quality < 0 ? c.gain : c.quality); };
    if (best_.action == Action::none || key(change) > key(best_)) best_ = change;
  }

  // The edge pq of facets pqr and qps becomes rs. [T-SHARP-5]
  void try_flip(std::uint32_t p, std::uint32_t q) {
    const auto [f, g] = patch_.facets_at_edge(p, q);
    if (f == kNoFacet || patch_.is_frozen(f) || patch_.is_frozen(g)) return;
    const std::uint32_t r = patch_.opposite(f, p, q), s = patch_.opposite(g, p, q);
    if (r == s || patch_.are_linked(r, s) || patch_.facets_at(p).size() <= 3 || patch_.facets_at(q).size() <= 3) return;
    if (dot(patch_.facing(f), patch_.facing(g)) < kSameSheet || is_crease_edge(p, q)) return;
    Worst now, then;
    for (const std::uint32_t h : {f, g}) now.add(patch_.quality(h));
    for (const Facet& c : {Facet{p, s, r}, Facet{s, q, r}}) then.add(patch_.quality(c, patch_.facing_when(c, patch_.facing(f))));
    if (gap(p, q, r, s) <= may_move(now.value())) propose({Action::flip, p, q}, now.value(), then.value());
  }

  static double may_move(double quality) { return quality < 0 ? kMayMoveToTurn : kMayMove; }
  // Between the lines pq and rs.
  double gap(std::uint32_t p, std::uint32_t q, std::uint32_t r, std::uint32_t s) const {
    const Vec3 n = cross(patch_.point(q) - patch_.point(p), patch_.point(s) - patch_.point(r));
    const double length = norm(n);
    return length > 0 ? std::abs(dot(patch_.point(r) - patch_.point(p), n)) / length : 0;
  }

  // On a crease, and with its two sides on both sides. An edge between two crease vertices beside a chain has the same sheet on both.
  bool is_crease_edge(std::uint32_t p, std::uint32_t q) const {
    if (!patch_.mesh().on_crease(p) || !patch_.mesh().on_crease(q)) return false;
    const Vec3 &a = patch_.point(p), &b = patch_.point(q);
    const ReferenceSurface::Foot foot = s_.closest_on_creases((a + b) * 0.5, kChord * norm(b - a) + 1e-9);
    if (!foot.found()) return false;
    const auto [f, g] = patch_.facets_at_edge(p, q);
    if (f == kNoFacet) return true;
    const auto& sides = s_.creases().edges[foot.facet].facets;
    const std::uint32_t u = patch_.smooth_vertex(f), v = patch_.smooth_vertex(g);
    if (u != kNoFacet && v != kNoFacet && s_.sheet(sides[0]) != s_.sheet(sides[1])) return sheet_of(u) != sheet_of(v);
    return dot(patch_.facing(f), patch_.facing(g)) < kFlat;
  }
  std::uint32_t sheet_of(std::uint32_t v) const { return s_.sheet(patch_.mesh().sheet[v]); }
  bool is_near_crease(std::uint32_t p, std::uint32_t q) const {
    const Vec3 &a = patch_.point(p), &b = patch_.point(q);
    return s_.closest_on_creases((a + b) * 0.5, kChord * norm(b - a) + 1e-9).found();
  }
  std::vector<std::uint32_t> crease_neighbours(std::uint32_t p) const {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t f : patch_.facets_at(p)) {
      const std::uint32_t q = patch_.after(f, p);
      if (is_crease_edge(p, q)) found.push_back(q);
    }
    return found;
  }

  // p's facets are gone, or have q in its place. [T-SHARP-6]
  void try_collapse(std::uint32_t p, std::uint32_t q) {
    const SharpenMesh& mesh = patch_.mesh();
    if (mesh.kind[p] == SharpenedKind::corner || patch_.is_ring_frozen(p) || mesh.stays(q) || !patch_.may_collapse(p, q)) return;
    if (mesh.on_crease(p) && !may_collapse_along_crease(p, q)) return;
    Worst now, then;
    double longest = 0, longest_then = 0, moved = squared_norm(patch_.point(q) - patch_.point(p));
    for (const std::uint32_t f : patch_.facets_at(p)) {
      Facet c = patch_.facet(f);
      now.add(patch_.quality(f));
      for (const std::uint32_t v : c) longest = std::max(longest, squared_norm(patch_.point(v) - patch_.point(p)));
      if (patch_.has(f, q)) continue;
      for (std::uint32_t& v : c) {
        longest_then = std::max(longest_then, squared_norm(patch_.point(v) - patch_.point(q)));
        if (v == p) v = q;
      }
      then.add(patch_.quality(c, patch_.facing_when(c, patch_.facing(f))));
      const Vec3 &x = patch_.point(c[0]), &y = patch_.point(c[1]), &z = patch_.point(c[2]);
      moved = std::min(moved, squared_norm(closest_point_on_triangle(patch_.point(p), x, y, z) - patch_.point(p)));
    }
    const double may = may_move(now.value());
    // A vertex of three facets, one of them turned over, is outside of its ring.
    const bool may_go = moved <= may * may || (now.value() < 0 && patch_.facets_at(p).size() == 3);
    if (may_go && longest_then <= kLonger * kLonger * longest) propose({Action::collapse, p, q}, now.value(), then.value());
  }

  bool may_collapse_along_crease(std::uint32_t p, std::uint32_t q) const {
    const std::vector<std::uint32_t> along = crease_neighbours(p);
    if (along.empty()) return !patch_.mesh().on_crease(q);
    if (along.size() < 2 || std::find(along.begin(), along.end(), q) == along.end()) return false;
    return std::all_of(along.begin(), along.end(), [&](std::uint32_t o) { return o == q || is_near_crease(o, q); });
  }

  // To the middle of its neighbours, on S and on its own sheet; along the crease for a crease vertex; or to its target after all. [T-SHARP-7]
  void try_slide(std::uint32_t p) {
    const SharpenMesh& mesh = patch_.mesh();
    if (patch_.is_ring_frozen(p) || mesh.stays(p)) return;
    if (!(patch_.point(p) == mesh.target[p])) propose_slide(p, mesh.target[p], mesh.sheet[p]);
    if (mesh.kind[p] == SharpenedKind::corner) return;
    if (mesh.kind[p] == SharpenedKind::crease) {
      const std::vector<std::uint32_t> along = crease_neighbours(p);
      if (along.size() != 2) return;
      const ReferenceSurface::Foot foot = s_.closest_on_creases((patch_.point(along[0]) + patch_.point(along[1])) * 0.5, kSlideReach);
      if (foot.found()) propose_slide(p, foot.point, mesh.sheet[p]);
      return;
    }
    Vec3 sum;
    for (const std::uint32_t f : patch_.facets_at(p)) sum = sum + patch_.point(patch_.after(f, p));
    const Vec3 middle = sum / static_cast<double>(patch_.facets_at(p).size());
    for (const double t : {1.0, 0.5}) {
      const Vec3 to = patch_.point(p) + (middle - patch_.point(p)) * t;
      const ReferenceSurface::Foot foot = s_.closest(to, kSlideReach, s_.normal(mesh.sheet[p]), mesh.sheet[p]);
      if (foot.found() && s_.sheet(foot.facet) == s_.sheet(mesh.sheet[p])) propose_slide(p, foot.point, foot.facet);
    }
  }

  void propose_slide(std::uint32_t p, const Vec3& to, std::uint32_t sheet) {
    Worst now, then;
    for (const std::uint32_t f : patch_.facets_at(p)) {
      now.add(patch_.quality(f));
      then.add(patch_.quality_when(f, p, to));
    }
    propose({Action::slide, p, 0, to, sheet}, now.value(), then.value());
  }

  void apply() {
    const auto touch = [&](std::uint32_t v) {
      for (const std::uint32_t f : patch_.facets_at(v)) changed_.push_back(f);
    };
    switch (best_.action) {
      case Action::none: return;
      case Action::flip: patch_.flip(best_.p, best_.q); break;
      case Action::collapse: patch_.collapse(best_.p, best_.q); touch(best_.q); return;
      case Action::slide: patch_.slide(best_.p, best_.to, best_.sheet); break;
    }
    touch(best_.p);
    if (best_.action == Action::flip) touch(best_.q);
  }

  const ReferenceSurface& s_;
  Patch patch_;
  Change best_;
  std::vector<std::uint32_t> changed_;  // facets
};

}  // namespace

void improve_shape(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s, Progress& progress) {
  Improver(mesh, points, edits, s).run(progress);
}

}  // namespace burnish::detail
