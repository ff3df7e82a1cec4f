#include "wall_layers.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <span>
#include <utility>

#include "assemble.h"
#include "burnish/core/parallel.h"
#include "burnish/volume/mesh_quality.h"
#include "mend.h"
#include "point_cells.h"
#include "relax.h"

namespace burnish {
namespace {

constexpr std::uint32_t kNone = 0xffffffffu;
constexpr int kRings = 5;          // of points that make room
constexpr int kFirstSweeps = 40, kSweeps = 12;  // of the solver, at first and when some columns have changed
constexpr int kRelaxations = 2;
constexpr int kTurns = 12;         // of a direction towards the face that it is flattest to
constexpr double kSteepest = 0.3;  // least cosine between a direction and the normals at its point
constexpr double kLongest = 1.5;   // a column's length along its direction, in thicknesses
constexpr double kLower = 0.6;     // what is left of a column at a bad cell
constexpr double kLowest = 0.5;    // what is lower than this part of the thickness vanishes
// After so many rounds points of bad cells are not relaxed any more; stay where they were without layers; columns beside those at bad cells get lower too; they vanish, with two rings around them;
// no layers are made.
constexpr int kRelaxingRounds = 3, kMovingRounds = 10, kLoneRounds = 10, kLoweringRounds = 14, kRounds = 20;
constexpr int kMendingFrom = 1, kMendings = 2;  // rounds
constexpr std::size_t kMendable = 50, kMendablePart = 32;  // bad cells: so many, or one for so many columns
constexpr MeshQualityLimits kLimits{.non_orthogonality = 70, .internal_skewness = 2, .boundary_skewness = 2};

using Links = std::vector<std::pair<std::uint32_t, std::uint32_t>>;

class LayerGrowth {
 public:
  LayerGrowth(StuffedCells& cells, VolumeMesh& mesh, std::vector<std::uint32_t>& source, const std::vector<std::uint8_t>& on_wall, const WallLayers& layers, double cell, Progress& progress)
      : cells_(cells), volume_(mesh), mesh_(mesh.mesh), source_(source), layers_(layers), cell_(cell), progress_(progress), inner_cells_(cells.cells.size()), points_cells_(mesh), at_end_(points_at_end(mesh.mesh, on_wall)) {
    for (std::uint32_t i = 0; i < on_wall.size(); ++i)
      if (on_wall[i]) faces_.push_back(static_cast<std::uint32_t>(mesh_.internal_faces()) + i);
    divide_column();
  }

  LayerCoverage run() {
    start_ = mesh_.points;
    list_wall_points();
    choose_directions();
    number_rings(at_end_);
    link_points();
    choose_relaxed();
    move_.assign(start_.size(), {});
    solve(kFirstSweeps);
    build();
    if (!make_good()) leave_out_layers();
    finish();
    return result_;
  }

 private:
  // False if bad cells are left after all rounds.
  bool make_good() {
    for (int round = 0;; ++round) {
      progress_.check();
      std::vector<BadCell> bad = judged();
      if (round >= kMendingFrom && bad.size() <= std::max(kMendable, wall_.size() / kMendablePart)) bad = mended(std::move(bad));
      if (bad.empty()) return true;
      if (round == kRounds) return false;
      lower(bad, round);
      solve(kSweeps);
      build();
    }
  }

  // The mesh as it was.
  void leave_out_layers() {
    std::fill(part_.begin(), part_.end(), 0);
    std::fill(relaxed_.begin(), relaxed_.end(), 0);
    std::fill(held_.begin(), held_.end(), 1);
    solve(1);
    build();
  }

  // Heights are first, first ratio, first ratio^2 ...: where levels are, as parts of the whole.
  void divide_column() {
    double sum = 0, height = layers_.first;
    level_.push_back(0);
    for (int k = 0; k < layers_.count; ++k) level_.push_back(sum += height), height *= layers_.ratio;
    thickness_ = sum;
    for (double& s : level_) s /= sum;
  }

