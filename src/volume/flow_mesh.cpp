#include "burnish/volume/flow_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <utility>

#include "assemble.h"
#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/text.h"
#include "burnish/extract/reference_surface.h"
#include "burnish/levelset/from_triangles.h"
#include "cell_lattice.h"
#include "fit_boundary.h"
#include "stuffing.h"
#include "wall_layers.h"

namespace burnish {
namespace {

constexpr double kBand = 5;          // lattice units: the half diagonal of a cell, and what may move
constexpr double kDomainMargin = 4;  // between the band and the walls
constexpr double kInsideRoom = 2;    // cells around the surface that are there, if its inside is meshed
constexpr int kMostRefined = 5;      // levels below the cells at the surface
constexpr double kBytesPerCell = 800, kBytesAtSurface = 9000;  // measured; the latter per square of a cell's side, where all of the surface has the finest cells
constexpr double kLeastRoom = 4;     // cells between the surface and a side of the domain
constexpr double kCellsOfRoom = 4;   // of the coarsest cells that have room there
constexpr double kCreaseSnap = 0.7;  // half sides of the smallest cell at a node: nodes nearer than this go to the crease
constexpr double kCornerSnap = 1.12;  // and the nearest one to a corner: sqrt(5)/2, no point is farther from all nodes of cells of one size
constexpr double kSmallestPart = 8;  // cells: what is smaller and hangs by no face is left out

Vec3 place_of(const LatticePlace& n) { return {static_cast<double>(n[0]), static_cast<double>(n[1]), static_cast<double>(n[2])}; }

// The corner (all coordinates even multiples of 2^level) or the centre (all odd ones) of a cell of that level that is nearest to a point.
LatticePlace nearest_node(const Vec3& p, int level) {
  const std::int64_t half = std::int64_t{1} << level;
  const auto nearest = [&](std::int64_t odd) {
    LatticePlace n{};
    for (int a = 0; a < 3; ++a) n[static_cast<std::size_t>(a)] = half * (2 * std::llround((p[a] / static_cast<double>(half) - static_cast<double>(odd)) / 2) + odd);
    return n;
  };
  const LatticePlace corner = nearest(0), centre = nearest(1);
  return squared_norm(place_of(corner) - p) <= squared_norm(place_of(centre) - p) ? corner : centre;
}

class FlowMesher {
 public:
  FlowMesher(const TriangleSoup& surface, const std::vector<std::uint32_t>& patch_of_facet, const std::vector<std::string>& patch_names, const FlowMeshOptions& options, Progress& progress)
      : surface_(surface), patch_of_facet_(patch_of_facet), patch_names_(patch_names), options_(options), progress_(progress) {}

  FlowMesh run() {
    choose_frame();
    require_memory(kBytesAtSurface * area(surface_) / (4 * result_.frame.cell * result_.frame.cell));
    progress_.begin_stage("distances and signs");
    const LevelSet set = level_set_from_triangles(surface_, result_.frame, {.band = band(), .far_field = false}, progress_).level_set;
    progress_.begin_stage("cells");
    const CellLattice lattice(set, options_, surface_level_, region_, progress_);
    count_levels(lattice);
    require_memory(kBytesPerCell * static_cast<double>(lattice.cells()));
    refer();
    stuffed_ = stuff(lattice, set, options_.side == MeshSide::inside ? 1 : -1, options_.flavour, crease_target(), progress_);
    result_.mesh = assemble(stuffed_.points, stuffed_.cells, &source_);
    leave_out_crumbs();
    progress_.begin_stage("boundary");
    fit();
    if (options_.layers.count > 0) grow_layers();
    name_patches();
    to_model();
    return std::move(result_);
  }

 private:
  // The diagonal of the largest cells at the surface, and what may move.
  double band() const { return std::max(kBand, std::sqrt(3.0) * (2 << (surface_level_ + options_.flat_levels)) + 1); }
  // Finest cells along a cell at the surface.
  double surface_cell() const { return static_cast<double>(1 << surface_level_); }
  bool outside() const { return options_.side == MeshSide::outside; }

