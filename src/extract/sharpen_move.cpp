// Taking back what turns facets over.
#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>

#include "sharpen_mesh.h"

namespace burnish::detail {
namespace {

constexpr double kTurnedOver = 0.2;    // cosine between a facet and what it should face
constexpr double kLeastSine = 1e-3;    // flatter facets have no area
constexpr std::array<double, 4> kFractions{1, 0.5, 0.25, 0};

class Mover {
 public:
  Mover(const SharpenMesh& mesh, std::vector<Vec3>& points, const ReferenceSurface& s)
      : mesh_(mesh), s_(s), points_(points), back_(mesh.start.size(), 0), facing_(mesh.facets.size()) {}

  bool run(Progress& progress) {
    parallel_for(facing_.size(), [&](std::size_t f) { facing_[f] = facing(mesh_.facets[f]); }, 256);
    std::vector<std::uint32_t> suspects(mesh_.facets.size());
    std::iota(suspects.begin(), suspects.end(), 0u);
    std::vector<std::uint32_t> vertices = taken_back(suspects);
    if (vertices.empty()) return true;
    const FacetsAround around(mesh_.facets, mesh_.start.size());
    while (!vertices.empty()) {
      progress.check();
      vertices = taken_back(facets_at(vertices, around));
    }
    return false;
  }

 private:
  Vec3 facing(const Facet& f) const {
    const Vec3 smooth = facing_of(mesh_, s_, f);
    if (squared_norm(smooth) > 0) return smooth;
    const Vec3 n = cross(mesh_.start[f[1]] - mesh_.start[f[0]], mesh_.start[f[2]] - mesh_.start[f[0]]);
    const double length = norm(n);
    const Vec3 before = length > 0 ? n / length : Vec3{};
    if (mesh_.has_fixed_corner(f)) return before;
    const ReferenceSurface::Foot foot = s_.closest((mesh_.target[f[0]] + mesh_.target[f[1]] + mesh_.target[f[2]]) / 3, 2, before);
    return foot.found() ? s_.normal(foot.facet) : before;
  }

  // [T-SHARP-8]
  bool is_broken(std::uint32_t f) const {
    const auto [a, b, c] = mesh_.facets[f];
    if (a == b) return false;
    if (back_[a] + back_[b] + back_[c] == 9) return false;
    const Vec3 n = cross(points_[b] - points_[a], points_[c] - points_[a]);
    return !(dot(n, facing_[f]) > kTurnedOver * norm(n)) || least_sine(points_[a], points_[b], points_[c]) < kLeastSine;
  }

  // Takes the vertices of broken facets one step back; returns them.
  std::vector<std::uint32_t> taken_back(const std::vector<std::uint32_t>& suspects) {
    std::vector<char> broken(suspects.size());
    parallel_for(suspects.size(), [&](std::size_t i) { broken[i] = is_broken(suspects[i]); });
    std::vector<std::uint32_t> vertices;
    for (std::size_t i = 0; i < suspects.size(); ++i)
      if (broken[i]) vertices.insert(vertices.end(), mesh_.facets[suspects[i]].begin(), mesh_.facets[suspects[i]].end());
    std::sort(vertices.begin(), vertices.end());
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    std::erase_if(vertices, [&](std::uint32_t v) { return back_[v] == 3; });
    for (const std::uint32_t v : vertices) {
      ++back_[v];
      points_[v] = back_[v] == 3 ? mesh_.start[v] : mesh_.start[v] + (mesh_.target[v] - mesh_.start[v]) * kFractions[back_[v]];
    }
    return vertices;
  }

  static std::vector<std::uint32_t> facets_at(const std::vector<std::uint32_t>& vertices, const FacetsAround& around) {
    std::vector<std::uint32_t> found;
    for (const std::uint32_t v : vertices) found.insert(found.end(), around[v].begin(), around[v].end());
    std::sort(found.begin(), found.end());
    found.erase(std::unique(found.begin(), found.end()), found.end());
    return found;
  }

  const SharpenMesh& mesh_;
  const ReferenceSurface& s_;
  std::vector<Vec3>& points_;
  std::vector<std::uint8_t> back_;   // steps: index of kFractions
  std::vector<Vec3> facing_;         // per facet
};

}  // namespace

bool take_back(const SharpenMesh& mesh, std::vector<Vec3>& points, const ReferenceSurface& s, Progress& progress) {
  return Mover(mesh, points, s).run(progress);
}

}  // namespace burnish::detail
