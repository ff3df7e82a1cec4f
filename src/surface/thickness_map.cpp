// Thickness by balls that shrink until they meet no facet that faces them.
#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>

#include "burnish/core/parallel.h"
#include "burnish/core/union_find.h"
#include "burnish/surface/thickness.h"
#include "burnish/surface/triangle_index.h"

namespace burnish {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kStart = 1e-9;      // of the diagonal: rays begin that far inside
constexpr double kOpposed = -0.5;    // cosine between the normals of the two sides of a wall
constexpr double kFirst = 1e-2;      // of the radius: what a facet may reach into the first ball; a ball in a sphere touches all of it, and only so are most boxes passed over
constexpr double kLater = 1e-4;      // and into later ones
constexpr double kRounding = 1e-12;   // of products of normals
constexpr double kSpread = 0.98;      // of squared distances: any facet in the ball shrinks it, and the closest of a ring around its centre costs the whole ring
constexpr int kMostRounds = 40;
constexpr double kBlocked = 1e-6;    // of the way to a contact
constexpr double kInset = 1e-2;      // of the way from a point to its facet's centroid
constexpr std::size_t kGrain = 64;

class BallShrinker {
 public:
  BallShrinker(const TriangleSoup& soup) : soup_(soup), index_(soup), start_(kStart * bounding_box(soup).diagonal()), normals_(soup.facets.size()) {
    parallel_for(normals_.size(), [&](std::size_t f) {
      const Vec3 n = facet_normal_2a(soup, f);
      normals_[f] = norm(n) > 0 ? n / norm(n) : Vec3{};
    });
    node_normals_ = index_.boxes_of_nodes([&](std::uint32_t f) { return normals_[f]; });
  }

  // At p on facet f, which has an area. [T-THICK-2]
  double thickness(const Vec3& p, std::size_t f, std::uint32_t* opposite = nullptr) const {
    const Vec3 inwards = -normals_[f];
    const TriangleIndex::Hit hit = index_.first_hit(p + inwards * start_, inwards);
    if (hit.facet == kNoFacet) return kInfinity;
    std::uint32_t contact = hit.facet;
    double radius = (hit.distance + start_) / 2;
    double slack = kFirst;
    for (int round = 0; round < kMostRounds; ++round) {
      const Vec3 centre = p + inwards * radius;
      const double within = radius * (1 - slack);
      const TriangleIndex::Closest q = index_.closest_of(centre, within * within, [&](std::uint32_t g) { return dot(normals_[g], normals_[f]) < kOpposed; },
                                                         [&](std::uint32_t node) { return may_oppose(node, normals_[f]); }, kSpread);
      if (q.facet == kNoFacet || is_foreign(centre, q)) break;
      const double depth = dot(q.point - p, inwards);
      const double smaller = squared_norm(q.point - p) / (2 * depth);
      if (!(depth > 0) || !(smaller < radius)) break;
      radius = smaller;
      contact = q.facet;
      slack = kLater;
    }
    if (opposite) *opposite = contact;
    return 2 * radius;
  }

  bool has_area(std::size_t f) const { return squared_norm(normals_[f]) > 0; }

 private:
  // A facet that the ball reaches through the air: seen from its front, or behind another.
  bool is_foreign(const Vec3& centre, const TriangleIndex::Closest& q) const {
    const Vec3 way = q.point - centre;
    const double length = std::sqrt(q.squared_distance);
    if (!(dot(way, normals_[q.facet]) >= 0)) return true;
    return length > 0 && index_.first_hit(centre, way / length, length * (1 - kBlocked)).facet != kNoFacet;
  }

  // False only where no facet below a node of the index is opposed to a normal: the least product with what the box of their normals holds.
  bool may_oppose(std::uint32_t node, const Vec3& n) const {
    const Box3& box = node_normals_[node];
    double least = 0;
    for (int a = 0; a < 3; ++a) least += std::min(box.lower[a] * n[a], box.upper[a] * n[a]);
    return least < kOpposed + kRounding;
  }

  const TriangleSoup& soup_;
  TriangleIndex index_;
  double start_;
  std::vector<Vec3> normals_;
  std::vector<Box3> node_normals_;
};

// The point number `i` of a sequence that fills a triangle evenly (Roberts' R2, folded).
Vec3 spread_point(const TriangleSoup& soup, std::size_t f, std::size_t i) {
  constexpr double kFirstStep = 0.7548776662466927, kSecondStep = 0.5698402909980532;
  double u = std::fmod(1.0 / 3 + static_cast<double>(i) * kFirstStep, 1.0), v = std::fmod(1.0 / 3 + static_cast<double>(i) * kSecondStep, 1.0);
  if (u + v > 1) u = 1 - u, v = 1 - v;
  const Vec3& a = soup.corner(f, 0);
  return a + (soup.corner(f, 1) - a) * u + (soup.corner(f, 2) - a) * v;
}

Vec3 centroid(const TriangleSoup& soup, std::size_t f) { return (soup.corner(f, 0) + soup.corner(f, 1) + soup.corner(f, 2)) / 3.0; }

std::vector<ThicknessSample> places_of_samples(const TriangleSoup& soup, std::size_t more) {
  std::vector<ThicknessSample> samples;
  const double total = area(soup);
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const double own = norm(facet_normal_2a(soup, f)) / 2;
    if (!(own > 0)) continue;
    const auto count = 1 + static_cast<std::size_t>(own / total * static_cast<double>(more));
    for (std::size_t i = 0; i < count; ++i) samples.push_back({spread_point(soup, f, i), static_cast<std::uint32_t>(f), own / static_cast<double>(count)});
  }
  return samples;
}

