#include "burnish/volume/flow_mesh.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <optional>
#include <stdexcept>
#include <utility>

#include "assemble.h"
#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/text.h"
#include "burnish/extract/reference_surface.h"
#include "burnish/levelset/from_triangles.h"
#include "burnish/volume/mesh_quality.h"
#include "cell_lattice.h"
#include "fit_boundary.h"
#include "mesh_memory.h"
#include "mesh_refinement.h"
#include "stuffing.h"
#include "wall_layers.h"

namespace burnish {
namespace {

constexpr double kBand = 5;          // lattice units: the half diagonal of a cell, and what may move
constexpr double kDomainMargin = 4;  // between the band and the walls
constexpr double kInsideRoom = 2;    // cells around the surface that are there, if its inside is meshed
constexpr int kMostRefined = 5;      // levels below the cells at the surface
constexpr double kRoundingOfRoom = 1e-9;  // of it
constexpr double kCellsOfRoom = 4;   // of the coarsest cells that have room there
constexpr double kCreaseSnap = 0.7;  // half sides of the smallest cell at a node: nodes nearer than this go to the crease
constexpr double kCornerSnap = 1.12;  // and the nearest one to a corner: sqrt(5)/2, no point is farther from all nodes of cells of one size
constexpr std::size_t kMostLeftOut = 64;  // cells that nothing mends
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
    require_memory(surface_, options_, refinements_, region_, surface_level_, band());
    progress_.begin_stage("distances and signs");
    const LevelSet set = level_set_from_triangles(surface_, result_.frame, level_set_options(), progress_).level_set;
    progress_.begin_stage("cells");
    const CellLattice lattice(set, options_, refinements_, surface_level_, region_, progress_);
    require_memory(lattice.cells(), options_);
    refer();
    stuffed_ = stuff(lattice, set, options_.side == MeshSide::inside ? 1 : -1, options_.flavour, crease_target(), progress_);
    result_.mesh = assemble(stuffed_.points, stuffed_.cells, &source_);
    leave_out_crumbs(lattice);
    progress_.begin_stage("boundary");
    fit(lattice);
    if (options_.layers.count > 0) grow_layers();
    name_patches();
    count_levels(lattice);
    to_model();
    return std::move(result_);
  }

