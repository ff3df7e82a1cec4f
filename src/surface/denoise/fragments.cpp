#include <vector>

#include "burnish/surface/outliers.h"
#include "burnish/surface/shells.h"

namespace burnish {
namespace {

constexpr double kAreaShare = 1e-4, kExtentShare = 0.02;

struct Piece {
  double area = 0;
  Box3 box;
};

}  // namespace

std::vector<std::uint32_t> find_fragments(const TriangleSoup& welded) {
  UnionFind sets = connected_points(welded);
  std::vector<Piece> pieces(welded.points.size());
  for (std::size_t f = 0; f < welded.facets.size(); ++f) {
    Piece& piece = pieces[sets.find(welded.facets[f][0])];
    piece.area += 0.5 * norm(facet_normal_2a(welded, f));
    for (int i = 0; i < 3; ++i) piece.box.extend(welded.corner(f, i));
  }
  Piece largest;
  for (const Piece& piece : pieces)
    if (piece.area > largest.area) largest = piece;
  std::vector<std::uint32_t> fragments;
  for (std::uint32_t f = 0; f < welded.facets.size(); ++f) {
    const Piece& piece = pieces[sets.find(welded.facets[f][0])];
    if (piece.area < kAreaShare * largest.area && piece.box.diagonal() < kExtentShare * largest.box.diagonal()) fragments.push_back(f);
  }
  return fragments;
}

}  // namespace burnish
