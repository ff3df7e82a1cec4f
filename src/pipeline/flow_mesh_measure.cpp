#include "flow_mesh_measure.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "burnish/surface/triangle_index.h"
#include "losses.h"

namespace burnish {
namespace {

constexpr double kLossCells = 1.5;              // the surface farther than this from all patches is lost
constexpr std::size_t kMostPlaces = 1000;       // listed of a check
constexpr std::size_t kPlacesOfMessage = 3;
constexpr double kVolumeOff = 0.02;             // of what is wanted, without a word
constexpr double kWellCovered = 0.5;           // of the wall by layers, without a word

double volume_of(const Box3& box) {
  const Vec3 e = box.extent();
  return e.x * e.y * e.z;
}

double face_area(const PolyhedralMesh& mesh, std::size_t f) {
  const auto points = mesh.face(f);
  Vec3 twice;
  for (std::size_t i = 2; i < points.size(); ++i)
    twice += cross(mesh.points[points[i - 1]] - mesh.points[points[0]], mesh.points[points[i]] - mesh.points[points[0]]);
  return 0.5 * norm(twice);
}

MeshedPatch told_patch(const PolyhedralMesh& mesh, std::size_t number, const SurfacePatches& patches) {
  const MeshPatch& patch = mesh.patches[number];
  MeshedPatch told{patch.name, patch.type, number < patches.groups.size() ? patches.groups[number] : "", patch.faces, 0};
  for (std::size_t f = patch.first_face; f < std::size_t{patch.first_face} + patch.faces; ++f) told.area += face_area(mesh, f);
  return told;
}

void tell_sizes(const PolyhedralMesh& mesh, FlowMeshResult& result) {
  const CellGeometry geometry = cell_geometry(mesh, cell_faces(mesh));
  result.smallest_cell = std::numeric_limits<double>::infinity();
  for (const double v : geometry.volume) {
    result.smallest_cell = std::min(result.smallest_cell, v);
    result.largest_cell = std::max(result.largest_cell, v);
  }
  for (const Vec3& p : mesh.points) result.box.extend(p);
}

Vec3 middle_of(const VolumeMesh& mesh, std::size_t cell) {
  Vec3 sum;
  for (const std::uint32_t p : mesh.cell(cell)) sum += mesh.mesh.points[p];
  return sum / static_cast<double>(mesh.cell(cell).size());
}

// A cell is listed under the first check that it fails: those that never fail a mesh are not to be in the way.
MeshQualityLimits failing_limits() {
  MeshQualityLimits limits;
  limits.non_orthogonality = 90, limits.flatness = 0, limits.concave_degrees = 180;
  return limits;
}

// Of the checks that fail, by check, then by cell.
std::vector<BadPlace> places_of(const VolumeMesh& mesh, const MeshQuality& quality, const std::vector<BadCell>& bad) {
  std::vector<BadPlace> places;
  for (const MeshCheck& check : quality.checks) {
    std::size_t listed = 0;
    for (const BadCell& b : bad)
      if (!check.passed && b.check == check.name && listed++ < kMostPlaces) places.push_back({std::string(b.check), b.cell, b.value, middle_of(mesh, b.cell)});
  }
  return places;
}

std::string text_of(const Vec3& p) { return fmt::format("({:.6g}, {:.6g}, {:.6g})", p.x, p.y, p.z); }

// "skewness: 3, the worst 21.3; at (0, 0, 1), ..."
std::string text_of(const MeshCheck& check, const std::vector<BadPlace>& places) {
  std::string at;
  std::size_t listed = 0;
  for (const BadPlace& p : places)
    if (p.check == check.name && listed++ < kPlacesOfMessage) at += (listed == 1 ? "; at " : ", ") + text_of(p.at);
  return fmt::format("{}: {}, the worst {:.4g}{}{}", check.name, check.failing, check.worst, at, listed > kPlacesOfMessage ? ", ..." : "");
}

// What is measured in lengths, areas or volumes: their power of a length.
int dimension_of(std::string_view check) {
  if (check == "edge length") return 1;
  if (check == "face area") return 2;
  return check == "cell volume" || check == "face pyramids" ? 3 : 0;
}

// From those of a mesh that is `scale` times as large.
void to_model_units(double scale, MeshQuality& quality, std::vector<BadPlace>& places) {
  const auto back = [&](double value, int dimension) {
    for (; dimension > 0; --dimension) value /= scale;
    return value;
  };
  quality.volume = back(quality.volume, 3);
  for (double& v : quality.volume_of_shape) v = back(v, 3);
  for (MeshCheck& c : quality.checks)
    for (double* value : {&c.limit, &c.worst, &c.best, &c.mean}) *value = back(*value, dimension_of(c.name));
  for (BadPlace& p : places) p.value = back(p.value, dimension_of(p.check)), p.at = p.at / scale;
}

bool counts(const MeshCheck& check, MeshFlavour flavour) { return !check.passed && (flavour == MeshFlavour::conforming || !check.all_geometry); }

}  // namespace

void tell_mesh(const FlowMesh& flow, const SurfacePatches& patches, const Box3& domain, FlowMeshResult& result) {
  const PolyhedralMesh& mesh = flow.mesh.mesh;
  result.meshed = true;
  result.finest_cell = 2 * flow.frame.cell;
  result.cells_of_level = flow.cells_of_level;
  result.moved_back = flow.moved_back;
  const LayerCoverage& layers = flow.layers;
  result.layers.covered = layers.wall_area > 0 ? layers.covered_area / layers.wall_area : 0;
  result.layers.least_first = layers.least_first, result.layers.greatest_first = layers.greatest_first;
  if (result.layers.count > 0 && result.layers.covered < kWellCovered)
    result.warnings.push_back(fmt::format("only {:.2g} % of the wall's area has all layers: where the model has sharp edges they often have no room; a smaller --cell or thinner layers may keep more",
                                          100 * result.layers.covered));
  result.warnings.insert(result.warnings.end(), flow.notes.begin(), flow.notes.end());
  tell_sizes(mesh, result);
  for (std::size_t i = 0; i < mesh.patches.size(); ++i) result.patches.push_back(told_patch(mesh, i, patches));
  const bool outside = result.side == MeshSide::outside;
  const MeshedSolid& solid = result.solid;
  result.volume_wanted = outside ? volume_of(domain) - solid.volume : solid.volume;
  result.regions_wanted = outside ? 1 + solid.cavities : solid.components - solid.cavities;
}

void judge_quality(const VolumeMesh& mesh, double scale, FlowMeshResult& result, Progress& progress) {
  result.quality = mesh_quality(mesh, {}, progress);
  const MeshQuality& q = result.quality;
  result.good = result.flavour == MeshFlavour::conforming ? q.ok : q.plain_ok;
  if (q.failed > 0) result.bad_places = places_of(mesh, q, bad_cells(mesh, failing_limits(), progress));
  if (scale != 1) to_model_units(scale, result.quality, result.bad_places);
  if (q.regions != result.regions_wanted)
    result.warnings.push_back(fmt::format("the mesh has {} connected regions, and {} would be right: {}; a smaller --cell resolves more", q.regions, result.regions_wanted,
                                          q.regions < result.regions_wanted ? "a part is thinner than a cell, or two parts are closer" : "a part is pinched where it is thinner than a cell"));
  const double off = q.volume / result.volume_wanted - 1;
  if (std::abs(off) > kVolumeOff) result.warnings.push_back(fmt::format("the mesh's volume is {:+.2g} % off what is to be meshed: the cell is large for this model", 100 * off));
}

void compare_patches(const VolumeMesh& mesh, const SurfacePatches& patches, const TriangleSoup& surface, FlowMeshResult& result) {
  const TriangleSoup meshed = wall_triangles(mesh.mesh, patches.names.size());
  if (meshed.facets.empty()) return;
  std::vector<FarSample> far;
  result.surface_to_patches = one_sided_distance(surface, TriangleIndex(meshed), {.far_beyond = kLossCells * result.cell}, &far);
  result.patches_to_surface = one_sided_distance(meshed, TriangleIndex(surface));
  result.losses = gather_losses(far, result.solid.box.diagonal(), [](const FarSample&) { return std::string("thinner than a cell"); });
  double lost = 0;
  for (const Loss& loss : result.losses) lost += loss.area;
  if (!(lost > 0)) return;
  const Loss& worst = result.losses.front();
  result.warnings.push_back(fmt::format("parts of the surface with {:.3g} of area ({:.2g} %) are not in the mesh, being thinner than a cell; the largest is at {}, {:.3g} cells off: a smaller --cell "
                                        "keeps more",
                                        lost, 100 * lost / result.solid.area, text_of(worst.position), worst.distance / result.cell));
}

Error reason_of_failure(const FlowMeshResult& result) {
  std::string failing;
  for (const MeshCheck& check : result.quality.checks)
    if (counts(check, result.flavour)) failing += (failing.empty() ? "" : "; ") + text_of(check, result.bad_places);
  const bool conforming = result.flavour == MeshFlavour::conforming;
  // So small, or so large, that no double holds it.
  const bool vanishes = !std::isnormal(result.quality.volume);
  return {ErrorCode::guarantee_unmet, fmt::format("the mesh does not pass {} ({})", conforming ? "checkMesh -allTopology -allGeometry" : "checkMesh", failing),
          vanishes ? "choose a --scale nearer to 1: volumes like these are no numbers"
                   : fmt::format("try a somewhat different --cell, such as {:.4g}; --allow-invalid writes the mesh as it is, and --report lists all places", 0.93 * result.cell)};
}

}  // namespace burnish
