// Where the creases of S cross M's edges, and which vertices of M become corners and crease vertices.
#include <algorithm>
#include <array>
#include <cmath>
#include <span>
#include <tuple>
#include <unordered_map>
#include <utility>
#include <vector>

#include "burnish/surface/triangle_index.h"
#include "sharpen_mesh.h"

namespace burnish::detail {
namespace {

constexpr double kSnapRatio = 0.35;       // of the way to the neighbour
constexpr double kSnapDistance = 0.25;    // cells
constexpr double kStrayDistance = 0.75;   // cells: a crease that does not part the two sheets is that of a strip narrower than the edge
constexpr double kOffJunction = 1;        // cells that a corner's vertex may be farther away for each facet of three sheets that it has
constexpr double kLeastSine = 0.25;       // of a facet between three crease vertices
constexpr double kFartherSheet = 0.05;    // cells that a vertex may go farther for each neighbour that it joins on another sheet
constexpr int kSweeps = 4;
constexpr int kProjections = 3;
constexpr std::size_t kEdgesAtATime = 256, kCornersAtATime = 64, kWishesAtATime = 4096;

double distance(const Vec3& a, const Vec3& b) { return norm(a - b); }

double along_segment(const Vec3& p, const Vec3& a, const Vec3& b) {
  const double length = squared_norm(b - a);
  return length > 0 ? std::clamp(dot(p - a, b - a) / length, 0.0, 1.0) : 0;
}

class Embedding {
 public:
  Embedding(SharpenMesh& mesh, const ReferenceSurface& s, const SharpenOptions& options)
      : mesh_(mesh), s_(s), options_(options), around_(mesh.facets, mesh.start.size()) {}

  std::vector<Crossing> run(Progress& progress) {
    find_near_vertices();
    progress.check();
    join_sheets();
    find_crossings();
    progress.check();
    if (!near_.empty()) {
      place_corners();
      snap_vertices();
    }
    std::erase_if(crossings_, [&](const Crossing& c) { return is_settled(c); });
    return std::move(crossings_);
  }

 private:
  void find_near_vertices() {
    std::vector<std::uint8_t> near(mesh_.start.size(), 0);
    parallel_ranges(near.size(), kDefaultGrain, [&](std::size_t begin, std::size_t end) {
      std::uint32_t hint = kNoFacet;
      for (std::size_t v = begin; v < end; ++v)
        near[v] = mesh_.sheet[v] != kNoFacet && s_.is_near_creases(mesh_.target[v], options_.crease_reach, hint);
    });
    is_near_ = std::move(near);
    for (std::uint32_t v = 0; v < is_near_.size(); ++v)
      if (is_near_[v]) near_.push_back(v);
    for (std::uint32_t f = 0; f < mesh_.facets.size(); ++f) {
      const Facet& c = mesh_.facets[f];
      if (is_near_[c[0]] + is_near_[c[1]] + is_near_[c[2]] >= 2) near_facets_.push_back(f);
    }
  }

  std::uint32_t sheet_of(std::uint32_t v) const { return s_.sheet(mesh_.sheet[v]); }
  std::uint32_t after(std::uint32_t f, std::uint32_t v) const {
    const Facet& c = mesh_.facets[f];
    return v == c[0] ? c[1] : v == c[1] ? c[2] : c[0];
  }

  // Where sheets are about as far, as on the bisecting plane of an edge, vertices of all of them alternate. One that another sheet is nearly as close
  // to goes over to it if more of its neighbours are there. [T-SHARP-2]
  void join_sheets() {
    std::vector<std::uint32_t> mixed;
    for (const std::uint32_t f : near_facets_) {
      const Facet& c = mesh_.facets[f];
      if (!is_near_[c[0]] || !is_near_[c[1]] || !is_near_[c[2]]) continue;
      if (sheet_of(c[0]) != sheet_of(c[1]) || sheet_of(c[1]) != sheet_of(c[2])) mixed.insert(mixed.end(), c.begin(), c.end());
    }
    std::sort(mixed.begin(), mixed.end());
    mixed.erase(std::unique(mixed.begin(), mixed.end()), mixed.end());
    bool changed = true;
    for (int sweep = 0; sweep < kSweeps && changed; ++sweep) {
      changed = false;
      for (const std::uint32_t v : mixed) changed = join_neighbours(v) || changed;
    }
  }

