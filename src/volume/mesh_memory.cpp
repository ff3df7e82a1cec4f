#include "mesh_memory.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/text.h"

namespace burnish {
namespace {

constexpr double kBytesPerCell = 800, kBytesAtSurface = 9000;  // measured; the latter per square of a cell's side, where all of the surface has the finest cells
constexpr double kBytesOfBand = 110, kUsualBand = 8;           // of the level set: what each lattice unit of its band takes more, for the same square
constexpr double kToBeSafe = 1.05;
constexpr std::size_t kMostPieces = 1000;  // of a box, beside others

// What is on the inner side of a plane across an axis.
std::vector<Vec3> cut(const std::vector<Vec3>& polygon, int axis, double at, double side) {
  std::vector<Vec3> kept;
  for (std::size_t i = 0; i < polygon.size(); ++i) {
    const Vec3 &p = polygon[i], &q = polygon[(i + 1) % polygon.size()];
    const double a = side * (p[axis] - at), b = side * (q[axis] - at);
    if (a <= 0) kept.push_back(p);
    if ((a < 0 && b > 0) || (a > 0 && b < 0)) kept.push_back(p + (q - p) * (a / (a - b)));
  }
  return kept;
}

double area_of(const std::vector<Vec3>& polygon) {
  Vec3 twice;
  for (std::size_t i = 2; i < polygon.size(); ++i) twice += cross(polygon[i - 1] - polygon[0], polygon[i] - polygon[0]);
  return 0.5 * norm(twice);
}

std::string rounded_count(double cells) {
  return cells >= 1e6 ? fmt::format("{:.3g}M", cells / 1e6) : cells >= 1e3 ? fmt::format("{:.3g}k", cells / 1e3) : fmt::format("{:.0f}", cells);
}

std::string gigabytes(double bytes) {
  const double n = bytes * 0x1p-30;
  return n >= 10 ? fmt::format("{:.0f} GB", n) : fmt::format("{:.2g} GB", n);
}

// "takes about 2.4 GB; the budget is 1 GB".
std::string amounts(double bytes, const FlowMeshOptions& options) {
  return fmt::format("takes about {}; the budget is {}", gigabytes(bytes), gigabytes(static_cast<double>(options.memory_bytes)));
}

double volume(const LatticeBox& box) {
  double product = 1;
  for (std::size_t a = 0; a < 3; ++a) product *= static_cast<double>(box.upper[a] - box.lower[a]);
  return product;
}

// Appends what a box holds beside another: at most six boxes.
void append_rest(LatticeBox box, const LatticeBox& other, std::vector<LatticeBox>& rest) {
  for (std::size_t a = 0; a < 3; ++a)
    if (other.upper[a] <= box.lower[a] || other.lower[a] >= box.upper[a]) return rest.push_back(box);
  for (std::size_t a = 0; a < 3; ++a) {
    LatticeBox below = box, above = box;
    below.upper[a] = box.lower[a] = std::max(box.lower[a], other.lower[a]);
    above.lower[a] = box.upper[a] = std::min(box.upper[a], other.upper[a]);
    if (below.lower[a] < below.upper[a]) rest.push_back(below);
    if (above.lower[a] < above.upper[a]) rest.push_back(above);
  }
}

// The share of a box that none of the others holds; too much where it is in very many pieces.
double share_beside(const LatticeBox& box, std::span<const LatticeBox> others) {
  std::vector<LatticeBox> pieces{box}, rest;
  for (const LatticeBox& other : others) {
    rest.clear();
    for (const LatticeBox& piece : pieces) append_rest(piece, other, rest);
    pieces.swap(rest);
    if (pieces.empty() || pieces.size() > kMostPieces) break;
  }
  double sum = 0;
  for (const LatticeBox& piece : pieces) sum += volume(piece);
  return sum / volume(box);
}

class MemoryNeed {
 public:
  MemoryNeed(const TriangleSoup& surface, const FlowMeshOptions& options, std::span<const LatticeRefinement> refinements, const LatticeBox& region, int surface_level, double band)
      : options_(options), refinements_(refinements), surface_level_(surface_level), at_surface_(kBytesAtSurface + kBytesOfBand * std::max(0.0, band - kUsualBand)),
        surface_(at_surface_ * area(surface) / (options.cell * options.cell)), region_(kBytesPerCell * region.octants(surface_level + options.coarsest_level)) {
    count_boxes(surface);
  }

