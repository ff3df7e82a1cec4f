#include "edge_collapser.h"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <numeric>

#include "burnish/core/parallel.h"
#include "burnish/surface/shells.h"

namespace burnish {
namespace {

constexpr double kBorderTurn = 30 * std::numbers::pi / 180;  // as at the corners of creases
constexpr double kLeastChain = 4;      // mean edges: shorter creases with a free end are noise
constexpr double kLeastOfResult = 2;   // mean edges of the result: shorter ones would show as spikes
constexpr double kUpright = 0.3;       // weight of the planes upright on creases and borders
constexpr double kMiddle = 1e-3;       // how much of the quadric pulls towards the middle where planes leave a direction free
constexpr double kFlat = 1e-7;         // squared distances, of squared edges: what a collapse costs at least
constexpr double kGoodShape = 0.3;     // from there on the shape of facets costs nothing
constexpr double kWorstShape = 0.01;
constexpr double kLargestTurn = 0.5;   // cosine: how far one collapse may turn a facet
constexpr double kRise = 1e-6;         // a cost that is higher by more than this share is put back
constexpr std::size_t kCheckEvery = 1024;

// 1 for an equilateral triangle, 0 for one without area: 4 sqrt(3) area / sum of squared edges. [T-SIMP-3]
double shape(double twice_area, double edges) { return edges > 0 ? 2 * std::numbers::sqrt3 * twice_area / edges : 0; }

// The shape of an isosceles needle with this angle, which no triangle with a smaller one exceeds.
double shape_of_angle(double degrees) {
  const double a = degrees * std::numbers::pi / 180;
  return shape(std::sin(a), 4 - 2 * std::cos(a));
}

struct Triangle {
  Vec3 normal;  // twice the area long
  double edges = 0;
  Triangle(const Vec3& a, const Vec3& b, const Vec3& c)
      : normal(cross(b - a, c - a)), edges(squared_norm(b - a) + squared_norm(c - b) + squared_norm(a - c)) {}
};

bool turns(const Vec3& in, const Vec3& out, double angle) { return dot(in, out) < std::cos(angle) * norm(in) * norm(out); }

using Kind = CollapseStart::Kind;

// How long a crease with a free end has to be.
double least_chain(const TriangleSoup& soup, const SimplifyOptions& options) {
  const double fewer = options.facets ? static_cast<double>(soup.facets.size()) / static_cast<double>(std::max<std::size_t>(*options.facets, 1)) : 1;
  return mean_edge_length(soup) * std::max(kLeastChain, kLeastOfResult * std::sqrt(fewer));
}

// The fewest facets of any mesh with these corners, however it is connected: 2 inner points + border points - 2 Euler characteristic.
std::size_t least_facets(const CollapsibleMesh& mesh, const Creases& creases, std::size_t shells) {
  std::size_t count = 0;
  for (const std::uint32_t p : creases.corners) count += mesh.on_border(p) ? 1 : 2;
  return count - std::min(count, 4 * shells);
}

// Creases whose corners alone exceed the asked facets are looked for at larger angles: `angle` is the one that was taken. With a deviation all are
// tried: its result with more facets than asked may be the best there is. [T-SIMP-6]
Creases creases_with_room(const TriangleSoup& soup, const CollapsibleMesh& mesh, const SimplifyOptions& options, double& angle) {
  const bool all = !options.facets || options.deviation;
  const std::size_t shells = all ? 0 : find_shells(soup).shells.size();
  for (;; angle = CollapseStart::raised(angle)) {
    Creases creases = find_creases(soup, {.angle = angle, .least_length = least_chain(soup, options)});
    if (all || angle >= 180 || least_facets(mesh, creases, shells) <= *options.facets + 1) return creases;
  }
}

void mark_creases(const TriangleSoup& soup, const Creases& creases, CollapsibleMesh& mesh, std::vector<Kind>& kinds) {
  for (const CreaseEdge& e : creases.edges) {
    const Facet& f = soup.facets[e.facets[0]];
    for (std::uint32_t i = 0; i < 3; ++i)
      if (f[i] == e.points[0]) mesh.mark_sharp(3 * e.facets[0] + i);
    for (const std::uint32_t p : e.points) kinds[p] = Kind::chain;
  }
  for (const std::uint32_t p : creases.corners) kinds[p] = Kind::corner;
}

void mark_borders(CollapsibleMesh& mesh, std::vector<Kind>& kinds) {
  for (std::uint32_t v = 0; v < mesh.points(); ++v) {
    if (!mesh.used(v) || !mesh.on_border(v)) continue;
    std::uint32_t first = CollapsibleMesh::kNone, last = first;
    mesh.around(v, [&](std::uint32_t h) {
      if (first == CollapsibleMesh::kNone) first = h;
      last = h;
    });
    const Vec3 out = mesh.point(mesh.target(first)) - mesh.point(v), in = mesh.point(v) - mesh.point(mesh.origin(CollapsibleMesh::previous(last)));
    kinds[v] = kinds[v] != Kind::smooth || turns(in, out, kBorderTurn) ? Kind::corner : Kind::chain;
  }
}

// [T-SIMP-1]
ErrorQuadric quadric_at(const CollapsibleMesh& mesh, std::uint32_t v) {
  ErrorQuadric q;
  mesh.around(v, [&](std::uint32_t h) {
    const std::uint32_t p = CollapsibleMesh::previous(h);
    const Vec3 &at = mesh.point(v), &next = mesh.point(mesh.target(h)), &last = mesh.point(mesh.origin(p));
    const Vec3 normal = cross(next - at, last - at);
    const double twice_area = norm(normal);
    if (!(twice_area > 0)) return;
    q.add_plane(normal / twice_area, twice_area / 6);
    for (const auto& [side, along] : {std::pair{h, next - at}, std::pair{p, last - at}}) {
      const Vec3 upright = cross(normal, along);
      if (mesh.sharp(side) && squared_norm(upright) > 0) q.add_plane(upright / norm(upright), kUpright * squared_norm(along));
    }
  });
  return q;
}

}  // namespace

CollapseStart::CollapseStart(const TriangleSoup& welded, const SimplifyOptions& options, double least_crease_angle)
    : crease_angle(least_crease_angle), mesh(welded), kinds(welded.points.size(), Kind::smooth), quadrics(welded.points.size()) {
  mark_creases(welded, creases_with_room(welded, mesh, options, crease_angle), mesh, kinds);
  mark_borders(mesh, kinds);
  parallel_for(mesh.points(), [&](std::size_t v) {
    if (mesh.used(static_cast<std::uint32_t>(v))) quadrics[v] = quadric_at(mesh, static_cast<std::uint32_t>(v));
  });
}

EdgeCollapser::EdgeCollapser(const CollapseStart& start, const SimplifyOptions& options, const std::vector<Restraint>& restraints,
                             DeviationEnvelope* envelope, Progress& progress)
    : options_(options), envelope_(envelope), progress_(progress), mesh_(start.mesh), kinds_(start.kinds), quadrics_(start.quadrics),
      restraints_(restraints), size_(restraints.size(), 1), into_(restraints.size()), version_(restraints.size(), 0), least_shape_(shape_of_angle(options.least_angle)) {
  std::iota(into_.begin(), into_.end(), 0u);
}

bool EdgeCollapser::done() const {
  if (options_.facets) return mesh_.facets() <= *options_.facets + (mesh_.facets() % 2 == *options_.facets % 2 ? 0 : 1);
  return !options_.deviation;
}

// Passes over all edges until one changes nothing: a collapse may be refused now and be possible once those around have gone.
void EdgeCollapser::run() {
  const double all = static_cast<double>(mesh_.facets());
  const double goal = options_.facets ? static_cast<double>(std::min(*options_.facets, mesh_.facets())) : 0;
  std::size_t before = 0, steps = 0;
  do {
    before = collapsed_;
    beyond_deviation_ = beyond_limit_ = 0;
    fill_queue();
    while (!done() && !queue_.empty()) {
      const Candidate candidate = queue_.top();
      queue_.pop();
      take(candidate);
      if (++steps % kCheckEvery != 0) continue;
      progress_.check();
      progress_.update(std::min(1.0, (all - static_cast<double>(mesh_.facets())) / std::max(1.0, all - goal)));
    }
  } while (!done() && collapsed_ != before);
}

void EdgeCollapser::fill_queue() {
  std::vector<double> costs(mesh_.half_edges(), -1);
  parallel_for(costs.size(), [&](std::size_t i) {
    const auto h = static_cast<std::uint32_t>(i);
    if (!mesh_.alive(h / 3) || mesh_.edge(h) != h) return;
    if (const std::optional<Merge> merge = evaluate(h)) costs[i] = merge->cost;
  });
  std::vector<Candidate> candidates;
  for (std::uint32_t h = 0; h < costs.size(); ++h)
    if (costs[h] >= 0) candidates.push_back({costs[h], h, version(h)});
  queue_ = std::priority_queue<Candidate>(std::less<Candidate>{}, std::move(candidates));
}

void EdgeCollapser::push(std::uint32_t h) {
  if (const std::optional<Merge> merge = evaluate(h)) queue_.push({merge->cost, h, version(h)});
}

void EdgeCollapser::push_around(std::uint32_t v) {
  mesh_.around(v, [&](std::uint32_t h) {
    push(mesh_.edge(h));
    if (mesh_.opposite(CollapsibleMesh::previous(h)) == CollapsibleMesh::kNone) push(CollapsibleMesh::previous(h));
  });
}

// Chains keep to themselves, corners stay.
bool EdgeCollapser::may_merge(std::uint32_t a, std::uint32_t b, bool sharp) const {
  if (kinds_[a] == Kind::corner && kinds_[b] == Kind::corner) return false;
  return sharp || kinds_[a] == Kind::smooth || kinds_[b] == Kind::smooth;
}

// [T-SIMP-2]
Vec3 EdgeCollapser::best_place(std::uint32_t a, std::uint32_t b, const ErrorQuadric& q, const Vec3& middle) const {
  if (kinds_[a] != kinds_[b]) return mesh_.point(kinds_[a] > kinds_[b] ? a : b);
  const Vec3 half = (mesh_.point(b) - mesh_.point(a)) * 0.5;
  const Vec3 best = q.minimum(kMiddle);
  if (squared_norm(best) <= 4 * squared_norm(half)) return middle + best;
  const double at_a = q.at(-half), at_b = q.at(half), at_middle = q.at({});
  if (at_middle <= at_a && at_middle <= at_b) return middle;
  return mesh_.point(at_a <= at_b ? a : b);
}

// The facets that v would take along to `to`. False if one turns too far.
bool EdgeCollapser::look_around(std::uint32_t v, std::uint32_t other, const Vec3& to, double& worst, double& worst_before, double& area) const {
  bool fine = true;
  mesh_.around(v, [&](std::uint32_t h) {
    const std::uint32_t p = mesh_.target(h), q = mesh_.origin(CollapsibleMesh::previous(h));
    const Triangle before(mesh_.point(v), mesh_.point(p), mesh_.point(q));
    const double old_area = norm(before.normal);
    worst_before = std::min(worst_before, shape(old_area, before.edges));
    area += old_area;
    if (!fine || p == other || q == other) return;
    const Triangle after(to, mesh_.point(p), mesh_.point(q));
    const double new_area = norm(after.normal);
    worst = std::min(worst, shape(new_area, after.edges));
    fine = new_area > 0 && dot(before.normal, after.normal) >= kLargestTurn * old_area * new_area;
  });
  return fine;
}

std::optional<EdgeCollapser::Merge> EdgeCollapser::evaluate(std::uint32_t h) const {
  const std::uint32_t a = mesh_.origin(h), b = mesh_.target(h);
  if (!may_merge(a, b, mesh_.sharp(h))) return std::nullopt;
  const Vec3 &pa = mesh_.point(a), &pb = mesh_.point(b), middle = (pa + pb) * 0.5;
  ErrorQuadric q = quadrics_[a].moved(middle - pa);
  q += quadrics_[b].moved(middle - pb);
  Merge merge{.cost = 0, .to = best_place(a, b, q, middle)};
  double worst = 1, worst_before = 1, area = 0;
  if (!look_around(a, b, merge.to, worst, worst_before, area) || !look_around(b, a, merge.to, worst, worst_before, area)) return std::nullopt;
  if (worst < least_shape_ && worst < worst_before) return std::nullopt;
  const double error = std::max(0.0, q.at(merge.to - middle)) + kFlat * area * squared_norm(pb - pa);
  merge.cost = error * kGoodShape / std::clamp(worst, kWorstShape, kGoodShape);
  return merge;
}

// Costs were true when they were computed; facets around may have changed since.
bool EdgeCollapser::take(const Candidate& candidate) {
  const std::uint32_t h = candidate.edge;
  if (!mesh_.alive(h / 3) || version(h) != candidate.version) return false;
  const std::optional<Merge> now = evaluate(h);
  if (!now) return false;
  if (now->cost > candidate.cost * (1 + kRise)) {
    queue_.push({now->cost, h, candidate.version});
    return false;
  }
  const std::uint32_t a = mesh_.origin(h), b = mesh_.target(h);
  Restraint both = restraints_[a];
  both.join(restraints_[b]);
  if (size_[a] + size_[b] > both.most) return ++beyond_limit_, false;
  if (!mesh_.collapsible(h)) return false;
  if (envelope_ && !envelope_->admits(mesh_, h, now->to, both.deviation)) return ++beyond_deviation_, false;
  merge(h, *now);
  return true;
}

void EdgeCollapser::merge(std::uint32_t h, const Merge& merge) {
  const std::uint32_t a = mesh_.origin(h), b = mesh_.target(h);
  quadrics_[a] = quadrics_[a].moved(merge.to - mesh_.point(a));
  quadrics_[a] += quadrics_[b].moved(merge.to - mesh_.point(b));
  kinds_[a] = std::max(kinds_[a], kinds_[b]);
  restraints_[a].join(restraints_[b]);
  size_[a] += size_[b];
  version_[a] = std::max(version_[a], version_[b]) + 1;
  into_[b] = a;
  mesh_.collapse(h, merge.to);
  if (envelope_) envelope_->accept();
  ++collapsed_;
  push_around(a);
}

std::uint32_t EdgeCollapser::merged(std::uint32_t v) const {
  while (into_[v] != v) v = into_[v];
  return v;
}

bool EdgeCollapser::creases_stopped_it() const {
  std::size_t kept = 0;
  for (std::uint32_t h = 0; h < mesh_.half_edges(); ++h)
    kept += mesh_.alive(h / 3) && mesh_.edge(h) == h && !may_merge(mesh_.origin(h), mesh_.target(h), mesh_.sharp(h));
  return kept > beyond_deviation_;
}

std::string EdgeCollapser::what_stopped_it() const {
  if (beyond_deviation_ > 0) return "fewer facets would leave the deviation";
  if (beyond_limit_ > 0) return "fewer facets would intersect";
  return "creases, topology and the shape of facets allow no fewer";
}

}  // namespace burnish