  struct OtherSheet {
    std::uint32_t sheet, facet;  // of a neighbour
    int neighbours;              // on it
  };

  bool join_neighbours(std::uint32_t v) {
    std::vector<OtherSheet>& others = others_;
    others.clear();
    int own = 0;
    Vec3 normal;
    for (const std::uint32_t f : around_[v]) {
      const Facet& c = mesh_.facets[f];
      normal = normal + cross(mesh_.start[c[1]] - mesh_.start[c[0]], mesh_.start[c[2]] - mesh_.start[c[0]]);
      const std::uint32_t w = after(f, v);
      if (mesh_.stays(w)) continue;
      if (sheet_of(w) == sheet_of(v)) {
        ++own;
        continue;
      }
      const auto other = std::find_if(others.begin(), others.end(), [&](const OtherSheet& o) { return o.sheet == sheet_of(w); });
      if (other == others.end()) {
        others.push_back({sheet_of(w), mesh_.sheet[w], 1});
      } else {
        ++other->neighbours;
      }
    }
    const double length = norm(normal);
    if (length == 0) return false;
    std::sort(others.begin(), others.end(), [](const OtherSheet& a, const OtherSheet& b) { return a.sheet < b.sheet; });
    bool changed = false;
    const double here = distance(mesh_.start[v], mesh_.target[v]);
    double best = 0;
    for (const OtherSheet& other : others) {
      const double allowed = kFartherSheet * (other.neighbours - own);
      if (allowed <= best) continue;
      const ReferenceSurface::Foot foot = s_.closest_on_sheet(mesh_.start[v], here + allowed, normal / length, other.facet);
      if (!foot.found()) continue;
      best = allowed;
      mesh_.target[v] = foot.point;
      mesh_.sheet[v] = foot.facet;
      changed = true;
    }
    return changed;
  }

  // The crease between the sheets of u and v, where it is nearest to the segment between their targets. [T-SHARP-2]
  bool crosses(std::uint32_t u, std::uint32_t v, Crossing& crossing, std::uint32_t& hint) const {
    const std::uint32_t f = mesh_.sheet[u], g = mesh_.sheet[v];
    if (f == g) return false;
    const Vec3 &a = mesh_.target[u], &b = mesh_.target[v];
    Vec3 p = (a + b) * 0.5;
    if (s_.connected(f, g, p, 0.6 * distance(a, b) + 0.1)) return false;
    ReferenceSurface::Foot foot;
    for (int round = 0; round < kProjections; ++round) {
      foot = s_.closest_between(p, options_.crease_reach, f, g, hint);
      if (!foot.found()) return false;
      hint = foot.facet;
      const Vec3 next = a + (b - a) * along_segment(foot.point, a, b);
      if (next == p) break;
      p = next;
    }
    if (!s_.parts(foot.facet, f, g) && distance(foot.point, p) > kStrayDistance) return false;
    crossing = {{u, v}, foot.point};
    return true;
  }

  // Each edge of a closed oriented surface is run upwards by one facet.
  void find_crossings() {
    std::vector<std::array<std::uint32_t, 2>> edges;
    for (const std::uint32_t f : near_facets_)
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t u = mesh_.facets[f][i], v = mesh_.facets[f][(i + 1) % 3];
        if (u < v && is_near_[u] && is_near_[v]) edges.push_back({u, v});
      }
    parallel_sort(edges);
    std::vector<Crossing> found(edges.size());
    parallel_ranges(edges.size(), kEdgesAtATime, [&](std::size_t begin, std::size_t end) {
      std::uint32_t hint = kNoFacet;
      for (std::size_t e = begin; e < end; ++e) crosses(edges[e][0], edges[e][1], found[e], hint);
    });
    std::erase_if(found, [](const Crossing& c) { return c.points[0] == c.points[1]; });
    crossings_ = std::move(found);
    list_crossings_at_vertices();
  }