  void list_wall_points() {
    column_.assign(start_.size(), kNone);
    for (const std::uint32_t f : faces_)
      for (const std::uint32_t p : mesh_.face(f))
        if (column_[p] == kNone) column_[p] = static_cast<std::uint32_t>(wall_.size()), wall_.push_back(p);
    face_at_.assign(wall_.size() + 1, 0);
    for (const std::uint32_t f : faces_)
      for (const std::uint32_t p : mesh_.face(f)) ++face_at_[column_[p] + 1];
    for (std::size_t c = 1; c < face_at_.size(); ++c) face_at_[c] += face_at_[c - 1];
    around_.resize(face_at_.back());
    std::vector<std::uint64_t> next(face_at_.begin(), face_at_.end() - 1);
    for (const std::uint32_t f : faces_)
      for (const std::uint32_t p : mesh_.face(f)) around_[next[column_[p]]++] = f;
  }

  std::span<const std::uint32_t> faces_at(std::uint32_t column) const { return {around_.data() + face_at_[column], static_cast<std::size_t>(face_at_[column + 1] - face_at_[column])}; }

  // [T-LAYER-1]
  void choose_directions() {
    direction_.resize(wall_.size());
    part_.assign(wall_.size(), 1);
    parallel_for(wall_.size(), [&](std::size_t c) {
      const auto column = static_cast<std::uint32_t>(c);
      if (!choose_direction(column) || !is_one_fan(column)) part_[c] = 0;
    });
  }

  // Into the mesh, of unit length.
  Vec3 normal_of(std::uint32_t f) const {
    const auto face = mesh_.face(f);
    Vec3 n;
    for (std::size_t k = 2; k < face.size(); ++k) n -= cross(start_[face[k - 1]] - start_[face[0]], start_[face[k]] - start_[face[0]]);
    const double length = norm(n);
    return length > 0 ? n / length : Vec3{};
  }

  double angle_at(std::uint32_t f, std::uint32_t p) const {
    const auto face = mesh_.face(f);
    const auto at = static_cast<std::size_t>(std::find(face.begin(), face.end(), p) - face.begin());
    const Vec3 a = start_[face[(at + 1) % face.size()]] - start_[p], b = start_[face[(at + face.size() - 1) % face.size()]] - start_[p];
    return std::atan2(norm(cross(a, b)), dot(a, b));
  }

  bool choose_direction(std::uint32_t column) {
    std::vector<Vec3> normals;
    Vec3 n;
    for (const std::uint32_t f : faces_at(column)) {
      normals.push_back(normal_of(f));
      n += normals.back() * angle_at(f, wall_[column]);
    }
    const auto flattest = [&] { return *std::min_element(normals.begin(), normals.end(), [&](const Vec3& a, const Vec3& b) { return dot(a, n) < dot(b, n); }); };
    for (int turn = 0; turn < kTurns; ++turn) {
      if (!(norm(n) > 0)) return false;
      n = n / norm(n);
      const Vec3 worst = flattest();
      if (dot(worst, n) > 0.95) break;
      n += worst * (0.5 / (1 + turn));
    }
    n = n / norm(n);
    const double cosine = dot(flattest(), n);
    direction_[column] = n * std::min(kLongest, 1 / std::max(cosine, kSteepest));
    return cosine > kSteepest;
  }

  // Whether the wall at a point is one disc: where it touches itself there is no one direction.
  bool is_one_fan(std::uint32_t column) const {
    const std::uint32_t p = wall_[column];
    Links next;  // behind p, before p: a face leads from one neighbour to the other
    for (const std::uint32_t f : faces_at(column)) {
      const auto face = mesh_.face(f);
      const auto at = static_cast<std::size_t>(std::find(face.begin(), face.end(), p) - face.begin());
      next.emplace_back(face[(at + 1) % face.size()], face[(at + face.size() - 1) % face.size()]);
    }
    std::sort(next.begin(), next.end());
    std::uint32_t at = next.front().first;
    for (std::size_t steps = 1; steps <= next.size(); ++steps) {
      const auto found = std::lower_bound(next.begin(), next.end(), std::pair{at, 0u});
      if (found == next.end() || found->first != at || (found + 1 != next.end() && (found + 1)->first == at)) return false;
      at = found->second;
      if (at == next.front().first) return steps == next.size();
    }
    return false;
  }

