#include "support/volume_meshes.h"

#include <algorithm>
#include <array>
#include <map>
#include <random>
#include <tuple>
#include <utility>

namespace burnish::test {
namespace {

struct Side {
  std::uint32_t cell, face;
};

std::vector<std::pair<std::vector<std::uint32_t>, Side>> sorted_sides(const std::vector<CellLoops>& cells) {
  std::vector<std::pair<std::vector<std::uint32_t>, Side>> sides;
  for (std::uint32_t c = 0; c < cells.size(); ++c)
    for (std::uint32_t f = 0; f < cells[c].size(); ++f) {
      sides.push_back({cells[c][f], {c, f}});
      std::sort(sides.back().first.begin(), sides.back().first.end());
    }
  std::sort(sides.begin(), sides.end(), [](const auto& a, const auto& b) {
    return std::tie(a.first, a.second.cell) < std::tie(b.first, b.second.cell);
  });
  return sides;
}

std::uint32_t grid_point(const Grid& g, int i, int j, int k) { return static_cast<std::uint32_t>(i + (g.nx + 1) * (j + (g.ny + 1) * k)); }

std::vector<Vec3> grid_points(const Grid& g) {
  std::vector<Vec3> points;
  const Vec3 h = g.spacing();
  for (int k = 0; k <= g.nz; ++k)
    for (int j = 0; j <= g.ny; ++j)
      for (int i = 0; i <= g.nx; ++i) points.push_back({g.lower.x + i * h.x, g.lower.y + j * h.y, g.lower.z + k * h.z});
  return points;
}

// corner b is at the bits of b.
CellLoops hexahedron(const std::array<std::uint32_t, 8>& c) {
  return {{c[0], c[4], c[6], c[2]}, {c[1], c[3], c[7], c[5]}, {c[0], c[1], c[5], c[4]},
          {c[2], c[6], c[7], c[3]}, {c[0], c[2], c[3], c[1]}, {c[4], c[5], c[7], c[6]}};
}

std::array<std::uint32_t, 8> corners_of(const Grid& g, int i, int j, int k) {
  std::array<std::uint32_t, 8> c;
  for (int b = 0; b < 8; ++b) c[static_cast<std::size_t>(b)] = grid_point(g, i + (b & 1), j + (b >> 1 & 1), k + (b >> 2));
  return c;
}

template <class Visit>
void for_each_cell(const Grid& g, Visit&& visit) {
  for (int k = 0; k < g.nz; ++k)
    for (int j = 0; j < g.ny; ++j)
      for (int i = 0; i < g.nx; ++i) visit(i, j, k);
}

double sixfold(const std::vector<Vec3>& p, const std::array<std::uint32_t, 4>& t) {
  return dot(p[t[1]] - p[t[0]], cross(p[t[2]] - p[t[0]], p[t[3]] - p[t[0]]));
}

// Positively oriented.
std::vector<std::array<std::uint32_t, 4>> kuhn(const Grid& g, const std::vector<Vec3>& points) {
  std::vector<std::array<std::uint32_t, 4>> tets;
  for_each_cell(g, [&](int i, int j, int k) {
    const auto c = corners_of(g, i, j, k);
    std::array<std::size_t, 3> axes{1, 2, 4};
    do {
      std::array<std::uint32_t, 4> t{c[0], c[axes[0]], c[axes[0] + axes[1]], c[7]};
      if (sixfold(points, t) < 0) std::swap(t[1], t[2]);
      tets.push_back(t);
    } while (std::next_permutation(axes.begin(), axes.end()));
  });
  return tets;
}

std::array<std::array<std::uint32_t, 3>, 4> outward_faces(const std::array<std::uint32_t, 4>& t) {
  return {{{t[1], t[2], t[3]}, {t[0], t[3], t[2]}, {t[0], t[1], t[3]}, {t[0], t[2], t[1]}}};
}

// Steps of half a cell; a point of these for each that some cell uses.
class HalfGrid {
 public:
  explicit HalfGrid(const Grid& g) : grid_{g.lower, g.upper, 2 * g.nx, 2 * g.ny, 2 * g.nz}, all_(grid_points(grid_)), used_(all_.size(), false) {}
  std::array<std::uint32_t, 8> take(int i, int j, int k, int step) {
    std::array<std::uint32_t, 8> c;
    for (int b = 0; b < 8; ++b) {
      c[static_cast<std::size_t>(b)] = grid_point(grid_, i + step * (b & 1), j + step * (b >> 1 & 1), k + step * (b >> 2));
      used_[c[static_cast<std::size_t>(b)]] = true;
    }
    return c;
  }
  // The faces of a coarse cell with what hangs on them.
  CellLoops with_hanging(const CellLoops& cell) const {
    CellLoops result;
    for (const auto& face : cell) {
      std::vector<std::uint32_t> ring;
      for (std::size_t i = 0; i < 4; ++i) {
        ring.push_back(face[i]);
        const std::uint32_t middle = (face[i] + face[(i + 1) % 4]) / 2;
        if (used_[middle]) ring.push_back(middle);
      }
      const std::uint32_t center = (face[0] + face[2]) / 2;
      if (!used_[center]) result.push_back(ring);
      else for (std::size_t i = 0; i < 8; i += 2) result.push_back({ring[i], ring[i + 1], center, ring[(i + 7) % 8]});
    }
    return result;
  }
  const std::vector<Vec3>& all() const { return all_; }
  const std::vector<char>& used() const { return used_; }

