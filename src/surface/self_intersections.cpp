// Exact self-intersections: boxes find candidates, floating-point separations with error bounds decide nearly
// all of them, CGAL's filtered exact predicates the rest.

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/intersections.h>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <optional>
#include <utility>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/inspect.h"
#include "box_tree.h"
#include "exact_predicates.h"
#include "facet_kinds.h"

namespace burnish {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Pair = std::array<std::uint32_t, 2>;

Kernel::Point_3 to_cgal(const Vec3& p) { return {p.x, p.y, p.z}; }

double max_norm(const Vec3& v) { return std::max({std::abs(v.x), std::abs(v.y), std::abs(v.z)}); }

// Products of up to four such lengths neither overflow nor lose bits to underflow: error bounds hold.
bool is_moderate(double length) { return length > 1e-60 && length < 1e60; }

// Two facets with their shared points first, in the same order in both.
struct Candidate {
  std::array<Vec3, 3> a, b;
  int shared = 0;
};

Candidate make_candidate(const TriangleSoup& soup, const Facet& f, const Facet& g) {
  Facet a = f;
  Facet b = g;
  Candidate c;
  for (std::size_t i = 0; i < 3; ++i) {
    const auto match = std::find(b.begin() + c.shared, b.end(), a[i]);
    if (match == b.end()) continue;
    const auto at = static_cast<std::size_t>(c.shared++);
    std::swap(b[at], *match);
    std::swap(a[at], a[i]);
  }
  for (std::size_t i = 0; i < 3; ++i) {
    c.a[i] = soup.points[a[i]];
    c.b[i] = soup.points[b[i]];
  }
  return c;
}

// True if the dot products of `direction` show for certain that the triangles are apart, but for the first
// `c.shared` points. The direction itself need not be accurate. With differences, products and sums each
// rounded once, a dot product is off by less than 12 * 2^-53 of the product of the max norms. [T-SELF-1]
bool separated_along(const Vec3& direction, const Candidate& c) {
  const double length = max_norm(direction);
  double low = std::numeric_limits<double>::infinity();
  double high = -low;
  double reach = 0;
  for (auto i = static_cast<std::size_t>(c.shared); i < 3; ++i) {
    const Vec3 u = c.a[i] - c.a[0];
    const Vec3 v = c.b[i] - c.a[0];
    low = std::min(low, dot(direction, u));
    high = std::max(high, dot(direction, v));
    reach = std::max({reach, max_norm(u), max_norm(v)});
  }
  if (!is_moderate(length) || !is_moderate(reach)) return false;
  const double bound = 1e-14 * length * reach;
  if (c.shared == 0) return low - high > 2 * bound;
  return low > bound && high < -bound;
}

// No point shared: the line of centres separates most pairs whose boxes merely overlap.
bool disjoint_facets_meet(const Candidate& c) {
  if (separated_along((c.a[0] + c.a[1] + c.a[2]) - (c.b[0] + c.b[1] + c.b[2]), c)) return false;
  const Kernel::Triangle_3 a(to_cgal(c.a[0]), to_cgal(c.a[1]), to_cgal(c.a[2]));
  const Kernel::Triangle_3 b(to_cgal(c.b[0]), to_cgal(c.b[1]), to_cgal(c.b[2]));
  return CGAL::do_intersect(a, b);
}

// True if p and q lie strictly on one side of the plane of t.
bool strictly_on_one_side(const Kernel::Triangle_3& t, const Kernel::Point_3& p, const Kernel::Point_3& q) {
  const auto side = CGAL::orientation(t[0], t[1], t[2], p);
  return side != CGAL::COPLANAR && side == CGAL::orientation(t[0], t[1], t[2], q);
}

// One point shared: the facets meet elsewhere only if the edge opposite to it of one meets the other.
bool facets_at_point_meet(const Candidate& c) {
  const Vec3 toward_a = (c.a[1] - c.a[0]) + (c.a[2] - c.a[0]);
  const Vec3 toward_b = (c.b[1] - c.b[0]) + (c.b[2] - c.b[0]);
  if (separated_along(toward_a / norm(toward_a) - toward_b / norm(toward_b), c)) return false;
  const Kernel::Triangle_3 a(to_cgal(c.a[0]), to_cgal(c.a[1]), to_cgal(c.a[2]));
  const Kernel::Triangle_3 b(to_cgal(c.b[0]), to_cgal(c.b[1]), to_cgal(c.b[2]));
  if (strictly_on_one_side(a, b[1], b[2]) || strictly_on_one_side(b, a[1], a[2])) return false;
  return CGAL::do_intersect(Kernel::Segment_3(a[1], a[2]), b) ||
         CGAL::do_intersect(Kernel::Segment_3(b[1], b[2]), a);
}

// An edge shared: the facets meet elsewhere only if they are folded flat onto each other. If they are, the
// product below is positive; it is off by less than 100 * 2^-53 of the product of the max norms. [T-SELF-2]
bool facets_at_edge_meet(const Candidate& c) {
  const Vec3 e = c.a[1] - c.a[0];
  const Vec3 u = c.a[2] - c.a[0];
  const Vec3 v = c.b[2] - c.a[0];
  const double le = max_norm(e), lu = max_norm(u), lv = max_norm(v);
  if (is_moderate(le) && is_moderate(lu) && is_moderate(lv) &&
      dot(cross(e, u), cross(e, v)) < -1e-13 * le * le * lu * lv)
    return false;
  const auto p = to_cgal(c.a[0]), q = to_cgal(c.a[1]), r = to_cgal(c.a[2]), s = to_cgal(c.b[2]);
  return CGAL::coplanar(p, q, r, s) && CGAL::coplanar_orientation(p, q, r, s) == CGAL::POSITIVE;
}

bool facets_meet(const TriangleSoup& soup, std::uint32_t f, std::uint32_t g) {
  const Candidate c = make_candidate(soup, soup.facets[f], soup.facets[g]);
  switch (c.shared) {
    case 0: return disjoint_facets_meet(c);
    case 1: return facets_at_point_meet(c);
    case 2: return facets_at_edge_meet(c);
    default: return true;
  }
}

std::vector<std::uint32_t> facets_with_area(const TriangleSoup& soup) {
  const std::vector<FacetKind> kinds = facet_kinds(soup);
  std::vector<std::uint32_t> result;
  result.reserve(kinds.size());
  for (std::uint32_t f = 0; f < kinds.size(); ++f)
    if (kinds[f] != FacetKind::degenerate) result.push_back(f);
  return result;
}

// Appends the intersecting pairs of the leaves [begin, end) while `proceed(pairs found so far)`.
template <class Proceed>
void collect(const TriangleSoup& soup, const BoxTree& tree, std::size_t begin, std::size_t end,
             std::vector<Pair>& pairs, Proceed&& proceed) {
  bool more = true;
  tree.pairs_from_leaves(begin, end, [&](std::uint32_t f, std::uint32_t g) {
    if (facets_meet(soup, f, g)) {
      pairs.push_back({std::min(f, g), std::max(f, g)});
      more = proceed();
    }
    return more;
  });
}

// The pairs of all leaves, unless there are more than max_pairs.
std::optional<std::vector<Pair>> collect_all(const TriangleSoup& soup, const BoxTree& tree,
                                             std::size_t max_pairs, Progress& progress) {
  constexpr std::size_t kLeaves = 256;
  std::vector<std::vector<Pair>> parts((tree.leaf_count() + kLeaves - 1) / kLeaves);
  std::atomic<std::size_t> found{0};
  parallel_ranges(tree.leaf_count(), kLeaves, [&](std::size_t begin, std::size_t end) {
    progress.check();
    collect(soup, tree, begin, end, parts[begin / kLeaves],
            [&] { return found.fetch_add(1, std::memory_order_relaxed) < max_pairs; });
  });
  if (found > max_pairs) return std::nullopt;
  std::vector<Pair> pairs;
  pairs.reserve(found);
  for (const std::vector<Pair>& part : parts) pairs.insert(pairs.end(), part.begin(), part.end());
  return pairs;
}

}  // namespace

bool exactly_collinear(const Vec3& a, const Vec3& b, const Vec3& c) {
  // Rounding moves a component of the cross product by less than 8 * 2^-53 of the product of the max norms.
  const Vec3 u = b - a;
  const Vec3 v = c - a;
  const double lu = max_norm(u), lv = max_norm(v);
  if (is_moderate(lu) && is_moderate(lv) && max_norm(cross(u, v)) > 1e-13 * lu * lv) return false;
  return CGAL::collinear(to_cgal(a), to_cgal(b), to_cgal(c));
}

std::vector<Pair> self_intersecting_pairs(const TriangleSoup& welded, Progress& progress,
                                          std::size_t max_pairs) {
  const BoxTree tree(welded, facets_with_area(welded));
  std::vector<Pair> pairs;
  if (auto all = collect_all(welded, tree, max_pairs, progress)) {
    pairs = std::move(*all);
  } else {
    // Which pairs were found before the limit depended on the threads. A single one settles it.
    collect(welded, tree, 0, tree.leaf_count(), pairs, [&] {
      if (pairs.size() % 4096 == 0) progress.check();
      return pairs.size() < max_pairs;
    });
  }
  parallel_sort(pairs);
  return pairs;
}

}  // namespace burnish