  template <class Visit>
  void visit_edges(Visit&& visit) const {
    for (std::size_t f = 0; f < mesh_.faces(); ++f) {
      const auto face = mesh_.face(f);
      for (std::size_t k = 0; k < face.size(); ++k) visit(face[k], face[(k + 1) % face.size()]);
    }
  }

  // Edges between a point and the wall; what is on a side of the domain has none.
  void number_rings(const std::vector<std::uint8_t>& end) {
    ring_.assign(start_.size(), kRings + 1);
    root_.assign(start_.size(), kNone);
    for (std::uint32_t c = 0; c < wall_.size(); ++c) ring_[wall_[c]] = 0, root_[wall_[c]] = c;
    for (int ring = 1; ring <= kRings; ++ring) {
      const auto reach = [&](std::uint32_t from, std::uint32_t to) {
        if (ring_[from] != ring - 1 || ring_[to] < ring || end[to]) return;
        ring_[to] = ring;
        root_[to] = std::min(root_[to], root_[from]);
      };
      visit_edges([&](std::uint32_t a, std::uint32_t b) { reach(a, b), reach(b, a); });
    }
  }

  bool is_free(std::uint32_t p) const { return ring_[p] > 0 && ring_[p] <= kRings; }

  void link_points() {
    Links links;
    visit_edges([&](std::uint32_t a, std::uint32_t b) {
      if (is_free(a)) links.emplace_back(a, b);
      if (is_free(b)) links.emplace_back(b, a);
    });
    parallel_sort(links);
    links.erase(std::unique(links.begin(), links.end()), links.end());
    for (std::size_t i = 0; i < links.size(); ++i) {
      if (i == 0 || links[i].first != links[i - 1].first) free_.push_back(links[i].first), link_at_.push_back(i);
      linked_.push_back(links[i].second);
      weight_.push_back(1 / std::max(1e-6, norm(start_[links[i].first] - start_[links[i].second])));
    }
    link_at_.push_back(links.size());
  }

  // Those of hexahedra keep their right angles.
  void choose_relaxed() {
    relaxed_.assign(start_.size(), 0);
    held_ = relaxed_;
    for (const std::uint32_t p : free_) relaxed_[p] = 1;
    for (std::size_t c = 0; c < volume_.cells(); ++c)
      if (volume_.shape[c] == CellShape::hexahedron || volume_.shape[c] == CellShape::polyhedron)
        for (const std::uint32_t p : volume_.cell(c)) relaxed_[p] = 0;
  }

  // [T-LAYER-2] Jacobi's sweeps from where the last solution was.
  void solve(int sweeps) {
    settle();
    for (std::size_t c = 0; c < wall_.size(); ++c) move_[wall_[c]] = direction_[c] * (thickness_ * part_[c]);
    std::vector<Vec3> next(free_.size());
    for (int sweep = 0; sweep < sweeps; ++sweep) {
      parallel_for(free_.size(), [&](std::size_t i) {
        Vec3 sum;
        double weights = 0;
        for (std::size_t k = link_at_[i]; k < link_at_[i + 1]; ++k) sum += move_[linked_[k]] * weight_[k], weights += weight_[k];
        next[i] = held_[free_[i]] ? Vec3{} : sum / weights;
      });
      parallel_for(free_.size(), [&](std::size_t i) { move_[free_[i]] = next[i]; });
    }
  }

  bool live(std::uint32_t p) const { return part_[column_[p]] > 0; }

