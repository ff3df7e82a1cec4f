#include "burnish/surface/orient.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "burnish/core/parallel.h"
#include "burnish/surface/edge_table.h"

namespace burnish {
namespace {

constexpr int kColumns = 256;          // rays along each side of the bounding box, per axis
constexpr double kGrazing = 0.05;      // facets this parallel to the ray hide others but do not vote
constexpr int kMinVotes = 3;

// Union-find in which every facet carries its parity against the root of its patch.
class ParityForest {
 public:
  explicit ParityForest(std::size_t n) : parent_(n), flipped_(n, 0) {
    for (std::size_t i = 0; i < n; ++i) parent_[i] = static_cast<std::uint32_t>(i);
  }

  // The patch of a facet, and whether the facet runs against the patch' root.
  std::pair<std::uint32_t, bool> find(std::uint32_t facet) {
    std::uint32_t root = facet;
    bool parity = false;
    while (parent_[root] != root) {
      parity ^= flipped_[root] != 0;
      root = parent_[root];
    }
    bool rest = parity;
    while (parent_[facet] != root && facet != root) {
      const std::uint32_t next = parent_[facet];
      const bool here = flipped_[facet] != 0;
      parent_[facet] = root;
      flipped_[facet] = rest;
      rest ^= here;
      facet = next;
    }
    return {root, parity};
  }

  // Joins two facets; `opposed` if one of them has to be turned for the two to agree.
  void join(std::uint32_t f, std::uint32_t g, bool opposed) {
    const auto [rf, pf] = find(f);
    const auto [rg, pg] = find(g);
    if (rf == rg) return;
    const std::uint32_t low = std::min(rf, rg), high = std::max(rf, rg);
    parent_[high] = low;
    flipped_[high] = pf ^ pg ^ opposed;
  }

 private:
  std::vector<std::uint32_t> parent_;
  std::vector<char> flipped_;
};

// Which facets to turn so that patches agree inside, and the patch of every facet. [T-ORI-1]
struct Patches {
  std::vector<std::uint32_t> of_facet;  // dense patch numbers
  std::vector<char> turned;
  std::size_t count = 0;
};

Patches consistent_patches(const TriangleSoup& soup) {
  const EdgeTable table(soup);
  const std::size_t n = soup.facets.size();
  ParityForest forest(n);
  for (std::size_t e = 0; e < table.size(); ++e) {
    const auto uses = table.uses(e);
    if (uses.size() == 2 && uses[0].facet != uses[1].facet)
      forest.join(uses[0].facet, uses[1].facet, uses[0].forward == uses[1].forward);
  }
  Patches patches{std::vector<std::uint32_t>(n), std::vector<char>(n), 0};
  std::vector<std::uint32_t> number(n, 0xffffffffu);
  std::vector<double> keep, turn;  // area of facets that run with, against the root
  for (std::uint32_t f = 0; f < n; ++f) {
    const auto [root, against] = forest.find(f);
    if (number[root] == 0xffffffffu) {
      number[root] = static_cast<std::uint32_t>(patches.count++);
      keep.push_back(0);
      turn.push_back(0);
    }
    patches.of_facet[f] = number[root];
    patches.turned[f] = against;
    (against ? turn : keep)[number[root]] += norm(facet_normal_2a(soup, f));
  }
  for (std::size_t f = 0; f < n; ++f)
    if (turn[patches.of_facet[f]] > keep[patches.of_facet[f]]) patches.turned[f] ^= 1;
  return patches;
}

// What the rays along one axis see first and last. [T-ORI-2]
struct View {
  struct Hit {
    double depth;
    std::uint32_t facet;
  };
  std::vector<Hit> first{std::size_t{kColumns} * kColumns, Hit{std::numeric_limits<double>::infinity(), 0}};
  std::vector<Hit> last{std::size_t{kColumns} * kColumns, Hit{-std::numeric_limits<double>::infinity(), 0}};
};

// The column grid across one axis: columns at cell centres, moved off round numbers.
struct ColumnGrid {
  int axis, u, v;
  double u0, v0, du, dv;

