// Improving facets below 15 degrees by the best of a flip, a collapse or a slide, worst first.
#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include "sharpen_mesh.h"
#include "sharpen_patch.h"

namespace burnish::detail {
namespace {

constexpr int kRounds = 6;
constexpr std::size_t kWindow = 4096, kAdvised = 64;  // facets that are looked at together; by one thread
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

// The best change for a facet, of the mesh as it is.
class Adviser {
 public:
  Adviser(const Patch& patch, const ReferenceSurface& s) : s_(s), patch_(patch) {}

  Change best_for(std::uint32_t f) {
    const Facet c = patch_.facet(f);
    best_ = {};
    for (std::size_t i = 0; i < 3; ++i) rings_[i].known = false;
    for (std::size_t i = 0; i < 3; ++i) {
      const std::size_t j = (i + 1) % 3;
      try_flip(c[i], c[j]);
      try_collapse(c[i], c[j], rings_[i]);
      try_collapse(c[j], c[i], rings_[j]);
    }
    // Closest points cost most: vertices slide where nothing else makes the facet good.
    for (std::size_t i = 0; i < 3 && best_.quality < kPoor; ++i) try_slide(c[i], rings_[i]);
    return best_;
  }

 private:
  // What is there around a vertex.
  struct Ring {
    bool known = false, frozen = false;
    Worst now;
    std::vector<Vec3> facing;  // of the facets at it
  };

  void look_around(std::uint32_t p, Ring& ring) const {
    if (ring.known) return;
    ring.known = true;
    ring.now = {};
    ring.facing.clear();
    ring.frozen = patch_.is_ring_frozen(p);
    if (ring.frozen) return;
    for (const std::uint32_t f : patch_.facets_at(p)) {
      ring.facing.push_back(patch_.facing(f));
      ring.now.add(patch_.quality(patch_.facet(f), ring.facing.back()));
    }
  }

  // The one after which things are best; if facets stay turned over, that which turns most of them back. More facets only make `then` worse.
  bool is_best(double now, double then) const {
    const double gain = then - now;
    if (gain <= kGain) return false;
    const auto key = [](double quality, double gained) { return std::pair(std::min(quality, 0.0) == 0, quality < 0 ? gained : quality); };
    return best_.action == Action::none || key(then, gain) > key(best_.quality, best_.gain);
  }
  void propose(Change change, double now, double then) {
    if (!is_best(now, then)) return;
    change.quality = then;
    change.gain = then - now;
    best_ = change;
  }