// Calls `body(i)` for each of n with its progress told.
template <class Body>
void counted_for(std::size_t n, Progress& progress, Body&& body) {
  constexpr std::size_t kPart = std::size_t{1} << 14;
  for (std::size_t begin = 0; begin < n; begin += kPart) {
    progress.check();
    progress.update(static_cast<double>(begin) / static_cast<double>(n));
    parallel_for(std::min(kPart, n - begin), [&](std::size_t i) { body(begin + i); }, kGrain);
  }
}

std::vector<std::uint32_t> largest_facets(const TriangleSoup& soup) {
  std::vector<std::uint32_t> largest(soup.points.size(), kNoFacet);
  std::vector<double> size(soup.points.size(), 0.0);
  for (std::size_t f = 0; f < soup.facets.size(); ++f) {
    const double own = squared_norm(facet_normal_2a(soup, f));
    for (const std::uint32_t p : soup.facets[f])
      if (own > size[p]) size[p] = own, largest[p] = static_cast<std::uint32_t>(f);
  }
  return largest;
}

std::vector<ThinPlace> thin_places(const TriangleSoup& soup, const std::vector<ThicknessSample>& samples, double limit) {
  UnionFind pieces(soup.points.size());
  for (const ThicknessSample& s : samples) {
    if (!(s.thickness < limit)) continue;
    const std::uint32_t first = soup.facets[s.facet][0];
    for (const std::uint32_t f : {s.facet, s.opposite})
      for (const std::uint32_t p : soup.facets[f]) pieces.unite(first, p);
  }
  std::vector<std::uint32_t> number(soup.points.size(), kNoFacet);
  std::vector<ThinPlace> places;
  for (const ThicknessSample& s : samples) {
    if (!(s.thickness < limit)) continue;
    std::uint32_t& place = number[pieces.find(soup.facets[s.facet][0])];
    if (place == kNoFacet) {
      place = static_cast<std::uint32_t>(places.size());
      places.push_back({s.at, s.thickness, 0, {}, s.facet});
    }
    ThinPlace& p = places[place];
    if (s.thickness < p.thickness) p.position = s.at, p.thickness = s.thickness, p.facet = s.facet;
    p.area += s.area;
    p.box.extend(s.at);
  }
  std::stable_sort(places.begin(), places.end(), [](const ThinPlace& a, const ThinPlace& b) { return a.thickness < b.thickness; });
  return places;
}

}  // namespace

std::vector<ThicknessSample> thickness_samples(const TriangleSoup& oriented, std::size_t more, Progress& progress) {
  std::vector<ThicknessSample> samples = places_of_samples(oriented, more);
  if (samples.empty()) return samples;
  const BallShrinker balls(oriented);
  counted_for(samples.size(), progress, [&](std::size_t i) { samples[i].thickness = balls.thickness(samples[i].at, samples[i].facet, &samples[i].opposite); });
  return samples;
}

std::vector<double> thickness_at_points(const TriangleSoup& oriented, Progress& progress) {
  std::vector<double> thickness(oriented.points.size(), std::numeric_limits<double>::quiet_NaN());
  const std::vector<std::uint32_t> facets = largest_facets(oriented);
  if (oriented.facets.empty()) return thickness;
  const BallShrinker balls(oriented);
  counted_for(thickness.size(), progress, [&](std::size_t i) {
    const std::uint32_t f = facets[i];
    if (f != kNoFacet && balls.has_area(f)) thickness[i] = balls.thickness(oriented.points[i] * (1 - kInset) + centroid(oriented, f) * kInset, f);
  });
  return thickness;
}

ThicknessSummary summary_of(const TriangleSoup& welded, const std::vector<ThicknessSample>& samples, double limit) {
  ThicknessSummary s;
  s.limit = limit;
  std::vector<std::size_t> order;
  for (std::size_t i = 0; i < samples.size(); ++i)
    if (std::isfinite(samples[i].thickness)) order.push_back(i);
  if (order.empty()) return s;
  std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return samples[a].thickness < samples[b].thickness; });
  for (const std::size_t i : order) {
    s.area += samples[i].area;
    s.mean += samples[i].area * samples[i].thickness;
    if (samples[i].thickness < limit) s.thin_area += samples[i].area;
  }
  s.mean /= s.area;
  s.samples = order.size();
  s.minimum = samples[order[0]].thickness;
  s.thinnest_at = samples[order[0]].at;
  double passed = 0;
  std::size_t next = 0;
  for (const std::size_t i : order) {
    passed += samples[i].area;
    while (next < s.percentiles.size() && passed >= ThicknessSummary::kPercentiles[next] / 100 * s.area) s.percentiles[next++] = samples[i].thickness;
  }
  while (next < s.percentiles.size()) s.percentiles[next++] = samples[order.back()].thickness;
  if (limit > 0) s.places = thin_places(welded, samples, limit);
  return s;
}

}  // namespace burnish