  ColumnGrid(int along, const Box3& box) : axis(along), u((along + 1) % 3), v((along + 2) % 3) {
    const Vec3 e = box.extent();
    du = e[u] / kColumns;
    dv = e[v] / kColumns;
    u0 = box.lower[u] + 0.5137 * du;
    v0 = box.lower[v] + 0.4871 * dv;
  }
};

struct IndexRange {
  int begin, end;
};

IndexRange columns_between(double low, double high, double origin, double step) {
  if (step <= 0) return {0, 0};
  const int begin = static_cast<int>(std::max(0.0, std::ceil((low - origin) / step)));
  const int end = static_cast<int>(std::min<double>(kColumns, std::floor((high - origin) / step) + 1));
  return {begin, end};
}

// The columns of row `y` that a triangle can cover: slivers across the grid must not cost their whole box.
IndexRange columns_of_row(const std::array<Vec3, 3>& v, double y, const ColumnGrid& grid) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (std::size_t i = 0; i < 3; ++i) {
    const Vec3 &p = v[i], &q = v[(i + 1) % 3];
    const double dp = y - p[grid.v], span = q[grid.v] - p[grid.v];
    if ((dp < 0) == (y < q[grid.v]) && dp != 0) continue;
    const double t = span == 0 ? 0 : std::clamp(dp / span, 0.0, 1.0);
    const double x = p[grid.u] + t * (q[grid.u] - p[grid.u]);
    low = std::min({low, x, span == 0 ? q[grid.u] : x});
    high = std::max({high, x, span == 0 ? q[grid.u] : x});
  }
  return low <= high ? columns_between(low - 0.01 * grid.du, high + 0.01 * grid.du, grid.u0, grid.du) : IndexRange{0, 0};
}

void see_facet(const TriangleSoup& soup, std::uint32_t f, const ColumnGrid& grid, View& view) {
  const Vec3 &a = soup.corner(f, 0), &b = soup.corner(f, 1), &c = soup.corner(f, 2);
  const Vec3 n = cross(b - a, c - a);
  if (n[grid.axis] == 0) return;
  const auto [iv, ev] = columns_between(std::min({a[grid.v], b[grid.v], c[grid.v]}),
                                        std::max({a[grid.v], b[grid.v], c[grid.v]}), grid.v0, grid.dv);
  const double side = n[grid.axis] > 0 ? 1 : -1;
  const auto edge = [&](const Vec3& p, const Vec3& q, double x, double y) {
    return side * ((q[grid.u] - p[grid.u]) * (y - p[grid.v]) - (q[grid.v] - p[grid.v]) * (x - p[grid.u]));
  };
  for (int j = iv; j < ev; ++j) {
    const double y = grid.v0 + j * grid.dv;
    const auto [begin, end] = columns_of_row({a, b, c}, y, grid);
    for (int i = begin; i < end; ++i) {
      const double x = grid.u0 + i * grid.du;
      if (edge(a, b, x, y) < 0 || edge(b, c, x, y) < 0 || edge(c, a, x, y) < 0) continue;
      const double depth =
          a[grid.axis] - (n[grid.u] * (x - a[grid.u]) + n[grid.v] * (y - a[grid.v])) / n[grid.axis];
      const std::size_t column = static_cast<std::size_t>(j) * kColumns + static_cast<std::size_t>(i);
      if (depth < view.first[column].depth) view.first[column] = {depth, f};
      if (depth > view.last[column].depth) view.last[column] = {depth, f};
    }
  }
}

struct Votes {
  std::size_t front = 0, back = 0;
};

void count_votes(const TriangleSoup& soup, const Patches& patches, int axis, const View& view,
                 std::vector<Votes>& votes) {
  const auto vote = [&](const View::Hit& hit, double outward) {
    if (!std::isfinite(hit.depth)) return;
    const Vec3 n = facet_normal_2a(soup, hit.facet);
    const double facing = n[axis] * outward * (patches.turned[hit.facet] ? -1 : 1);
    if (std::abs(facing) < kGrazing * norm(n)) return;
    Votes& v = votes[patches.of_facet[hit.facet]];
    ++(facing > 0 ? v.front : v.back);
  };
  for (std::size_t i = 0; i < view.first.size(); ++i) {
    vote(view.first[i], -1);
    vote(view.last[i], +1);
  }
}

std::vector<Votes> visibility_votes(const TriangleSoup& soup, const Patches& patches) {
  const Box3 box = bounding_box(soup);
  std::array<View, 3> views;
  parallel_chunks(3, [&](std::size_t axis) {
    const ColumnGrid grid(static_cast<int>(axis), box);
    for (std::uint32_t f = 0; f < soup.facets.size(); ++f) see_facet(soup, f, grid, views[axis]);
  });
  std::vector<Votes> votes(patches.count);
  for (int axis = 0; axis < 3; ++axis)
    count_votes(soup, patches, axis, views[static_cast<std::size_t>(axis)], votes);
  return votes;
}

}  // namespace

OrientedSoup orient(const TriangleSoup& welded) {
  Patches patches = consistent_patches(welded);
  const std::vector<Votes> votes = visibility_votes(welded, patches);
  OrientedSoup result{welded, 0, patches.count, 0};
  std::vector<char> turn_patch(patches.count);
  for (std::size_t p = 0; p < patches.count; ++p) {
    turn_patch[p] = votes[p].front + votes[p].back >= kMinVotes && votes[p].back > 2 * votes[p].front;
    result.patches_flipped += turn_patch[p] != 0;
  }
  for (std::size_t f = 0; f < welded.facets.size(); ++f) {
    if (patches.turned[f] == turn_patch[patches.of_facet[f]]) continue;
    std::swap(result.soup.facets[f][1], result.soup.facets[f][2]);
    ++result.facets_flipped;
  }
  return result;
}

}  // namespace burnish