  // Of the neighbours of a corner without a column one loses its own, too: along the same axis everywhere, so that what is lost are rows and not areas.
  void drop_beside(std::span<const std::uint32_t> face, std::size_t corner) {
    const auto along = [&](std::uint32_t p) {
      const Vec3 d = start_[p] - start_[face[corner]];
      return (std::abs(d.x) + 0.5 * std::abs(d.y)) / std::max(norm(d), 1e-300);
    };
    const std::uint32_t next = face[(corner + 1) % 4], before = face[(corner + 3) % 4];
    part_[column_[along(next) > along(before) ? next : before]] = 0;
  }

  // A quadrilateral's columns all stand, or two neighbours, or none.
  bool settle(std::uint32_t f) {
    const auto face = mesh_.face(f);
    if (face.size() < 4) return false;
    std::vector<std::size_t> standing;
    for (std::size_t k = 0; k < face.size(); ++k)
      if (live(face[k])) standing.push_back(k);
    const std::size_t n = standing.size();
    if (n == 0 || (face.size() == 4 && n == 4)) return false;
    if (face.size() == 4 && n == 2 && (standing[1] - standing[0]) % 2 == 1) return false;
    if (face.size() == 4 && n == 3) {
      for (std::size_t k = 0; k < 4; ++k)
        if (!live(face[k])) return drop_beside(face, k), true;
    }
    for (const std::size_t k : standing) part_[column_[face[k]]] = 0;
    return true;
  }

  // Columns that no whole prism has hold none up.
  bool drop_lone_columns() {
    std::vector<std::uint8_t> held(wall_.size(), 0);
    for (const std::uint32_t f : faces_) {
      const auto face = mesh_.face(f);
      if (std::all_of(face.begin(), face.end(), [&](std::uint32_t p) { return live(p); }))
        for (const std::uint32_t p : face) held[column_[p]] = 1;
    }
    bool dropped = false;
    for (std::size_t c = 0; c < wall_.size(); ++c)
      if (part_[c] > 0 && !held[c]) part_[c] = 0, dropped = true;
    return dropped;
  }

  void settle() {
    for (bool again = true; again;) {
      again = drop_lone_columns();
      for (const std::uint32_t f : faces_) again = settle(f) || again;
    }
  }

  // The point of a column at a level: 0 is the wall, the last one the mesh's own point.
  std::uint32_t at_level(std::uint32_t p, int level) const {
    if (!live(p) || level == layers_.count) return source_[p];
    return first_point_[column_[p]] + static_cast<std::uint32_t>(level);
  }

  void build() {
    place_points();
    CellList& list = cells_.cells;
    list.shape.resize(inner_cells_), list.first.resize(inner_cells_ + 1), list.corners.resize(list.first.back());
    face_of_cell_.clear();
    for (const std::uint32_t f : faces_)
      for (int k = 0; k < layers_.count; ++k) {
        const std::size_t before = list.size();
        add_cell(mesh_.face(f), k);
        if (list.size() > before) face_of_cell_.push_back(f);
      }
    grown_ = assemble(cells_.points, list, &grown_source_);
  }

  void place_points() {
    if (base_ == 0) base_ = cells_.points.size();
    cells_.points.resize(base_);
    first_point_.assign(wall_.size(), kNone);
    for (std::uint32_t p = 0; p < start_.size(); ++p) mesh_.points[p] = start_[p] + move_[p];
    relax(volume_, points_cells_, relaxed_, kRelaxations);
    for (std::uint32_t p = 0; p < start_.size(); ++p) cells_.points[source_[p]] = mesh_.points[p];
    for (std::size_t c = 0; c < wall_.size(); ++c) {
      if (!(part_[c] > 0)) continue;
      first_point_[c] = static_cast<std::uint32_t>(cells_.points.size());
      for (int k = 0; k < layers_.count; ++k) cells_.points.push_back(start_[wall_[c]] + move_[wall_[c]] * level_[static_cast<std::size_t>(k)]);
    }
  }