  // Mesh cells are two lattice units wide. The domain's sides are rounded to the coarsest cells, which therefore are small beside the room between surface and sides; to_model() puts
  // them where they belong.
  void choose_frame() {
    const Box3 body = bounding_box(surface_);
    Box3 box = body;
    if (outside()) {
      limit_coarsest(body);
      box.extend(options_.domain);
    }
    for (const MeshRefinement& r : options_.refinements) surface_level_ = std::max(surface_level_, static_cast<int>(std::ceil(std::log2(options_.cell / r.cell) - 1e-9)));
    if (surface_level_ > kMostRefined) throw Error(ErrorCode::usage, fmt::format("a refinement asks for cells of less than 1/{} of those at the surface", 1 << kMostRefined), "choose a smaller --cell");
    const int coarsest = surface_level_ + options_.coarsest_level;
    const double coarse = static_cast<double>(2 << coarsest);
    result_.frame = make_frame(box, options_.cell / (2 * surface_cell()), outside() ? coarse + band() + kDomainMargin : band() + kDomainMargin);
    body_ = {result_.frame.to_lattice(body.lower) - Vec3{4, 4, 4} * surface_cell(), result_.frame.to_lattice(body.upper) + Vec3{4, 4, 4} * surface_cell()};
    const std::int64_t step = std::int64_t{1} << coarsest;
    const Box3& wanted = outside() ? options_.domain : box;
    const Vec3 lower = result_.frame.to_lattice(wanted.lower) / 2, upper = result_.frame.to_lattice(wanted.upper) / 2;
    for (int a = 0; a < 3; ++a) {
      auto& from = region_.lower[static_cast<std::size_t>(a)];
      auto& to = region_.upper[static_cast<std::size_t>(a)];
      const auto rounded = [&](double x, double (*round)(double)) { return step * static_cast<std::int64_t>(round(x / static_cast<double>(step))); };
      from = outside() ? rounded(lower[a], std::round) : std::max<std::int64_t>(0, rounded(lower[a] - kInsideRoom * surface_cell(), std::floor));
      to = outside() ? rounded(upper[a], std::round) : rounded(upper[a] + kInsideRoom * surface_cell(), std::ceil);
    }
  }

  void limit_coarsest(const Box3& body) {
    double room = std::numeric_limits<double>::infinity();
    for (int a = 0; a < 3; ++a) room = std::min({room, body.lower[a] - options_.domain.lower[a], options_.domain.upper[a] - body.upper[a]});
    room /= options_.cell;
    if (!(room >= kLeastRoom))
      throw Error(ErrorCode::usage, fmt::format("the domain, {}, cuts the model, {}, or is within {} cells of it", text_of(options_.domain), text_of(body), kLeastRoom),
                  "choose a --domain that is larger on all sides, or a smaller --cell");
    options_.coarsest_level = std::clamp(static_cast<int>(std::floor(std::log2(room / kCellsOfRoom))), 0, options_.coarsest_level);
  }

  void require_memory(double bytes) const {
    if (bytes <= static_cast<double>(options_.memory_bytes)) return;
    throw Error(ErrorCode::memory_limit, fmt::format("a mesh with cells of {:.4g} takes about {:.1f} GB; the budget is {:.1f} GB", options_.cell, bytes * 0x1p-30, static_cast<double>(options_.memory_bytes) * 0x1p-30),
                "choose a larger --cell, or raise --memory");
  }

  void count_levels(const CellLattice& lattice) {
    for (std::size_t c = 0; c < lattice.cells(); ++c) {
      if (!lattice.exists(c)) continue;
      const auto level = static_cast<std::size_t>(lattice.tree().level(c));
      if (result_.cells_of_level.size() <= level) result_.cells_of_level.resize(level + 1, 0);
      ++result_.cells_of_level[level];
    }
  }