 private:
  Grid grid_;
  std::vector<Vec3> all_;
  std::vector<char> used_;
};

PolyhedralMesh without_unused(std::vector<Vec3> points, const std::vector<char>& used, std::vector<CellLoops> cells) {
  std::vector<std::uint32_t> number(points.size());
  std::vector<Vec3> kept;
  for (std::size_t p = 0; p < points.size(); ++p) {
    number[p] = static_cast<std::uint32_t>(kept.size());
    if (used[p]) kept.push_back(points[p]);
  }
  for (CellLoops& cell : cells)
    for (auto& face : cell)
      for (std::uint32_t& p : face) p = number[p];
  return mesh_of_cells(std::move(kept), cells);
}

// The dual of a tetrahedralisation: its points are the tetrahedra's centres, boundary triangles' centres, middles of boundary
// edges, and boundary points.
class Dual {
 public:
  Dual(const std::vector<Vec3>& points, const std::vector<std::array<std::uint32_t, 4>>& tets) : primal_(points), cells_(points.size()) {
    for (const auto& t : tets) add_tetrahedron(t);
    for (const auto& [key, sides] : triangles_)
      if (sides.size() == 1) add_boundary(sides[0]);
    for (const auto& [edge, links] : links_) add_face(edge, links);
  }
  PolyhedralMesh mesh() const { return mesh_of_cells(points_, cells_); }

 private:
  using Edge = std::pair<std::uint32_t, std::uint32_t>;
  using Link = std::pair<std::uint32_t, std::uint32_t>;  // of the loop around an edge, from one dual point to the next

  std::uint32_t add_point(const Vec3& p) {
    points_.push_back(p);
    return static_cast<std::uint32_t>(points_.size() - 1);
  }
  // The triangles of a tetrahedron at an edge, in the order in which one turns around it.
  void add_tetrahedron(const std::array<std::uint32_t, 4>& t) {
    const std::uint32_t here = add_point((primal_[t[0]] + primal_[t[1]] + primal_[t[2]] + primal_[t[3]]) * 0.25);
    for (const auto& f : outward_faces(t)) {
      auto key = f;
      std::sort(key.begin(), key.end());
      auto& sides = triangles_[key];
      sides.push_back({f, here});
      if (sides.size() == 2) link(sides[0], sides[1].dual);
    }
  }
  struct Triangle {
    std::array<std::uint32_t, 3> points;
    std::uint32_t dual;
  };
  // Seen along a directed edge of its outward loop, one leaves a tetrahedron clockwise.
  void link(const Triangle& from, std::uint32_t to) {
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = from.points[i], b = from.points[(i + 1) % 3];
      if (a < b) links_[{a, b}].push_back({to, from.dual});
      else links_[{b, a}].push_back({from.dual, to});
    }
  }
  void add_boundary(const Triangle& t) {
    const auto& p = t.points;
    const std::uint32_t center = add_point((primal_[p[0]] + primal_[p[1]] + primal_[p[2]]) / 3.0);
    link(t, center);
    for (std::size_t i = 0; i < 3; ++i) {
      const std::uint32_t a = p[i], b = p[(i + 1) % 3], c = p[(i + 2) % 3];
      cells_[a].push_back({corner(a), middle(a, b), center, middle(a, c)});
      if (a < b) links_[{a, b}].push_back({middle(a, b), center});
      else links_[{b, a}].push_back({center, middle(a, b)});
    }
  }
  std::uint32_t corner(std::uint32_t a) {
    const auto [at, is_new] = corners_.try_emplace(a, static_cast<std::uint32_t>(points_.size()));
    if (is_new) add_point(primal_[a]);
    return at->second;
  }
  std::uint32_t middle(std::uint32_t a, std::uint32_t b) {
    const auto [at, is_new] = middles_.try_emplace(std::minmax(a, b), static_cast<std::uint32_t>(points_.size()));
    if (is_new) add_point((primal_[a] + primal_[b]) * 0.5);
    return at->second;
  }
  void add_face(const Edge& edge, const std::vector<Link>& links) {
    std::map<std::uint32_t, std::uint32_t> next(links.begin(), links.end());
    std::vector<std::uint32_t> loop{links[0].first};
    while (next.at(loop.back()) != loop[0]) loop.push_back(next.at(loop.back()));
    cells_[edge.second].push_back(loop);
    std::reverse(loop.begin(), loop.end());
    cells_[edge.first].push_back(loop);
  }