 private:
  // In cells of the level set's leaves, which may be of a level below the mesh's cells there: the diagonal of the largest of these, and what may move.
  double band() const { return std::max(kBand, std::sqrt(3.0) * (2 << std::max(surface_level_ > 0 ? 1 : 0, options_.flat_levels)) + 1); }
  // As fine as cells at the surface ask for, and finer in refinements alone.
  LevelSetOptions level_set_options() const {
    LevelSetOptions options{.band = band(), .far_field = false};
    options.adaptivity.limits.coarsest_level = surface_level_;
    options.adaptivity.limits.boxes = level_set_boxes(refinements_, options_.cells_between_levels, surface_level_);
    return options;
  }
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
    drop_refinements_beside(outside() ? options_.domain : body, options_.refinements, result_.notes);
    surface_level_ = levels_below_surface(options_, kMostRefined);
    const int coarsest = surface_level_ + options_.coarsest_level;
    const double coarse = static_cast<double>(2 << coarsest);
    const double reach = band() * surface_cell();
    result_.frame = make_frame(box, options_.cell / (2 * surface_cell()), outside() ? coarse + reach + kDomainMargin : reach + kDomainMargin);
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
    choose_stretch(body);
    refinements_ = on_lattice(options_, result_.frame, stretch_, cells_of_mesh(lower, upper), surface_level_);
  }

  // What boxes are cut to: the region, of which inside no more counts than what is around the surface's box, from `lower` to `upper` in finest cells.
  LatticeBox cells_of_mesh(const Vec3& lower, const Vec3& upper) const {
    LatticeBox cells = region_;
    for (int a = 0; !outside() && a < 3; ++a) {
      const auto i = static_cast<std::size_t>(a);
      cells.lower[i] = std::max(cells.lower[i], static_cast<std::int64_t>(std::floor(lower[a] - kInsideRoom * surface_cell())));
      cells.upper[i] = std::min(cells.upper[i], static_cast<std::int64_t>(std::ceil(upper[a] + kInsideRoom * surface_cell())));
    }
    return cells;
  }

  // [T-HEX-8] Within two cells around the surface's box nothing is stretched.
  void choose_stretch(const Box3& body) {
    const Vec3 around = Vec3{4, 4, 4} * surface_cell();
    stretch_.body = {result_.frame.to_lattice(body.lower) - around, result_.frame.to_lattice(body.upper) + around};
    for (std::size_t a = 0; a < 3; ++a) {
      stretch_.lattice.lower[static_cast<int>(a)] = 2.0 * static_cast<double>(region_.lower[a]);
      stretch_.lattice.upper[static_cast<int>(a)] = 2.0 * static_cast<double>(region_.upper[a]);
    }
    stretch_.domain = outside() ? Box3{result_.frame.to_lattice(options_.domain.lower), result_.frame.to_lattice(options_.domain.upper)} : stretch_.lattice;
  }

  void limit_coarsest(const Box3& body) {
    const Vec3 below = body.lower - options_.domain.lower, above = options_.domain.upper - body.upper;
    const std::array<double, 6> rooms{below.x, above.x, below.y, above.y, below.z, above.z};  // as kDomainPatches
    const auto least = std::min_element(rooms.begin(), rooms.end());
    const double room = *least / options_.cell;
    if (!(room >= kLeastRoom * (1 - kRoundingOfRoom))) refuse_room(kDomainPatches[static_cast<std::size_t>(least - rooms.begin())], *least, body);
    options_.coarsest_level = std::clamp(static_cast<int>(std::floor(std::log2(room / kCellsOfRoom) + kRoundingOfRoom)), 0, options_.coarsest_level);
  }

  [[noreturn]] void refuse_room(std::string_view side, double room, const Box3& body) const {
    const std::string there = room > 0 ? fmt::format("{:.4g}", room) : "none";
    throw Error(ErrorCode::usage,
                fmt::format("the domain, {}, {} the model, {}, at its side {}: the room there is {}, and {} cells, {:.4g}, are needed", text_of(options_.domain), room > 0 ? "is too near to" : "cuts",
                            text_of(body), side, there, kLeastRoom, kLeastRoom * options_.cell),
                "choose a --domain that is larger on all sides, or a smaller --cell");
  }

  // By the lattice's cell that the mean of their corners lies in.
  void count_levels(const CellLattice& lattice) {
    const VolumeMesh& volume = result_.mesh;
    std::vector<std::uint8_t> level(volume.cells());
    parallel_for(level.size(), [&](std::size_t c) {
      Vec3 sum;
      for (const std::uint32_t p : volume.cell(c)) sum += volume.mesh.points[p];
      level[c] = static_cast<std::uint8_t>(lattice.level_at(sum / static_cast<double>(volume.cell(c).size())));
    });
    for (const std::uint8_t l : level) {
      if (result_.cells_of_level.size() <= l) result_.cells_of_level.resize(l + 1u, 0);
      ++result_.cells_of_level[l];
    }
  }

  // Parts that hang by an edge or a point alone, and hold next to nothing.
  void leave_out_crumbs(const CellLattice& lattice) {
    std::vector<std::uint32_t> part;
    const std::uint32_t parts = connected_parts(result_.mesh.mesh, part);
    if (result_.mesh.cells() == 0) throw Error(ErrorCode::guarantee_unmet, "no cell of the mesh lies on this side of the surface", "choose a smaller --cell");
    if (parts == 1) return;
    const CellGeometry geometry = cell_geometry(result_.mesh.mesh, cell_faces(result_.mesh.mesh));
    std::vector<double> volume(parts, 0), cubes(parts, 0);  // the latter in cells of the sizes there
    for (std::size_t c = 0; c < part.size(); ++c) {
      volume[part[c]] += geometry.volume[c];
      cubes[part[c]] += geometry.volume[c] / std::exp2(3 * (lattice.level_at(geometry.middle[c]) + 1));
    }
    std::vector<std::uint8_t> keep(part.size());
    std::size_t crumbs = 0;
    double lost = 0;
    for (std::uint32_t i = 0; i < parts; ++i)
      if (cubes[i] < kSmallestPart) ++crumbs, lost += volume[i];
    if (crumbs == 0) return;
    if (crumbs == parts) throw Error(ErrorCode::guarantee_unmet, "the solid is thinner than a cell everywhere", "choose a smaller --cell");
    for (std::size_t c = 0; c < part.size(); ++c) keep[c] = cubes[part[c]] >= kSmallestPart;
    stuffed_.cells = kept_cells(stuffed_.cells, keep);
    result_.mesh = assemble(stuffed_.points, stuffed_.cells, &source_);
    const double cube = result_.frame.cell * result_.frame.cell * result_.frame.cell;
    result_.notes.push_back(fmt::format("{} parts of less than {} cells that hang together with the rest by no face, {:.3g} in all, are left out", crumbs, kSmallestPart, lost * cube));
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

  void fit(const CellLattice& lattice) {
    mark_wall();
    std::vector<std::uint8_t> level(result_.mesh.mesh.points.size());
    parallel_for(level.size(), [&](std::size_t p) { level[p] = static_cast<std::uint8_t>(std::min(lattice.level_at(result_.mesh.mesh.points[p]), surface_level_)); });
    const BoundaryFit told = fit_boundary(result_.mesh, on_wall_, *reference_, outside() ? -1 : 1, level, progress_);
    result_.moved_back = told.moved_back;
    result_.crease_points = told.crease_points + told.corners;
    if (told.bad > 0) leave_out_bad_cells();
  }

  // [T-HEX-6] What is bad at the wall and cannot be mended goes, and its neighbours if that makes these bad: flat cells, mostly, around a single point inside.
  void leave_out_bad_cells() {
    std::size_t left_out = 0;
    for (std::vector<std::uint32_t> bad = bad_at_wall(); !bad.empty() && left_out + bad.size() <= kMostLeftOut; bad = bad_at_wall()) {
      left_out += bad.size();
      const PolyhedralMesh& mesh = result_.mesh.mesh;
      for (std::size_t p = 0; p < mesh.points.size(); ++p) stuffed_.points[source_[p]] = mesh.points[p];
      std::vector<std::uint8_t> keep(result_.mesh.cells(), 1);
      for (const std::uint32_t c : bad) {
        keep[c] = 0;
        for (const std::uint32_t p : result_.mesh.cell(c)) stuffed_.on_surface[source_[p]] = 1;
      }
      stuffed_.cells = kept_cells(stuffed_.cells, keep);
      result_.mesh = assemble(stuffed_.points, stuffed_.cells, &source_);
      mark_wall();
    }
    if (left_out > 0) result_.notes.push_back(fmt::format("{} cells at the surface would be bad whatever becomes of their points, and are left out", left_out));
  }
  // Tetrahedra that checkMesh refuses or warns of, with a face on the wall, none of whose points is on the domain's sides.
  std::vector<std::uint32_t> bad_at_wall() const {
    const PolyhedralMesh& mesh = result_.mesh.mesh;
    const std::vector<std::uint8_t> at_end = points_at_end(mesh, on_wall_);
    std::vector<std::uint8_t> at_wall(result_.mesh.cells(), 0);
    for (std::size_t i = 0; i < on_wall_.size(); ++i)
      if (on_wall_[i]) at_wall[mesh.owner[mesh.internal_faces() + i]] = 1;
    std::vector<std::uint32_t> cells;
    for (const BadCell& b : bad_cells(mesh, {}, progress_)) {
      const auto corners = result_.mesh.cell(b.cell);
      if (at_wall[b.cell] && result_.mesh.shape[b.cell] == CellShape::tetrahedron && std::none_of(corners.begin(), corners.end(), [&](std::uint32_t p) { return at_end[p] != 0; })) cells.push_back(b.cell);
    }
    return cells;
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
    // However far: points that were moved back, and large cells where the surface is flat, may be cells off it.
    const ReferenceSurface::Foot foot = reference_->closest(face_middle(result_.mesh.mesh, face), std::numeric_limits<double>::infinity(), {});
    assert(foot.found());
    return foot.facet;
  }

  // The side of the domain that a face lies on.
  std::uint32_t side_of(std::size_t face) const {
    const Vec3 m = face_middle(result_.mesh.mesh, face);
    for (int a = 0; outside() && a < 3; ++a) {
      if (m[a] == stretch_.lattice.lower[a]) return static_cast<std::uint32_t>(2 * a);
      if (m[a] == stretch_.lattice.upper[a]) return static_cast<std::uint32_t>(2 * a + 1);
    }
    throw std::logic_error("a face of the volume mesh is neither on the surface nor on a side of the domain");
  }

  // Sides of the domain to the bit.
  void to_model() {
    auto& points = result_.mesh.mesh.points;
    parallel_for(points.size(), [&](std::size_t i) {
      const Vec3 q = points[i];
      points[i] = result_.frame.to_model(outside() ? stretch_.to_domain(q) : q);
      if (!outside()) return;
      for (int a = 0; a < 3; ++a) {
        if (q[a] == stretch_.lattice.lower[a]) points[i][a] = options_.domain.lower[a];
        if (q[a] == stretch_.lattice.upper[a]) points[i][a] = options_.domain.upper[a];
      }
    });
  }

  const TriangleSoup& surface_;
  const std::vector<std::uint32_t>& patch_of_facet_;
  const std::vector<std::string>& patch_names_;
  FlowMeshOptions options_;
  int surface_level_ = 0;  // of cells at the surface; refinements are below
  DomainStretch stretch_;
  std::vector<LatticeRefinement> refinements_;
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