  // Parts that hang by an edge or a point alone, and hold next to nothing.
  void leave_out_crumbs() {
    std::vector<std::uint32_t> part;
    const std::uint32_t parts = connected_parts(result_.mesh.mesh, part);
    if (result_.mesh.cells() == 0) throw Error(ErrorCode::guarantee_unmet, "no cell of the mesh lies on this side of the surface", "choose a smaller --cell");
    if (parts == 1) return;
    const CellGeometry geometry = cell_geometry(result_.mesh.mesh, cell_faces(result_.mesh.mesh));
    std::vector<double> volume(parts, 0);
    for (std::size_t c = 0; c < part.size(); ++c) volume[part[c]] += geometry.volume[c];
    std::vector<std::uint8_t> keep(part.size());
    std::size_t crumbs = 0;
    const double smallest = kSmallestPart * 8 * surface_cell() * surface_cell() * surface_cell();
    double lost = 0;
    for (const double v : volume)
      if (v < smallest) ++crumbs, lost += v;
    if (crumbs == 0) return;
    if (crumbs == parts) throw Error(ErrorCode::guarantee_unmet, "the solid is thinner than a cell everywhere", "choose a smaller --cell");
    for (std::size_t c = 0; c < part.size(); ++c) keep[c] = volume[part[c]] >= smallest;
    stuffed_.cells = kept_cells(stuffed_.cells, keep);
    result_.mesh = assemble(stuffed_.points, stuffed_.cells, &source_);
    const double cube = result_.frame.cell * result_.frame.cell * result_.frame.cell;
    result_.notes.push_back(fmt::format("{} parts of less than {} cells, {:.3g} in all, hang together with the rest by no face and are left out", crumbs, kSmallestPart, lost * cube));
  }

  void refer() {
    TriangleSoup lattice_surface = to_lattice(surface_, result_.frame);
    Creases creases = find_creases(lattice_surface, {.angle = options_.crease_angle});
    reference_ = std::make_unique<ReferenceSurface>(std::move(lattice_surface), std::move(creases));
  }

  // [T-HEX-9] The node nearest to a corner of the creases goes there, if it is near enough; of the others those near a crease.
  CreaseTarget crease_target() const {
    if (!reference_->has_creases()) return {};
    // Of each level of nodes on its own: what is near to a corner for large cells may be far for small ones.
    std::vector<std::map<LatticePlace, Vec3>> corners(static_cast<std::size_t>(surface_level_ + options_.flat_levels) + 1);
    for (std::size_t level = 0; level < corners.size(); ++level)
      for (const std::uint32_t c : reference_->creases().corners) {
        const Vec3& at = reference_->soup().points[c];
        const LatticePlace node = nearest_node(at, static_cast<int>(level));
        if (norm(place_of(node) - at) < kCornerSnap * (1 << level)) corners[level].emplace(node, at);
      }
    return [this, corners = std::move(corners)](const LatticePlace& node, int level) -> std::optional<PlaceOnCrease> {
      if (const auto& near = corners[std::min(static_cast<std::size_t>(level), corners.size() - 1)]; near.contains(node)) return PlaceOnCrease{near.at(node), true};
      const ReferenceSurface::Foot foot = reference_->closest_on_creases(place_of(node), kCreaseSnap * (1 << level));
      if (!foot.found()) return std::nullopt;
      return PlaceOnCrease{foot.point};
    };
  }

  void mark_wall() {
    const PolyhedralMesh& mesh = result_.mesh.mesh;
    const std::size_t internal = mesh.internal_faces();
    on_wall_.assign(mesh.faces() - internal, 0);
    for (std::size_t f = internal; f < mesh.faces(); ++f) {
      const auto face = mesh.face(f);
      if (!std::all_of(face.begin(), face.end(), [&](std::uint32_t p) { return stuffed_.on_surface[source_[p]] != 0; })) continue;
      on_wall_[f - internal] = 1;
    }
  }

  void fit() {
    mark_wall();
    const BoundaryFit told = fit_boundary(result_.mesh, on_wall_, *reference_, outside() ? -1 : 1, surface_cell(), progress_);
    result_.moved_back = told.moved_back;
    result_.crease_points = told.crease_points + told.corners;
  }

  void grow_layers() {
    progress_.begin_stage("layers");
    const double cell = result_.frame.cell;
    WallLayers layers = options_.layers;
    layers.first /= cell;
    LayerCoverage& told = result_.layers = grow_wall_layers(stuffed_, result_.mesh, source_, on_wall_, layers, surface_cell(), progress_);
    told = {told.wall_area * cell * cell, told.covered_area * cell * cell, told.least_first * cell, told.greatest_first * cell};
    mark_wall();
  }