  void list_crossings_at_vertices() {
    first_crossing_.assign(mesh_.start.size() + 1, 0);
    for (const Crossing& c : crossings_)
      for (const std::uint32_t v : c.points) ++first_crossing_[v];
    crossings_at_.resize(exclusive_scan_in_place(first_crossing_));
    std::vector<std::uint32_t> next(first_crossing_.begin(), first_crossing_.end() - 1);
    for (std::uint32_t c = 0; c < crossings_.size(); ++c)
      for (const std::uint32_t v : crossings_[c].points) crossings_at_[next[v]++] = c;
  }
  std::span<const std::uint32_t> crossings_at(std::uint32_t v) const {
    return {crossings_at_.data() + first_crossing_[v], first_crossing_[v + 1] - first_crossing_[v]};
  }

  bool is_settled(const Crossing& c) const { return mesh_.on_crease(c.points[0]) || mesh_.on_crease(c.points[1]); }
  bool is_crossed(std::uint32_t u, std::uint32_t v) const {
    const auto at = crossings_at(u);
    return std::any_of(at.begin(), at.end(), [&](std::uint32_t c) { return crossings_[c].points[0] == v || crossings_[c].points[1] == v; });
  }
  bool is_junction(std::uint32_t f) const {
    const Facet& c = mesh_.facets[f];
    return is_crossed(c[0], c[1]) && is_crossed(c[1], c[2]) && is_crossed(c[2], c[0]);
  }
  std::size_t junctions_at(std::uint32_t v) const {
    if (crossings_at(v).empty()) return 0;
    const auto facets = around_[v];
    return static_cast<std::size_t>(std::count_if(facets.begin(), facets.end(), [&](std::uint32_t f) { return is_junction(f); }));
  }

  // The nearest pairs first, every corner and every vertex once. n sheets meet in n - 2 facets of three sheets each, if labels are what they should be.
  void place_corners() {
    TriangleSoup points;
    for (std::uint32_t i = 0; i < near_.size(); ++i) {
      points.points.push_back(mesh_.start[near_[i]]);
      points.facets.push_back({i, i, i});
    }
    const TriangleIndex index(points);
    const std::vector<std::uint32_t>& corners = s_.creases().corners;
    using Pair = std::tuple<double, std::uint32_t, std::uint32_t>;  // cost, corner, vertex
    std::vector<std::vector<Pair>> pairs_of(corners.size());
    parallel_ranges(corners.size(), kCornersAtATime, [&](std::size_t begin, std::size_t end) {
      std::vector<std::uint32_t> near;
      for (std::size_t i = begin; i < end; ++i) {
        const Vec3& corner = s_.soup().points[corners[i]];
        near.clear();
        index.facets_near(corner, options_.crease_reach * options_.crease_reach, near);
        for (const std::uint32_t n : near) {
          const std::uint32_t v = near_[n];
          const double away = distance(mesh_.start[v], corner);
          if (away > options_.crease_reach || !s_.sheet_meets_corner(mesh_.sheet[v], i)) continue;
          const std::size_t sheets = s_.sheets_at_corner(i), missed = sheets > 2 ? sheets - 2 - std::min(sheets - 2, junctions_at(v)) : 0;
          pairs_of[i].push_back({away + kOffJunction * static_cast<double>(missed), static_cast<std::uint32_t>(i), v});
        }
      }
    });
    std::vector<Pair> pairs;
    for (const auto& some : pairs_of) pairs.insert(pairs.end(), some.begin(), some.end());
    parallel_sort(pairs);
    std::vector<char> placed(corners.size(), 0);
    for (const auto& [cost, corner, v] : pairs) {
      if (placed[corner] || mesh_.on_crease(v)) continue;
      placed[corner] = 1;
      mesh_.kind[v] = SharpenedKind::corner;
      mesh_.target[v] = s_.soup().points[corners[corner]];
    }
  }

  bool is_encircled(std::uint32_t v) const {
    return crossings_at(v).size() == around_[v].size();
  }

  // What v's neighbours lie on must reach the crease: smooth ones are on one of its two sheets, others on a crease that shares one.
  bool fits_around(std::uint32_t v, std::uint32_t crease) const {
    const auto& own = s_.creases().edges[crease].facets;
    const auto meets = [&](std::uint32_t f) { return s_.sheet(f) == s_.sheet(own[0]) || s_.sheet(f) == s_.sheet(own[1]); };
    for (const std::uint32_t f : around_[v])
      for (const std::uint32_t w : mesh_.facets[f]) {
        if (w == v || mesh_.stays(w) || mesh_.kind[w] == SharpenedKind::corner) continue;
        if (mesh_.kind[w] == SharpenedKind::smooth ? meets(mesh_.sheet[w]) : meets_either(crease_of_.at(w), meets)) continue;
        return false;
      }
    return true;
  }
  template <class Meets>
  bool meets_either(std::uint32_t crease, Meets&& meets) const {
    const auto& f = s_.creases().edges[crease].facets;
    return meets(f[0]) || meets(f[1]);
  }