  // The edge pq of facets pqr and qps becomes rs. [T-SHARP-5]
  void try_flip(std::uint32_t p, std::uint32_t q) {
    const auto [f, g] = patch_.facets_at_edge(p, q);
    if (f == kNoFacet || patch_.is_frozen(f) || patch_.is_frozen(g)) return;
    const std::uint32_t r = patch_.opposite(f, p, q), s = patch_.opposite(g, p, q);
    if (r == s || patch_.are_linked(r, s) || patch_.facets_at(p).size() <= 3 || patch_.facets_at(q).size() <= 3) return;
    if (dot(patch_.facing(f), patch_.facing(g)) < kSameSheet) return;
    Worst now, then;
    for (const std::uint32_t h : {f, g}) now.add(patch_.quality(h));
    for (const Facet& c : {Facet{p, s, r}, Facet{s, q, r}}) then.add(patch_.quality(c, patch_.facing_when(c, patch_.facing(f))));
    // What costs most is asked last.
    if (!is_best(now.value(), then.value()) || gap(p, q, r, s) > may_move(now.value()) || is_crease_edge(p, q)) return;
    propose({Action::flip, p, q}, now.value(), then.value());
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
  void try_collapse(std::uint32_t p, std::uint32_t q, Ring& ring) {
    const SharpenMesh& mesh = patch_.mesh();
    if (mesh.kind[p] == SharpenedKind::corner || mesh.stays(q)) return;
    look_around(p, ring);
    if (ring.frozen) return;
    const double now = ring.now.value();
    const auto then = worst_when_collapsed(p, q, ring);
    if (!then || !patch_.may_collapse(p, q) || !stays_close_when_collapsed(p, q, now)) return;
    if (mesh.on_crease(p) && !may_collapse_along_crease(p, q)) return;
    propose({Action::collapse, p, q}, now, *then);
  }

  // Nothing if it is not the best change.
  std::optional<double> worst_when_collapsed(std::uint32_t p, std::uint32_t q, const Ring& ring) const {
    Worst then;
    const auto facets = patch_.facets_at(p);
    for (std::size_t i = 0; i < facets.size(); ++i) {
      if (patch_.has(facets[i], q)) continue;
      const Facet c = with(patch_.facet(facets[i]), p, q);
      then.add(patch_.quality(c, patch_.facing_when(c, ring.facing[i])));
      if (!is_best(ring.now.value(), then.value())) return std::nullopt;
    }
    return then.value();
  }
  static Facet with(Facet c, std::uint32_t p, std::uint32_t q) {
    for (std::uint32_t& v : c)
      if (v == p) v = q;
    return c;
  }

  bool stays_close_when_collapsed(std::uint32_t p, std::uint32_t q, double now) const {
    const Vec3 &from = patch_.point(p), &to = patch_.point(q);
    double longest = 0, longest_then = 0, moved = squared_norm(to - from);
    for (const std::uint32_t f : patch_.facets_at(p)) {
      const Facet& c = patch_.facet(f);
      for (const std::uint32_t v : c) longest = std::max(longest, squared_norm(patch_.point(v) - from));
      if (patch_.has(f, q)) continue;
      for (const std::uint32_t v : c) longest_then = std::max(longest_then, squared_norm(patch_.point(v) - to));
      const auto [x, y, z] = with(c, p, q);
      moved = std::min(moved, squared_norm(closest_point_on_triangle(from, patch_.point(x), patch_.point(y), patch_.point(z)) - from));
    }
    const double may = may_move(now);
    // A vertex of three facets, one of them turned over, is outside of its ring.
    const bool may_go = moved <= may * may || (now < 0 && patch_.facets_at(p).size() == 3);
    return may_go && longest_then <= kLonger * kLonger * longest;
  }

  bool may_collapse_along_crease(std::uint32_t p, std::uint32_t q) const {
    const std::vector<std::uint32_t> along = crease_neighbours(p);
    if (along.empty()) return !patch_.mesh().on_crease(q);
    if (along.size() < 2 || std::find(along.begin(), along.end(), q) == along.end()) return false;
    return std::all_of(along.begin(), along.end(), [&](std::uint32_t o) { return o == q || is_near_crease(o, q); });
  }

  // To the middle of its neighbours, on S and on its own sheet; along the crease for a crease vertex; or to its target after all. [T-SHARP-7]
  void try_slide(std::uint32_t p, Ring& ring) {
    const SharpenMesh& mesh = patch_.mesh();
    if (mesh.stays(p)) return;
    look_around(p, ring);
    if (ring.frozen) return;
    if (!(patch_.point(p) == mesh.target[p])) propose_slide(p, mesh.target[p], mesh.sheet[p], ring);
    if (mesh.kind[p] == SharpenedKind::corner) return;
    if (mesh.kind[p] == SharpenedKind::crease) {
      const std::vector<std::uint32_t> along = crease_neighbours(p);
      if (along.size() != 2) return;
      const ReferenceSurface::Foot foot = s_.closest_on_creases((patch_.point(along[0]) + patch_.point(along[1])) * 0.5, kSlideReach);
      if (foot.found()) propose_slide(p, foot.point, mesh.sheet[p], ring);
      return;
    }
    Vec3 sum;
    for (const std::uint32_t f : patch_.facets_at(p)) sum = sum + patch_.point(patch_.after(f, p));
    const Vec3 middle = sum / static_cast<double>(patch_.facets_at(p).size());
    for (const double t : {1.0, 0.5}) {
      const Vec3 to = patch_.point(p) + (middle - patch_.point(p)) * t;
      const ReferenceSurface::Foot foot = s_.closest(to, kSlideReach, s_.normal(mesh.sheet[p]), mesh.sheet[p]);
      if (foot.found() && s_.sheet(foot.facet) == s_.sheet(mesh.sheet[p])) propose_slide(p, foot.point, foot.facet, ring);
    }
  }

  void propose_slide(std::uint32_t p, const Vec3& to, std::uint32_t sheet, const Ring& ring) {
    Worst then;
    const auto facets = patch_.facets_at(p);
    for (std::size_t i = 0; i < facets.size(); ++i) {
      then.add(patch_.quality_when(patch_.facet(facets[i]), p, to, ring.facing[i]));
      if (!is_best(ring.now.value(), then.value())) return;
    }
    propose({Action::slide, p, 0, to, sheet}, ring.now.value(), then.value());
  }

  const ReferenceSurface& s_;
  const Patch& patch_;
  Change best_;
  std::array<Ring, 3> rings_;  // of the facet's vertices
};

// As if facets were improved one at a time, worst first: those of a window are looked at together, and again if what is around has changed by then.
class Improver {
 public:
  Improver(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s)
      : s_(s), patch_(mesh, points, edits, s), touched_(points.size(), 0), found_(kWindow), again_(patch_, s) {}