  void name_patches() {
    const PolyhedralMesh& mesh = result_.mesh.mesh;
    const std::size_t internal = mesh.internal_faces();
    std::vector<MeshPatch> patches;
    for (const std::string& name : patch_names_) patches.push_back({name, "wall"});
    if (patches.empty()) patches.push_back({"surface", "wall"});
    const auto walls = static_cast<std::uint32_t>(patches.size());
    if (outside())
      for (const std::string_view side : kDomainPatches) patches.push_back({std::string(side), "patch"});
    std::vector<std::uint32_t> patch_of(mesh.faces() - internal, 0);
    parallel_for(patch_of.size(), [&](std::size_t i) {
      if (on_wall_[i]) patch_of[i] = patch_of_facet_.empty() ? 0 : patch_of_facet_[nearest_facet(internal + i)];
      else patch_of[i] = walls + side_of(internal + i);
    });
    sort_into_patches(result_.mesh, std::move(patches), patch_of);
  }

  std::uint32_t nearest_facet(std::size_t face) const {
    const ReferenceSurface::Foot foot = reference_->closest(face_middle(result_.mesh.mesh, face), 4 * surface_cell(), {});
    return foot.found() ? foot.facet : 0;
  }

  // The side of the domain that a face lies on.
  std::uint32_t side_of(std::size_t face) const {
    const Vec3 m = face_middle(result_.mesh.mesh, face);
    for (int a = 0; outside() && a < 3; ++a) {
      if (m[a] == 2.0 * static_cast<double>(region_.lower[static_cast<std::size_t>(a)])) return static_cast<std::uint32_t>(2 * a);
      if (m[a] == 2.0 * static_cast<double>(region_.upper[static_cast<std::size_t>(a)])) return static_cast<std::uint32_t>(2 * a + 1);
    }
    throw Error(ErrorCode::bug, "a face of the volume mesh is neither on the surface nor on a side of the domain");
  }

  // [T-HEX-8] Beyond the surface's box the lattice is stretched so that the domain's sides come to lie exactly where they were asked for.
  void to_model() {
    auto& points = result_.mesh.mesh.points;
    const Vec3 lower = result_.frame.to_lattice(options_.domain.lower), upper = result_.frame.to_lattice(options_.domain.upper);
    parallel_for(points.size(), [&](std::size_t i) {
      const Vec3 q = points[i];
      Vec3 r = q;
      if (outside())
        for (int a = 0; a < 3; ++a) {
          const double low = 2.0 * static_cast<double>(region_.lower[static_cast<std::size_t>(a)]), high = 2.0 * static_cast<double>(region_.upper[static_cast<std::size_t>(a)]);
          if (q[a] < body_.lower[a]) r[a] = body_.lower[a] - (body_.lower[a] - q[a]) * (body_.lower[a] - lower[a]) / (body_.lower[a] - low);
          if (q[a] > body_.upper[a]) r[a] = body_.upper[a] + (q[a] - body_.upper[a]) * (upper[a] - body_.upper[a]) / (high - body_.upper[a]);
        }
      points[i] = result_.frame.to_model(r);
      if (!outside()) return;
      for (int a = 0; a < 3; ++a) {
        if (q[a] == 2.0 * static_cast<double>(region_.lower[static_cast<std::size_t>(a)])) points[i][a] = options_.domain.lower[a];
        if (q[a] == 2.0 * static_cast<double>(region_.upper[static_cast<std::size_t>(a)])) points[i][a] = options_.domain.upper[a];
      }
    });
  }

  const TriangleSoup& surface_;
  const std::vector<std::uint32_t>& patch_of_facet_;
  const std::vector<std::string>& patch_names_;
  FlowMeshOptions options_;
  int surface_level_ = 0;  // of cells at the surface; refinements are below
  Box3 body_;  // the surface's box and two cells around it, in lattice units
  Progress& progress_;
  LatticeBox region_;
  StuffedCells stuffed_;
  std::vector<std::uint32_t> source_;      // of each point of the mesh: its place in stuffed_.points
  std::vector<std::uint8_t> on_wall_;      // per boundary face: on the surface
  std::unique_ptr<ReferenceSurface> reference_;
  FlowMesh result_;
};

}  // namespace

FlowMesh flow_mesh(const TriangleSoup& surface, const std::vector<std::uint32_t>& patch_of_facet, const std::vector<std::string>& patch_names, const FlowMeshOptions& options, Progress& progress) {
  return FlowMesher(surface, patch_of_facet, patch_names, options, progress).run();
}

}  // namespace burnish
