#include "collapsible_mesh.h"

#include "burnish/core/error.h"
#include "burnish/surface/edge_table.h"
#include "burnish/surface/inspect.h"

namespace burnish {
namespace {

void require_manifold(const TriangleSoup& soup, const EdgeTable& table) {
  bool fine = non_manifold_points(soup).empty();
  for (const Facet& f : soup.facets) fine = fine && !repeats_point(f);
  for (std::size_t e = 0; fine && e < table.size(); ++e) fine = !table.is_non_manifold(e) && !table.is_misoriented(e);
  if (!fine) throw Error(ErrorCode::guarantee_unmet, "the surface to simplify is no consistently oriented 2-manifold", "repair it first, as clean() does");
}

}  // namespace

CollapsibleMesh::CollapsibleMesh(const TriangleSoup& soup)
    : points_(soup.points),
      origin_(3 * soup.facets.size()),
      opposite_(3 * soup.facets.size(), kNone),
      out_(soup.points.size(), kNone),
      sharp_(3 * soup.facets.size(), 0),
      seen_(soup.points.size(), 0),
      live_(soup.facets.size()) {
  const EdgeTable table(soup);
  require_manifold(soup, table);
  for (std::size_t h = 0; h < origin_.size(); ++h) origin_[h] = soup.facets[h / 3][h % 3];
  for (std::size_t e = 0; e < table.size(); ++e) {
    const auto uses = table.uses(e);
    const std::uint32_t a = 3 * uses[0].facet + uses[0].side;
    if (uses.size() == 2) link(a, 3 * uses[1].facet + uses[1].side, false);
  }
  for (std::uint32_t h = 0; h < origin_.size(); ++h)
    if (out_[origin_[h]] == kNone || opposite_[h] == kNone) out_[origin_[h]] = h;
}

void CollapsibleMesh::mark_sharp(std::uint32_t h) {
  sharp_[h] = 1;
  if (opposite_[h] != kNone) sharp_[opposite_[h]] = 1;
}

std::size_t CollapsibleMesh::facets_around(std::uint32_t v) const {
  std::size_t count = 0;
  around(v, [&](std::uint32_t) { ++count; });
  return count;
}

bool CollapsibleMesh::collapsible(std::uint32_t h) {
  const std::uint32_t a = origin(h), b = target(h), o = opposite_[h];
  if (o != kNone && on_border(a) && on_border(b)) return false;
  std::size_t facets = 0;
  for (const std::uint32_t side : {h, o}) {
    if (side == kNone) continue;
    ++facets;
    if (sharp(next(side)) && sharp(previous(side))) return false;
    const std::uint32_t v = origin(previous(side));
    if (facets_around(v) < (on_border(v) ? 2u : 4u)) return false;
  }
  const auto neighbours = [&](std::uint32_t v, auto&& visit) {
    around(v, [&](std::uint32_t out) {
      visit(target(out));
      if (opposite_[previous(out)] == kNone) visit(origin(previous(out)));
    });
  };
  ++stamp_;
  neighbours(a, [&](std::uint32_t w) { seen_[w] = stamp_; });
  std::size_t common = 0;
  neighbours(b, [&](std::uint32_t w) { common += seen_[w] == stamp_; });
  return common == facets;
}

void CollapsibleMesh::link(std::uint32_t a, std::uint32_t b, bool sharp) {
  if (a != kNone) opposite_[a] = b, sharp_[a] = sharp;
  if (b != kNone) opposite_[b] = a, sharp_[b] = sharp;
}

// Of h's facet: joins what is on its two other sides.
void CollapsibleMesh::remove_facet(std::uint32_t h) {
  const std::uint32_t n = next(h), p = previous(h);
  link(opposite_[n], opposite_[p], sharp_[n] || sharp_[p]);
  origin_[h] = origin_[n] = origin_[p] = kNone;
  --live_;
}

void CollapsibleMesh::start_at_border(std::uint32_t v, std::uint32_t h) {
  out_[v] = h;
  while (opposite_[out_[v]] != kNone) {
    out_[v] = next(opposite_[out_[v]]);
    if (out_[v] == h) return;
  }
}

void CollapsibleMesh::collapse(std::uint32_t h, const Vec3& to) {
  const std::uint32_t a = origin(h), b = target(h), o = opposite_[h];
  // Half-edges that leave the points whose own may go with the facets.
  std::array<std::array<std::uint32_t, 2>, 4> starts{};
  std::size_t count = 0;
  for (const std::uint32_t side : {h, o}) {
    if (side == kNone) continue;
    const std::uint32_t across = opposite_[next(side)], behind = opposite_[previous(side)];
    starts[count++] = {origin(previous(side)), across != kNone ? across : next(behind)};
    starts[count++] = {a, behind != kNone ? behind : next(across)};
  }
  around(b, [&](std::uint32_t out) { origin_[out] = a; });
  if (o != kNone) remove_facet(o);
  remove_facet(h);
  points_[a] = to;
  out_[b] = kNone;
  for (std::size_t i = 0; i < count; ++i) start_at_border(starts[i][0], starts[i][1]);
}

TriangleSoup CollapsibleMesh::soup(std::vector<std::uint32_t>& from) const {
  TriangleSoup result;
  from.clear();
  std::vector<std::uint32_t> number(points_.size(), kNone);
  for (std::uint32_t v = 0; v < points_.size(); ++v) {
    if (!used(v)) continue;
    number[v] = static_cast<std::uint32_t>(from.size());
    from.push_back(v);
    result.points.push_back(points_[v]);
  }
  result.facets.reserve(live_);
  for (std::size_t h = 0; h < origin_.size(); h += 3)
    if (origin_[h] != kNone) result.facets.push_back({number[origin_[h]], number[origin_[h + 1]], number[origin_[h + 2]]});
  return result;
}

}  // namespace burnish