  const std::vector<Vec3>& primal_;
  std::vector<Vec3> points_;
  std::vector<CellLoops> cells_;
  std::map<std::array<std::uint32_t, 3>, std::vector<Triangle>> triangles_;
  std::map<Edge, std::vector<Link>> links_;
  std::map<std::uint32_t, std::uint32_t> corners_;
  std::map<Edge, std::uint32_t> middles_;
};

void jitter_points(std::vector<Vec3>& points, const Grid& g, double by, std::uint32_t seed) {
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> step(-by, by);
  const Vec3 h = g.spacing();
  for (Vec3& p : points) {
    const Vec3 d{step(random) * h.x, step(random) * h.y, step(random) * h.z};
    bool inside = true;
    for (int a = 0; a < 3; ++a) inside &= p[a] - g.lower[a] > 1e-9 * h[a] && g.upper[a] - p[a] > 1e-9 * h[a];
    if (inside) p += d;
  }
}

}  // namespace

PolyhedralMesh mesh_of_cells(std::vector<Vec3> points, const std::vector<CellLoops>& cells) {
  PolyhedralMesh mesh;
  mesh.points = std::move(points);
  mesh.cells = static_cast<std::uint32_t>(cells.size());
  const auto sides = sorted_sides(cells);
  std::vector<std::pair<std::array<std::uint32_t, 2>, Side>> inner;
  std::vector<Side> outer;
  for (std::size_t i = 0; i < sides.size(); ++i) {
    if (i + 1 < sides.size() && sides[i].first == sides[i + 1].first) {
      inner.push_back({{sides[i].second.cell, sides[i + 1].second.cell}, sides[i].second});
      ++i;
    } else {
      outer.push_back(sides[i].second);
    }
  }
  std::stable_sort(inner.begin(), inner.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  const auto add = [&](const Side& side) {
    const auto& loop = cells[side.cell][side.face];
    mesh.face_start.push_back(mesh.face_points.size());
    mesh.face_points.insert(mesh.face_points.end(), loop.begin(), loop.end());
    mesh.owner.push_back(side.cell);
  };
  for (const auto& [pair, side] : inner) {
    add(side);
    mesh.neighbour.push_back(pair[1]);
  }
  for (const Side& side : outer) add(side);
  mesh.face_start.push_back(mesh.face_points.size());
  mesh.patches.push_back({"walls", "wall", static_cast<std::uint32_t>(inner.size()), static_cast<std::uint32_t>(outer.size())});
  return mesh;
}

Grid cubic_grid(const Vec3& lower, const Vec3& upper, int n) { return {lower, upper, n, n, n}; }

PolyhedralMesh hexahedra(const Grid& grid) {
  std::vector<CellLoops> cells;
  for_each_cell(grid, [&](int i, int j, int k) { cells.push_back(hexahedron(corners_of(grid, i, j, k))); });
  return mesh_of_cells(grid_points(grid), cells);
}

PolyhedralMesh jittered(PolyhedralMesh mesh, const Grid& grid, double by, std::uint32_t seed) {
  jitter_points(mesh.points, grid, by, seed);
  return mesh;
}

PolyhedralMesh kuhn_tetrahedra(const Grid& grid) {
  const std::vector<Vec3> points = grid_points(grid);
  std::vector<CellLoops> cells;
  for (const auto& t : kuhn(grid, points)) {
    CellLoops cell;
    for (const auto& f : outward_faces(t)) cell.push_back({f[0], f[1], f[2]});
    cells.push_back(cell);
  }
  return mesh_of_cells(points, cells);
}

PolyhedralMesh two_levels(const Grid& grid, const std::function<bool(const Vec3&)>& is_fine) {
  HalfGrid half(grid);
  const Vec3 h = grid.spacing();
  std::vector<CellLoops> cells, coarse;
  for_each_cell(grid, [&](int i, int j, int k) {
    if (!is_fine({grid.lower.x + (i + 0.5) * h.x, grid.lower.y + (j + 0.5) * h.y, grid.lower.z + (k + 0.5) * h.z}))
      return coarse.push_back(hexahedron(half.take(2 * i, 2 * j, 2 * k, 2)));
    for (int b = 0; b < 8; ++b) cells.push_back(hexahedron(half.take(2 * i + (b & 1), 2 * j + (b >> 1 & 1), 2 * k + (b >> 2), 1)));
  });
  for (const CellLoops& cell : coarse) cells.push_back(half.with_hanging(cell));
  return without_unused(half.all(), half.used(), std::move(cells));
}

PolyhedralMesh dual_polyhedra(const Grid& grid, double jitter, std::uint32_t seed) {
  std::vector<Vec3> points = grid_points(grid);
  const auto tets = kuhn(grid, points);
  jitter_points(points, grid, jitter, seed);
  return Dual(points, tets).mesh();
}

namespace {

CellLoops loops_of(const ShapedCell& cell) {
  if (cell.shape == CellShape::polyhedron) return cell.faces;
  CellLoops loops;
  for (const std::array<int, 4>& face : faces_of_shape(cell.shape)) {
    loops.emplace_back();
    for (const int i : face)
      if (i >= 0) loops.back().push_back(cell.corners[static_cast<std::size_t>(i)]);
  }
  return loops;
}

std::vector<std::uint32_t> distinct_points(const CellLoops& loops) {
  std::vector<std::uint32_t> points;
  for (const auto& loop : loops) points.insert(points.end(), loop.begin(), loop.end());
  std::sort(points.begin(), points.end());
  points.erase(std::unique(points.begin(), points.end()), points.end());
  return points;
}

// Boundary faces by patch, then by owner.
void sort_into_patches(PolyhedralMesh& mesh, std::vector<MeshPatch> patches, const std::function<std::size_t(const Vec3&)>& patch_of) {
  std::vector<std::tuple<std::size_t, std::uint32_t, std::size_t>> order;
  for (std::size_t f = mesh.internal_faces(); f < mesh.faces(); ++f) order.emplace_back(patch_of(face_middle(mesh, f)), mesh.owner[f], f);
  std::sort(order.begin(), order.end());
  const PolyhedralMesh old = mesh;
  mesh.face_start.resize(mesh.internal_faces() + 1);
  mesh.face_points.resize(mesh.face_start.back());
  mesh.owner.resize(mesh.internal_faces());
  for (MeshPatch& p : patches) p.faces = 0;
  for (const auto& [patch, owner, f] : order) {
    const auto face = old.face(f);
    mesh.face_points.insert(mesh.face_points.end(), face.begin(), face.end());
    mesh.face_start.push_back(mesh.face_points.size());
    mesh.owner.push_back(owner);
    ++patches[patch].faces;
  }
  auto next = static_cast<std::uint32_t>(mesh.internal_faces());
  for (MeshPatch& p : patches) p.first_face = std::exchange(next, next + p.faces);
  mesh.patches = std::move(patches);
}

}  // namespace

VolumeMesh volume_mesh_of(std::vector<Vec3> points, const std::vector<ShapedCell>& cells, std::vector<MeshPatch> patches, const std::function<std::size_t(const Vec3&)>& patch_of) {
  VolumeMesh result;
  std::vector<CellLoops> loops;
  result.first.push_back(0);
  for (const ShapedCell& cell : cells) {
    loops.push_back(loops_of(cell));
    const auto corners = cell.shape == CellShape::polyhedron ? distinct_points(loops.back()) : cell.corners;
    result.shape.push_back(cell.shape);
    result.corners.insert(result.corners.end(), corners.begin(), corners.end());
    result.first.push_back(result.corners.size());
  }
  result.mesh = mesh_of_cells(std::move(points), loops);
  sort_into_patches(result.mesh, std::move(patches), patch_of);
  return result;
}

VolumeMesh mixed_cells(bool with_polyhedron) {
  using enum CellShape;
  // Point (i, y, z) of the row's cross sections is 4 i + y + 2 z; then the middle of the third cube; then what is on top of the first.
  std::vector<Vec3> points;
  const int sections = with_polyhedron ? 5 : 4;
  for (int i = 0; i < sections; ++i)
    for (int b = 0; b < 4; ++b) points.push_back({double(i), double(b & 1), double(b >> 1)});
  const auto at = [](int i, int y, int z) { return static_cast<std::uint32_t>(4 * i + y + 2 * z); };
  const auto middle = static_cast<std::uint32_t>(points.size());
  points.push_back({2.5, 0.5, 0.5});
  for (int b = 0; b < 4; ++b) points.push_back({double(b & 1), double(b >> 1), 2});
  const auto top = [&](int x, int y) { return middle + 1 + static_cast<std::uint32_t>(x + 2 * y); };
  const auto cube = [&](int i) -> std::vector<std::uint32_t> {
    return {at(i, 0, 0), at(i + 1, 0, 0), at(i + 1, 1, 0), at(i, 1, 0), at(i, 0, 1), at(i + 1, 0, 1), at(i + 1, 1, 1), at(i, 1, 1)};
  };
  std::vector<ShapedCell> cells{{hexahedron, cube(0), {}}, {hexahedron, cube(1), {}}};
  const auto c = cube(2);
  for (const auto& face : faces_of_shape(hexahedron)) {
    const auto p = [&](int i) { return c[static_cast<std::size_t>(face[static_cast<std::size_t>(i)])]; };
    if (face == std::array<int, 4>{1, 2, 6, 5}) continue;  // towards the fourth cube
    cells.push_back({pyramid, {p(3), p(2), p(1), p(0), middle}, {}});
  }
  cells.push_back({tetrahedron, {c[6], c[2], c[1], middle}, {}});
  cells.push_back({tetrahedron, {c[5], c[6], c[1], middle}, {}});
  // Triangles across y, the first one's normal away from the other; the lower wedge stands on the cube's face.
  cells.push_back({wedge, {at(0, 0, 1), at(1, 0, 1), top(0, 0), at(0, 1, 1), at(1, 1, 1), top(0, 1)}, {}});
  cells.push_back({wedge, {at(1, 0, 1), top(1, 0), top(0, 0), at(1, 1, 1), top(1, 1), top(0, 1)}, {}});
  if (with_polyhedron) {
    CellLoops loops = loops_of({hexahedron, cube(3), {}});
    std::erase_if(loops, [&](const auto& loop) { return std::all_of(loop.begin(), loop.end(), [&](std::uint32_t p) { return p / 4 == 3; }); });
    loops.push_back({c[6], c[2], c[1]});
    loops.push_back({c[5], c[6], c[1]});
    for (auto it = loops.end() - 2; it != loops.end(); ++it) std::reverse(it->begin(), it->end());
    cells.push_back({polyhedron, {}, loops});
  }
  const double end = sections - 1;
  return volume_mesh_of(std::move(points), cells, {{"floor", "wall"}, {"xMin", "patch"}, {"xMax", "patch"}, {"rest", "wall"}}, [&](const Vec3& p) -> std::size_t {
    return p.z == 0 ? 0 : p.x == 0 ? 1 : p.x == end ? 2 : 3;
  });
}

VolumeMesh hexahedral_volume(const Grid& grid) {
  std::vector<ShapedCell> cells;
  for_each_cell(grid, [&](int i, int j, int k) {
    const auto c = corners_of(grid, i, j, k);
    cells.push_back({CellShape::hexahedron, {c[0], c[1], c[3], c[2], c[4], c[5], c[7], c[6]}, {}});
  });
  const Vec3 h = grid.spacing();
  return volume_mesh_of(grid_points(grid), cells, {{"xMin", "patch"}, {"xMax", "patch"}, {"walls", "wall"}}, [&](const Vec3& p) -> std::size_t {
    return p.x < grid.lower.x + h.x / 4 ? 0 : p.x > grid.upper.x - h.x / 4 ? 1 : 2;
  });
}

}  // namespace burnish::test