  void add_cell(std::span<const std::uint32_t> face, int level) {
    CellList& list = cells_.cells;
    const std::size_t n = face.size();
    const auto standing = static_cast<std::size_t>(std::count_if(face.begin(), face.end(), [&](std::uint32_t p) { return live(p); }));
    if (standing == 0) return;
    // Begins with the first of the columns that stand in a row.
    std::size_t begin = 0;
    if (standing < n)
      while (!(live(face[begin]) && !live(face[(begin + n - 1) % n]))) ++begin;
    const auto outer = [&](std::size_t k) { return at_level(face[(begin + k) % n], level); };
    const auto inner = [&](std::size_t k) { return at_level(face[(begin + k) % n], level + 1); };
    if (n == 4 && standing == 4) return list.add(CellShape::hexahedron, {inner(0), inner(1), inner(2), inner(3), outer(0), outer(1), outer(2), outer(3)});
    if (n == 4) return list.add(CellShape::wedge, {inner(0), outer(0), outer(3), inner(1), outer(1), outer(2)});
    if (standing == 3) return list.add(CellShape::wedge, {outer(0), outer(1), outer(2), inner(0), inner(1), inner(2)});
    if (standing == 2) return list.add(CellShape::pyramid, {outer(0), outer(1), inner(1), inner(0), outer(2)});
    list.add(CellShape::tetrahedron, {inner(0), outer(1), outer(2), outer(0)});
  }

  // The columns that a bad cell is blamed on.
  void blame(std::uint32_t cell, std::vector<std::uint32_t>& columns) const {
    const auto points = cell < inner_cells_ ? volume_.cell(cell) : mesh_.face(face_of_cell_[cell - inner_cells_]);
    for (const std::uint32_t p : points)
      if (root_[p] != kNone) columns.push_back(root_[p]);
  }

  std::vector<BadCell> judged() const { return without_split_ones(grown_, bad_cells(grown_.mesh, kLimits, progress_)); }

  // By moving points that are not on the boundary. (Of very many bad cells only some are looked at.)
  std::vector<BadCell> mended(std::vector<BadCell> bad) {
    const PolyhedralMesh& mesh = grown_.mesh;
    const PointCells around(grown_);
    const CellFaces faces = cell_faces(mesh);
    std::vector<std::uint8_t> fixed(mesh.points.size(), 0);
    for (std::size_t f = mesh.internal_faces(); f < mesh.faces(); ++f)
      for (const std::uint32_t p : mesh.face(f)) fixed[p] = 1;
    bad = Mending(grown_, around, faces, fixed, kLimits, cell_, progress_).mend(std::move(bad), kMendings);
    return bad.empty() ? judged() : bad;
  }

  // [T-LAYER-3]
  void lower(const std::vector<BadCell>& bad, int round) {
    std::vector<std::uint32_t> columns;
    for (const BadCell& b : bad) blame(b.cell, columns);
    for (const BadCell& b : bad) hold(b.cell, round);
    if (round >= kLoneRounds) add_neighbours(columns);
    if (round >= kLoweringRounds) add_neighbours(columns);
    std::sort(columns.begin(), columns.end());
    columns.erase(std::unique(columns.begin(), columns.end()), columns.end());
    for (const std::uint32_t c : columns) {
      part_[c] *= round >= kLoweringRounds ? 0 : kLower;
      if (part_[c] < kLowest) part_[c] = 0;
    }
  }

  void hold(std::uint32_t cell, int round) {
    if (cell >= inner_cells_) return;
    for (const std::uint32_t p : volume_.cell(cell)) {
      if (round >= kRelaxingRounds) relaxed_[p] = 0;
      if (round >= kMovingRounds) held_[p] = 1;
    }
  }

