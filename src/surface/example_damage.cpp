// Noise and holes.
#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "example_parts.h"

namespace burnish::example {
namespace {

// Unit normals at the points, facets weighted by area.
std::vector<Vec3> point_normals(const TriangleSoup& soup) {
  std::vector<Vec3> normals(soup.points.size());
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    for (const std::uint32_t p : soup.facets[f]) normals[p] += facet_normal_2a(soup, f);
  for (Vec3& n : normals) n = squared_norm(n) > 0 ? n / norm(n) : Vec3{};
  return normals;
}

// For every point, the facets around it.
class Stars {
 public:
  explicit Stars(const TriangleSoup& soup) : first_(soup.points.size() + 1), facets_(3 * soup.facets.size()) {
    for (const Facet& facet : soup.facets)
      for (const std::uint32_t p : facet) ++first_[p + 1];
    for (std::size_t p = 1; p < first_.size(); ++p) first_[p] += first_[p - 1];
    std::vector<std::size_t> next = first_;
    for (std::size_t f = 0; f < soup.facets.size(); ++f)
      for (const std::uint32_t p : soup.facets[f]) facets_[next[p]++] = f;
  }

  std::span<const std::size_t> operator[](std::size_t point) const {
    return {facets_.data() + first_[point], facets_.data() + first_[point + 1]};
  }

 private:
  std::vector<std::size_t> first_;
  std::vector<std::size_t> facets_;
};

struct Hole {
  std::uint32_t center = 0;
  double radius = 0;
};

class HoleCutter {
 public:
  explicit HoleCutter(TriangleSoup& soup)
      : soup_(soup), stars_(soup), removed_(soup.facets.size()), edge_(mean_edge_length(soup)),
        area_(area(soup)) {}

  void cut(int holes, std::size_t seed_facets, Random& random) {
    // So small that all holes together, were they flat, would take a sixteenth of the surface.
    const double largest = 0.25 * std::sqrt(area_ / (kPi * holes));
    for (int i = 0; i < holes; ++i) {
      double radius = std::min(random.uniform(3, 6) * edge_, largest);
      std::optional<std::uint32_t> center;
      for (int attempt = 0; attempt < 4 && !center; ++attempt, radius *= 0.6) {
        center = free_place(radius, seed_facets, random);
        if (center) holes_.push_back({*center, radius});
      }
      if (!center) break;
      remove_disk(holes_.back());
    }
    while (widen_pinches()) {
    }
    std::size_t f = 0;
    std::erase_if(soup_.facets, [&](const Facet&) { return removed_[f++] != 0; });
  }

 private:
  // Of some random points the one farthest from all holes, if that is far enough (Mitchell's best candidate).
  std::optional<std::uint32_t> free_place(double radius, std::size_t seed_facets, Random& random) const {
    constexpr int kCandidates = 40;
    double best_gap = 1.5 * edge_;
    std::optional<std::uint32_t> best;
    for (int i = 0; i < kCandidates; ++i) {
      const std::uint32_t p = soup_.facets[random.below(seed_facets)][random.below(3)];
      double gap = std::numeric_limits<double>::max();
      for (const Hole& hole : holes_)
        gap = std::min(gap, norm(soup_.points[p] - soup_.points[hole.center]) - hole.radius - radius);
      if (gap > best_gap) {
        best_gap = gap;
        best = p;
      }
    }
    return best;
  }

  // Removes the facets around all points of the disk. It grows along the surface, so that a hole in a
  // thin wall does not go through to its other side.
  void remove_disk(const Hole& hole) {
    std::vector<std::uint32_t> disk{hole.center};
    std::vector<char> reached(soup_.points.size());
    reached[hole.center] = 1;
    for (std::size_t i = 0; i < disk.size(); ++i)
      for (const std::size_t f : stars_[disk[i]]) {
        removed_[f] = 1;
        for (const std::uint32_t p : soup_.facets[f])
          if (reached[p] == 0 && norm(soup_.points[p] - soup_.points[hole.center]) < hole.radius) {
            reached[p] = 1;
            disk.push_back(p);
          }
      }
  }

  // Where a hole's rim touches itself in a point, or two rims do, that point's other facets go too.
  bool widen_pinches() {
    bool any = false;
    for (std::size_t p = 0; p < soup_.points.size(); ++p) {
      if (open_edges_from(p) < 2) continue;
      for (const std::size_t f : stars_[p]) removed_[f] = 1;
      any = true;
    }
    return any;
  }

  // The number of edges that run from p along one remaining facet and come back along none.
  std::ptrdiff_t open_edges_from(std::size_t p) const {
    std::vector<std::uint32_t> out, back;
    for (const std::size_t f : stars_[p]) {
      if (removed_[f] != 0) continue;
      const Facet& facet = soup_.facets[f];
      const std::size_t i = facet[0] == p ? 0 : facet[1] == p ? 1 : 2;
      out.push_back(facet[(i + 1) % 3]);
      back.push_back(facet[(i + 2) % 3]);
    }
    return std::count_if(out.begin(), out.end(), [&](std::uint32_t q) {
      return std::find(back.begin(), back.end(), q) == back.end();
    });
  }

  TriangleSoup& soup_;
  Stars stars_;
  std::vector<char> removed_;
  double edge_;
  double area_;
  std::vector<Hole> holes_;
};

}  // namespace

void add_noise(TriangleSoup& soup, double edges, Random random) {
  const std::vector<Vec3> normals = point_normals(soup);
  const double deviation = edges * mean_edge_length(soup);
  for (std::size_t p = 0; p < soup.points.size(); ++p)
    soup.points[p] += deviation * random.gaussian() * normals[p];
}

void cut_holes(TriangleSoup& soup, int holes, std::size_t seed_facets, Random random) {
  HoleCutter(soup).cut(holes, seed_facets, random);
}

}  // namespace burnish::example