  void run(Progress& progress) {
    std::vector<std::uint32_t> poor = patch_.all_poor_facets();
    for (int round = 0; round < kRounds && !poor.empty(); ++round) {
      changed_.clear();
      patch_.sort_worst_first(poor);
      for (std::size_t begin = 0; begin < poor.size(); begin += kWindow) {
        progress.check();
        improve({poor.data() + begin, std::min(kWindow, poor.size() - begin)});
      }
      poor = patch_.poor_facets_of(changed_);
    }
  }

 private:
  void improve(std::span<const std::uint32_t> facets) {
    parallel_ranges(facets.size(), kAdvised, [&](std::size_t begin, std::size_t end) {
      Adviser adviser(patch_, s_);
      for (std::size_t i = begin; i < end; ++i) found_[i] = is_poor(facets[i]) ? adviser.best_for(facets[i]) : Change{};
    });
    ++window_;
    for (std::size_t i = 0; i < facets.size(); ++i) {
      const std::uint32_t f = facets[i];
      if (!patch_.is_alive(f)) continue;
      if (!has_changed_around(f)) {
        apply(found_[i]);
      } else if (is_poor(f)) {
        apply(again_.best_for(f));
      }
    }
  }
  bool is_poor(std::uint32_t f) const { return patch_.is_alive(f) && patch_.quality(f) < kPoor; }

  // Advice depends on the facets at the vertices of a facet, on their vertices, and on which facets these have.
  bool has_changed_around(std::uint32_t f) const {
    const auto touched = [&](std::uint32_t v) { return touched_[v] == window_; };
    const Facet& c = patch_.facet(f);
    if (std::any_of(c.begin(), c.end(), touched)) return true;
    for (const std::uint32_t v : c)
      for (const std::uint32_t g : patch_.facets_at(v))
        if (touched(patch_.after(g, v))) return true;
    return false;
  }

  void apply(const Change& change) {
    if (change.action == Action::none) return;
    touch(change);
    const auto list = [&](std::uint32_t v) { changed_.insert(changed_.end(), patch_.facets_at(v).begin(), patch_.facets_at(v).end()); };
    switch (change.action) {
      case Action::none: return;
      case Action::flip: patch_.flip(change.p, change.q); break;
      case Action::collapse: patch_.collapse(change.p, change.q); return list(change.q);
      case Action::slide: patch_.slide(change.p, change.to, change.sheet); break;
    }
    list(change.p);
    if (change.action == Action::flip) list(change.q);
  }

  // The vertices that move, or whose facets change; a few more for a flip.
  void touch(const Change& change) {
    touched_[change.p] = window_;
    if (change.action == Action::slide) return;
    for (const std::uint32_t f : patch_.facets_at(change.p))
      for (const std::uint32_t v : patch_.facet(f)) touched_[v] = window_;
  }

  const ReferenceSurface& s_;
  Patch patch_;
  std::vector<std::uint32_t> touched_;  // per vertex: the window in which it was last
  std::uint32_t window_ = 0;
  std::vector<Change> found_;           // of a window
  Adviser again_;
  std::vector<std::uint32_t> changed_;  // facets
};

}  // namespace

void improve_shape(SharpenMesh& mesh, std::vector<Vec3>& points, UnionFind& edits, const ReferenceSurface& s, Progress& progress) {
  Improver(mesh, points, edits, s).run(progress);
}

}  // namespace burnish::detail