  void add_neighbours(std::vector<std::uint32_t>& columns) const {
    const std::size_t n = columns.size();
    for (std::size_t i = 0; i < n; ++i)
      for (const std::uint32_t f : faces_at(columns[i]))
        for (const std::uint32_t p : mesh_.face(f)) columns.push_back(column_[p]);
  }

  void finish() {
    measure();
    cells_.on_surface.resize(cells_.points.size(), 0);
    for (std::size_t c = 0; c < wall_.size(); ++c) {
      if (!(part_[c] > 0)) continue;
      cells_.on_surface[source_[wall_[c]]] = 0;
      cells_.on_surface[first_point_[c]] = 1;
    }
    volume_ = std::move(grown_);
    source_ = std::move(grown_source_);
  }

  // Areas, and first heights as distances of points from the faces' planes, of faces with all columns.
  void measure() {
    result_.least_first = std::numeric_limits<double>::infinity();
    for (const std::uint32_t f : faces_) {
      const auto face = mesh_.face(f);
      Vec3 area;
      for (std::size_t k = 2; k < face.size(); ++k) area += cross(start_[face[k - 1]] - start_[face[0]], start_[face[k]] - start_[face[0]]) * 0.5;
      result_.wall_area += norm(area);
      if (!std::all_of(face.begin(), face.end(), [&](std::uint32_t p) { return live(p); })) continue;
      result_.covered_area += norm(area);
      const Vec3 n = normal_of(f);
      double height = 0;
      for (const std::uint32_t p : face) height += dot(move_[p], n) * level_[1] / static_cast<double>(face.size());
      result_.least_first = std::min(result_.least_first, height);
      result_.greatest_first = std::max(result_.greatest_first, height);
    }
    if (!(result_.covered_area > 0)) result_.least_first = 0;
  }

  StuffedCells& cells_;
  VolumeMesh& volume_;
  PolyhedralMesh& mesh_;
  std::vector<std::uint32_t>& source_;
  const WallLayers& layers_;
  const double cell_;
  Progress& progress_;
  const std::size_t inner_cells_;
  const PointCells points_cells_;
  const std::vector<std::uint8_t> at_end_;  // points on the domain's sides
  std::vector<std::uint8_t> relaxed_;  // points that relax() may move
  std::vector<std::uint8_t> held_;     // points that make no room
  std::size_t base_ = 0;               // points of the mesh without layers
  double thickness_ = 0;
  std::vector<double> level_;          // of points of a column, as parts of its length from the wall
  std::vector<Vec3> start_;            // where the mesh was fitted
  std::vector<std::uint32_t> faces_;   // of the wall
  std::vector<std::uint32_t> wall_;    // point of each column
  std::vector<std::uint32_t> column_;  // of each point
  std::vector<std::uint64_t> face_at_;
  std::vector<std::uint32_t> around_;  // wall faces at each column
  std::vector<Vec3> direction_;        // of each column, as long as a column of thickness 1
  std::vector<double> part_;           // of the thickness, that a column has; 0: it does not stand
  std::vector<int> ring_;
  std::vector<std::uint32_t> root_;    // a column that each point moves with
  std::vector<std::uint32_t> free_;    // points that make room, and what edges lead to
  std::vector<std::size_t> link_at_;
  std::vector<std::uint32_t> linked_;
  std::vector<double> weight_;
  std::vector<Vec3> move_;             // of each point
  std::vector<std::uint32_t> first_point_;   // of each column, among cells_.points
  std::vector<std::uint32_t> face_of_cell_;  // of each cell of a layer
  VolumeMesh grown_;
  std::vector<std::uint32_t> grown_source_;
  LayerCoverage result_;
};

}  // namespace

LayerCoverage grow_wall_layers(StuffedCells& cells, VolumeMesh& mesh, std::vector<std::uint32_t>& source, const std::vector<std::uint8_t>& on_wall, const WallLayers& layers, double cell, Progress& progress) {
  return LayerGrowth(cells, mesh, source, on_wall, layers, cell, progress).run();
}

}  // namespace burnish