  void require() const {
    double total = surface_ + region_;
    for (const double b : boxes_) total += b;
    const auto budget = static_cast<double>(options_.memory_bytes);
    if (total <= budget) return;
    if (surface_ + region_ > budget) refuse_cell(surface_ + region_, budget);
    refuse_box(static_cast<std::size_t>(std::max_element(boxes_.begin(), boxes_.end()) - boxes_.begin()), total, budget);
  }

 private:
  double cell_of(int level) const { return std::ldexp(options_.cell, level - surface_level_); }

  // Of each box what is in none of smaller cells, and in none before it of the same.
  void count_boxes(const TriangleSoup& surface) {
    std::vector<std::size_t> order(refinements_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return refinements_[a].level < refinements_[b].level; });
    boxes_.resize(order.size());
    std::vector<LatticeBox> before;
    for (const std::size_t i : order) {
      boxes_[i] = share_beside(refinements_[i].box, before) * of_box(refinements_[i], surface);
      before.push_back(refinements_[i].box);
    }
  }

  double of_box(const LatticeRefinement& r, const TriangleSoup& surface) const {
    const double cells = 8 * r.box.octants(r.level + 1) * kBytesPerCell, side = cell_of(r.level);
    return r.level < surface_level_ ? cells + at_surface_ * area_within(surface, options_.refinements[r.number].box) / (side * side) : cells;
  }

  [[noreturn]] void refuse_cell(double bytes, double budget) const {
    // The number of cells goes with the square of their side at the surface, with its cube elsewhere.
    const double fits = kToBeSafe * options_.cell * std::sqrt(bytes / budget);
    throw Error(ErrorCode::memory_limit, fmt::format("a mesh with cells of {:.4g} {}", options_.cell, amounts(bytes, options_)),
                region_ > surface_ ? fmt::format("cells away from the surface take most: give a higher --coarsest, a smaller --domain, or --cell {:.3g}, or raise --memory", fits)
                                   : fmt::format("choose --cell {:.3g} or larger, or raise --memory", fits));
  }

  [[noreturn]] void refuse_box(std::size_t i, double total, double budget) const {
    const LatticeRefinement& r = refinements_[i];
    const double left = budget - (total - boxes_[i]);
    // Twice the side is a quarter of the cells at most. No larger ones are named than at the surface.
    const int coarser = left > 0 ? static_cast<int>(std::ceil(std::log2(boxes_[i] / left) / 2)) : 0;
    const std::string cells = coarser > 0 ? fmt::format("cells of {:.4g}", cell_of(std::min(r.level + coarser, std::max(r.level, surface_level_)))) : "larger cells";
    throw Error(ErrorCode::memory_limit,
                fmt::format("a mesh with cells of {:.4g} at the surface and of {:.4g} in the box {} {}", options_.cell, cell_of(r.level), text_of(options_.refinements[r.number].box), amounts(total, options_)),
                fmt::format("give the box {}, or make it smaller, or raise --memory", cells));
  }

  const FlowMeshOptions& options_;
  std::span<const LatticeRefinement> refinements_;
  int surface_level_;
  double at_surface_;        // bytes for a square of a cell's side
  double surface_, region_;  // bytes
  std::vector<double> boxes_;
};

}  // namespace

double area_within(const TriangleSoup& surface, const Box3& box) {
  double sum = 0;
  for (std::size_t f = 0; f < surface.facets.size(); ++f) {
    std::vector<Vec3> polygon{surface.corner(f, 0), surface.corner(f, 1), surface.corner(f, 2)};
    for (int a = 0; a < 3 && !polygon.empty(); ++a) polygon = cut(cut(polygon, a, box.upper[a], 1), a, box.lower[a], -1);
    sum += area_of(polygon);
  }
  return sum;
}

void require_memory(const TriangleSoup& surface, const FlowMeshOptions& options, std::span<const LatticeRefinement> refinements, const LatticeBox& region, int surface_level, double band) {
  MemoryNeed(surface, options, refinements, region, surface_level, band).require();
}

void require_memory(std::uint64_t cells, const FlowMeshOptions& options) {
  const double bytes = kBytesPerCell * static_cast<double>(cells), budget = static_cast<double>(options.memory_bytes);
  if (bytes <= budget) return;
  throw Error(ErrorCode::memory_limit, fmt::format("a mesh with cells of {:.4g} has about {} cells and {}", options.cell, rounded_count(static_cast<double>(cells)), amounts(bytes, options)),
              fmt::format("choose --cell {:.3g} or larger{}, or raise --memory", kToBeSafe * options.cell * std::sqrt(bytes / budget), options.refinements.empty() ? "" : ", or larger cells in boxes"));
}

}  // namespace burnish
