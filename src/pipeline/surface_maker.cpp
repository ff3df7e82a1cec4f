#include "surface_maker.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

#include "burnish/surface/creases.h"
#include "burnish/surface/inspect.h"
#include "level_set_gear.h"

namespace burnish {
namespace {

constexpr std::size_t kMostDelaunayFacets = 50'000;
constexpr double kResolvedAngle = 5, kResolvedReach = 1;  // degrees, cells
constexpr double kDistancePerEdge = 0.1;                  // of Delaunay facets, where no tolerance is given
constexpr double kLeastDistance = 0.02;                   // cells
constexpr double kReachPerEdge = 1.5;
constexpr int kSettlingRounds = 3;
constexpr int kSharpenedRounds = 1;                       // of mending; then the surface stays as it was extracted
constexpr double kFar = 0.2;                              // cells: vertices that sharpening moves farther may have met others
constexpr double kShortestNoisyCrease = 8;                // mean edges

std::vector<std::vector<Vec3>> polylines(const TriangleSoup& surface, const Creases& creases) {
  std::vector<std::vector<Vec3>> lines;
  for (const auto& chain : creases.chains) {
    lines.emplace_back();
    for (const std::uint32_t p : chain) lines.back().push_back(surface.points[p]);
  }
  return lines;
}

}  // namespace

std::shared_ptr<const SharpReference> make_reference(TriangleSoup surface, std::optional<double> crease_angle, double sigma) {
  CreaseOptions options{.angle = crease_angle.value_or(kCreaseAngle), .sigma = sigma};
  if (sigma > 0) options.least_length = kShortestNoisyCrease * mean_edge_length(surface);
  std::vector<std::vector<Vec3>> sharp = polylines(surface, find_creases(surface, options));
  if (sigma == 0 && !crease_angle) {
    options.resolved_angle = kResolvedAngle;
    options.resolved = kResolvedReach;
  }
  Creases creases = find_creases(surface, options);
  return std::make_shared<const SharpReference>(SharpReference{ReferenceSurface(std::move(surface), std::move(creases)), std::move(sharp)});
}

SurfaceMaker::SurfaceMaker(const LevelSet& level_set, const PreparedInput& prepared, std::shared_ptr<const SharpReference> reference, RepairReport& report,
                           Progress& progress)
    : set_(level_set), prepared_(prepared), reference_(std::move(reference)), report_(report), progress_(progress) {
  choose_extractor();
}

// [T-SURFACE-1]
void SurfaceMaker::choose_extractor() {
  SurfaceSummary& told = report_.surface;
  const ResolvedOptions& options = report_.options;
  const auto choose = [&](Extractor extractor, std::string why) {
    extractor_ = told.extractor = extractor;
    told.reason = std::move(why);
  };
  if (options.surface != Extractor::automatic) return choose(options.surface, "asked for");
  if (options.max_hole) return choose(Extractor::tetrahedra, "openings are to stay");
  if (options.edge || options.edge_tolerance || options.min_angle) return choose(Extractor::delaunay, "its sizes were asked for");
  told.predicted_facets = predicted_facets(set_, delaunay_options());
  if (told.predicted_facets <= kMostDelaunayFacets)
    return choose(Extractor::delaunay, fmt::format("about {} facets are expected, of {} at most", told.predicted_facets, kMostDelaunayFacets));
  choose(Extractor::tetrahedra, fmt::format("{} facets are expected of Delaunay, which is for {} at most", told.predicted_facets, kMostDelaunayFacets));
}

DelaunayOptions SurfaceMaker::delaunay_options() const {
  const ResolvedOptions& asked = report_.options;
  const double cell = set_.frame.cell;
  DelaunayOptions options;
  if (asked.edge) options.edge = *asked.edge / cell;
  options.distance = asked.edge_tolerance ? std::max(kLeastDistance, *asked.edge_tolerance / cell) : kDistancePerEdge * std::max(1.0, options.edge);
  if (asked.edge_tolerance) options.edge_tolerance = *asked.edge_tolerance / cell;
  if (asked.min_angle) options.min_angle = *asked.min_angle;
  return options;
}

// Creases are looked for along edges that are near to one.
SharpenOptions SurfaceMaker::sharpen_options() const {
  double longest = 0;
  for (const Facet& f : raw_.soup.facets)
    for (std::size_t i = 0; i < 3; ++i) longest = std::max(longest, squared_norm(raw_.soup.points[f[(i + 1) % 3]] - raw_.soup.points[f[i]]));
  SharpenOptions options;
  options.crease_reach = std::max(options.crease_reach, kReachPerEdge * std::sqrt(longest));
  return options;
}

const TriangleSoup& SurfaceMaker::make() {
  if (raw_.soup.facets.empty()) extract();
  if (reference_) {
    settle();
  } else {
    sharpened_ = {std::move(raw_.soup), {}, {}, 0, 0, 0};
  }
  return sharpened_.soup;
}

void SurfaceMaker::extract() {
  if (extractor_ != Extractor::delaunay || !extract_by_delaunay()) extract_by_tetrahedra();
  const SurfaceTopology before = surface_topology(raw_.soup);
  report_.actions.debris_dropped = leave_out_debris(raw_.soup, prepared_, set_.frame);
  want_topology(before);
}

// The level set's, less that of the pieces that were left out.
void SurfaceMaker::want_topology(const SurfaceTopology& before_sifting) {
  if (!field_) field_ = level_set_topology(set_, progress_);
  wanted_ = {field_->surface_components, field_->genus};
  if (report_.actions.debris_dropped == 0) return;
  const SurfaceTopology after = surface_topology(raw_.soup);
  wanted_.components -= before_sifting.components.size() - after.components.size();
  wanted_.genus -= before_sifting.genus.value_or(0) - after.genus.value_or(0);
}

bool SurfaceMaker::extract_by_delaunay() {
  DelaunayOptions options = delaunay_options();
  if (reference_) options.creases = reference_->sharp;
  DelaunaySurface surface = extract_delaunay(set_, options, progress_);
  if (!surface.failure.empty()) {
    use_tetrahedra(surface.failure);
    return false;
  }
  raw_ = {std::move(surface.soup), {}, 0};
  return true;
}

void SurfaceMaker::extract_by_tetrahedra() { raw_ = extract_surface(set_, {.snap = true, .plain = plain_.marked.empty() ? nullptr : &plain_}, progress_); }

void SurfaceMaker::use_tetrahedra(const std::string& why) {
  extractor_ = report_.surface.extractor = Extractor::tetrahedra;
  report_.surface.reason = "instead of delaunay: " + why;
  report_.warnings.push_back("the Delaunay surface could not be made, and the octree's is the result: " + why);
  staying_.clear();
}

std::uint64_t SurfaceMaker::key(std::uint32_t vertex) const {
  if (raw_.origins.empty()) return vertex;
  const VertexOrigin& o = raw_.origins[vertex];
  return std::uint64_t{o.leaf} * kBlockNodes + o.node;
}

void SurfaceMaker::settle() {
  for (int round = 0; round < kSettlingRounds; ++round) {
    sharpen_once();
    const std::vector<std::uint32_t> doubtful = facets_in_doubt();
    TriangleSoup part{sharpened_.soup.points, {}, {}};
    for (const std::uint32_t f : doubtful) part.facets.push_back(sharpened_.soup.facets[f]);
    std::vector<std::uint32_t> broken;
    for (const auto& pair : self_intersecting_pairs(part, progress_))
      for (const std::uint32_t i : pair) broken.push_back(doubtful[i]);
    if (broken.empty() || !leave_unsharpened(raw_vertices_of(broken))) return;
  }
}

std::vector<std::uint32_t> SurfaceMaker::facets_in_doubt() const {
  const auto doubtful = [&](std::uint32_t p) {
    const auto& [a, b] = sharpened_.parents[p];
    return sharpened_.kind[p] != SharpenedKind::smooth || a != b || squared_norm(sharpened_.soup.points[p] - raw_.soup.points[a]) > kFar * kFar;
  };
  std::vector<std::uint32_t> facets;
  for (std::uint32_t f = 0; f < sharpened_.soup.facets.size(); ++f)
    if (std::any_of(sharpened_.soup.facets[f].begin(), sharpened_.soup.facets[f].end(), doubtful)) facets.push_back(f);
  return facets;
}

std::vector<std::uint32_t> SurfaceMaker::raw_vertices_of(const std::vector<std::uint32_t>& facets) const {
  std::vector<std::uint32_t> vertices;
  for (const std::uint32_t f : facets)
    for (const std::uint32_t p : sharpened_.soup.facets[f]) {
      if (sharpened_.parents.empty()) {
        vertices.push_back(p);
      } else {
        vertices.insert(vertices.end(), sharpened_.parents[p].begin(), sharpened_.parents[p].end());
      }
    }
  return vertices;
}

void SurfaceMaker::sharpen_once() {
  std::vector<std::uint8_t> stays(raw_.soup.points.size(), 0);
  for (std::uint32_t v = 0; v < stays.size() && !staying_.empty(); ++v) stays[v] = staying_.contains(key(v));
  sharpened_ = sharpen(raw_.soup, reference_->surface, stays, sharpen_options(), progress_);
  SurfaceSummary& told = report_.surface;
  told.sharpened = true;
  told.points_moved = sharpened_.moved;
  told.edges_cut = sharpened_.cut;
  told.points_kept = sharpened_.kept;
}

bool SurfaceMaker::mend(const std::vector<std::uint32_t>& facets) {
  const std::vector<std::uint32_t> vertices = raw_vertices_of(facets);
  // No facet is to blame for a shell that lies where none should.
  if (reference_ && (vertices.empty() || ++mended_ > kSharpenedRounds)) {
    report_.warnings.push_back("creases were not cut into the result: it would have met itself there");
    report_.surface.sharpened = false;
    reference_ = nullptr;
    return true;
  }
  if (vertices.empty()) return false;
  if (reference_ && leave_unsharpened(vertices)) return true;
  if (extractor_ == Extractor::delaunay) {
    use_tetrahedra("rounding to the file's precision breaks it");
    raw_ = {};
    return true;
  }
  return leave_unsnapped(vertices);
}

// The vertices and their neighbours stay where the extraction put them. False if they all did already.
bool SurfaceMaker::leave_unsharpened(const std::vector<std::uint32_t>& vertices) {
  std::vector<char> marked(raw_.soup.points.size(), 0);
  for (const std::uint32_t v : vertices) marked[v] = 1;
  const std::size_t before = staying_.size();
  for (const Facet& f : raw_.soup.facets)
    if (marked[f[0]] || marked[f[1]] || marked[f[2]])
      for (const std::uint32_t v : f) staying_.insert(key(v));
  return staying_.size() > before;
}

bool SurfaceMaker::leave_unsnapped(const std::vector<std::uint32_t>& vertices) {
  if (raw_.origins.empty()) return false;
  std::vector<VertexOrigin> origins;
  for (const std::uint32_t v : vertices) origins.push_back(raw_.origins[v]);
  mark_plain(set_.octree(), origins, plain_);
  raw_ = {};
  return true;
}

}  // namespace burnish