  // A facet whose vertices are all on creases lies between them, and must be one to keep.
  bool may_snap(std::uint32_t v, const Vec3& to) const {
    for (const std::uint32_t f : around_[v]) {
      std::array<Vec3, 3> x;
      bool all = true;
      for (std::size_t i = 0; i < 3; ++i) {
        const std::uint32_t w = mesh_.facets[f][i];
        all = all && (w == v || mesh_.on_crease(w));
        x[i] = w == v ? to : mesh_.target[w];
      }
      if (all && least_sine(x[0], x[1], x[2]) < kLeastSine) return false;
    }
    return true;
  }

  struct Wish {
    double key;
    std::uint32_t vertex, crossing;
    bool operator<(const Wish& o) const { return std::tie(key, vertex, crossing) < std::tie(o.key, o.vertex, o.crossing); }
  };

  // The vertices nearest to their crossings first; those with nothing but crossings around them before all others. [T-SHARP-3]
  void snap_vertices() {
    std::vector<Wish> wishes;
    for (std::uint32_t c = 0; c < crossings_.size(); ++c) {
      const auto& [points, at] = crossings_[c];
      const double a = distance(mesh_.target[points[0]], at), b = distance(mesh_.target[points[1]], at);
      for (std::size_t i = 0; i < 2; ++i) {
        const double own = i == 0 ? a : b, ratio = a + b > 0 ? own / (a + b) : 0;
        const bool encircled = is_encircled(points[i]);
        if (encircled || ratio < kSnapRatio || own < kSnapDistance) wishes.push_back({encircled ? -1 : std::min(ratio, own), points[i], c});
      }
    }
    parallel_sort(wishes);
    // Where a vertex would go is looked up for many at once. It has not moved by its turn, or its crossing is settled.
    std::vector<ReferenceSurface::Foot> feet(kWishesAtATime);
    for (std::size_t begin = 0; begin < wishes.size(); begin += kWishesAtATime) {
      const std::size_t n = std::min(kWishesAtATime, wishes.size() - begin);
      parallel_for(n, [&](std::size_t i) { feet[i] = foot_of(wishes[begin + i]); }, 64);
      for (std::size_t i = 0; i < n; ++i) grant(wishes[begin + i], feet[i]);
    }
  }
  ReferenceSurface::Foot foot_of(const Wish& w) const {
    const Crossing& c = crossings_[w.crossing];
    if (is_settled(c)) return {};
    return s_.closest_between(mesh_.target[w.vertex], options_.crease_reach, mesh_.sheet[c.points[0]], mesh_.sheet[c.points[1]]);
  }
  void grant(const Wish& w, const ReferenceSurface::Foot& foot) {
    if (!foot.found() || is_settled(crossings_[w.crossing]) || !fits_around(w.vertex, foot.facet) || !may_snap(w.vertex, foot.point)) return;
    mesh_.kind[w.vertex] = SharpenedKind::crease;
    mesh_.target[w.vertex] = foot.point;
    crease_of_[w.vertex] = foot.facet;
  }

  SharpenMesh& mesh_;
  const ReferenceSurface& s_;
  const SharpenOptions& options_;
  FacetsAround around_;
  std::vector<std::uint8_t> is_near_;        // per vertex
  std::vector<std::uint32_t> near_;          // vertices
  std::vector<std::uint32_t> near_facets_;
  std::vector<Crossing> crossings_;
  std::vector<std::uint32_t> first_crossing_, crossings_at_;  // per vertex: those at it
  std::vector<OtherSheet> others_;
  std::unordered_map<std::uint32_t, std::uint32_t> crease_of_;  // of crease vertices: edge
};

}  // namespace

std::vector<Crossing> embed_creases(SharpenMesh& mesh, const ReferenceSurface& s, const SharpenOptions& options, Progress& progress) {
  return Embedding(mesh, s, options).run(progress);
}

}  // namespace burnish::detail
