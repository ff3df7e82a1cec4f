#include "assemble.h"

#include <algorithm>
#include <array>
#include <compare>
#include <utility>

#include "burnish/core/error.h"
#include "burnish/core/parallel.h"
#include "burnish/core/scramble.h"
#include "burnish/core/union_find.h"
#include "numbering.h"

namespace burnish {
namespace {

constexpr std::uint32_t kUnused = 0xffffffffu;

// A face as one cell has it: its points lie one after the other in `loops`, the normal outwards.
struct HalfFace {
  std::uint32_t cell, other;  // other: the cell across, or kUnused
  std::uint64_t first;
  std::uint32_t size;
};

class Assembly {
 public:
  explicit Assembly(const CellList& cells) : cells_(cells) {}

  VolumeMesh run(const std::vector<Vec3>& points, std::vector<std::uint32_t>* source) {
    require_numbers(points.size(), "points");
    require_numbers(count_half_faces(cells_), "faces of cells");
    number_points(points, source);
    list_half_faces();
    match();
    write_faces();
    return std::move(result_);
  }

 private:
  // Calls visit(position in corners) for every point that a cell names.
  template <class Visit>
  void visit_points(std::size_t cell, Visit&& visit) const {
    const std::uint64_t begin = cells_.first[cell], end = cells_.first[cell + 1];
    if (cells_.shape[cell] != CellShape::polyhedron) {
      for (std::uint64_t i = begin; i < end; ++i) visit(i);
      return;
    }
    for (std::uint64_t i = begin + 1; i < end; i += cells_.corners[i] + 1)
      for (std::uint64_t k = i + 1; k <= i + cells_.corners[i]; ++k) visit(k);
  }

  void number_points(const std::vector<Vec3>& points, std::vector<std::uint32_t>* source) {
    number_.assign(points.size(), kUnused);
    std::vector<std::uint32_t> order;
    for (std::size_t c = 0; c < cells_.size(); ++c)
      visit_points(c, [&](std::uint64_t i) {
        std::uint32_t& n = number_[cells_.corners[i]];
        if (n != kUnused) return;
        n = static_cast<std::uint32_t>(order.size());
        order.push_back(cells_.corners[i]);
      });
    result_.mesh.points.resize(order.size());
    for (std::size_t i = 0; i < order.size(); ++i) result_.mesh.points[i] = points[order[i]];
    if (source != nullptr) *source = std::move(order);
  }

  void list_half_faces() {
    result_.shape = cells_.shape;
    result_.first.reserve(cells_.size() + 1);
    result_.first.push_back(0);
    for (std::uint32_t c = 0; c < cells_.size(); ++c) {
      const std::size_t begin = result_.corners.size();
      visit_points(c, [&](std::uint64_t i) { result_.corners.push_back(number_[cells_.corners[i]]); });
      if (cells_.shape[c] == CellShape::polyhedron) {
        list_polyhedron(c);
        const auto from = result_.corners.begin() + static_cast<std::ptrdiff_t>(begin);
        std::sort(from, result_.corners.end());
        result_.corners.erase(std::unique(from, result_.corners.end()), result_.corners.end());
      } else {
        for (const std::array<int, 4>& f : faces_of_shape(cells_.shape[c])) {
          half_.push_back({c, kUnused, loops_.size(), f[3] < 0 ? 3u : 4u});
          for (const int i : f)
            if (i >= 0) loops_.push_back(result_.corners[begin + static_cast<std::size_t>(i)]);
        }
      }
      result_.first.push_back(result_.corners.size());
    }
  }

  void list_polyhedron(std::uint32_t c) {
    for (std::uint64_t i = cells_.first[c] + 1; i < cells_.first[c + 1]; i += cells_.corners[i] + 1) {
      half_.push_back({c, kUnused, loops_.size(), cells_.corners[i]});
      for (std::uint64_t k = i + 1; k <= i + cells_.corners[i]; ++k) loops_.push_back(number_[cells_.corners[k]]);
    }
  }

  std::span<const std::uint32_t> loop(const HalfFace& h) const { return {loops_.data() + h.first, h.size}; }

  // What both cells call a face by: its two lowest points, how many there are, and a sum that tells others apart. (Polygons with points in the middle of edges may have three points in common.)
  struct Name {
    std::uint32_t low, next, size;
    std::uint64_t sum;
    auto operator<=>(const Name&) const = default;
  };
  Name name(const HalfFace& h) const {
    Name n{kUnused, kUnused, h.size, 0};
    for (std::uint32_t p : loop(h)) {
      n.sum += scramble(p + kScrambleStep);
      if (p < n.low) std::swap(p, n.low);
      if (p < n.next) n.next = p;
    }
    return n;
  }

  void match() {
    // By the lowest point first, so that what is left to sort is small.
    std::vector<std::uint64_t> start(result_.mesh.points.size() + 1, 0);
    std::vector<std::uint32_t> low(half_.size());
    parallel_for(half_.size(), [&](std::size_t h) { low[h] = name(half_[h]).low; });
    for (const std::uint32_t p : low) ++start[p + 1];
    for (std::size_t p = 1; p < start.size(); ++p) start[p] += start[p - 1];
    std::vector<std::uint32_t> at(half_.size());
    {
      std::vector<std::uint64_t> next(start.begin(), start.end() - 1);
      for (std::uint32_t h = 0; h < half_.size(); ++h) at[next[low[h]]++] = h;
    }
    parallel_for(start.size() - 1, [&](std::size_t p) { match_at(at.data() + start[p], at.data() + start[p + 1]); });
  }

  void match_at(std::uint32_t* begin, std::uint32_t* end) {
    std::vector<std::pair<Name, std::uint32_t>> here;
    for (; begin != end; ++begin) here.emplace_back(name(half_[*begin]), *begin);
    std::sort(here.begin(), here.end());
    for (std::size_t i = 0; i < here.size();) {
      std::size_t j = i + 1;
      while (j < here.size() && here[j].first == here[i].first) ++j;
      if (j - i > 2) throw Error(ErrorCode::bug, "a face of the volume mesh has more than two cells", "this is a bug of Burnish: please report it with the command and the input file");
      if (j - i == 2) {
        HalfFace &a = half_[here[i].second], &b = half_[here[i + 1].second];
        a.other = b.cell, b.other = a.cell;
      }
      i = j;
    }
  }

  // [T-FOAM-1]
  void write_faces() {
    PolyhedralMesh& mesh = result_.mesh;
    mesh.cells = static_cast<std::uint32_t>(cells_.size());
    mesh.face_start.push_back(0);
    std::vector<std::uint32_t> up;
    for (std::size_t h = 0; h < half_.size();) {
      const std::uint32_t cell = half_[h].cell;
      up.clear();
      for (; h < half_.size() && half_[h].cell == cell; ++h)
        if (half_[h].other != kUnused && half_[h].other > cell) up.push_back(static_cast<std::uint32_t>(h));
      std::sort(up.begin(), up.end(), [&](std::uint32_t a, std::uint32_t b) { return half_[a].other < half_[b].other; });
      for (const std::uint32_t f : up) write_face(half_[f]);
    }
    const auto internal = static_cast<std::uint32_t>(mesh.neighbour.size());
    for (const HalfFace& h : half_)
      if (h.other == kUnused) write_face(h);
    mesh.patches = {{"", "patch", internal, static_cast<std::uint32_t>(mesh.owner.size()) - internal}};
  }

  void write_face(const HalfFace& h) {
    PolyhedralMesh& mesh = result_.mesh;
    const auto points = loop(h);
    mesh.face_points.insert(mesh.face_points.end(), points.begin(), points.end());
    mesh.face_start.push_back(mesh.face_points.size());
    mesh.owner.push_back(h.cell);
    if (h.other != kUnused) mesh.neighbour.push_back(h.other);
  }

  const CellList& cells_;
  std::vector<std::uint32_t> number_;
  std::vector<HalfFace> half_;
  std::vector<std::uint32_t> loops_;
  VolumeMesh result_;
};

}  // namespace

std::uint64_t count_half_faces(const CellList& cells) {
  std::uint64_t count = 0;
  for (std::size_t c = 0; c < cells.size(); ++c) count += cells.shape[c] == CellShape::polyhedron ? cells.corners[cells.first[c]] : faces_of_shape(cells.shape[c]).size();
  return count;
}

VolumeMesh assemble(const std::vector<Vec3>& points, const CellList& cells, std::vector<std::uint32_t>* source) { return Assembly(cells).run(points, source); }

std::vector<std::uint8_t> points_at_end(const PolyhedralMesh& mesh, const std::vector<std::uint8_t>& on_wall) {
  std::vector<std::uint8_t> at_end(mesh.points.size(), 0);
  for (std::size_t i = 0; i < on_wall.size(); ++i)
    if (!on_wall[i])
      for (const std::uint32_t p : mesh.face(mesh.internal_faces() + i)) at_end[p] = 1;
  return at_end;
}

void sort_into_patches(VolumeMesh& volume, std::vector<MeshPatch> patches, const std::vector<std::uint32_t>& patch_of) {
  PolyhedralMesh& mesh = volume.mesh;
  const std::size_t internal = mesh.internal_faces(), boundary = mesh.faces() - internal;
  std::vector<std::uint32_t> order(boundary);
  for (std::uint32_t i = 0; i < boundary; ++i) order[i] = i;
  std::stable_sort(order.begin(), order.end(), [&](std::uint32_t a, std::uint32_t b) { return patch_of[a] < patch_of[b]; });
  std::vector<std::uint32_t> points, owners;
  std::vector<std::uint64_t> starts;
  for (MeshPatch& p : patches) p.faces = 0;
  for (const std::uint32_t i : order) {
    const auto face = mesh.face(internal + i);
    points.insert(points.end(), face.begin(), face.end());
    starts.push_back(mesh.face_start[internal] + points.size());
    owners.push_back(mesh.owner[internal + i]);
    ++patches[patch_of[i]].faces;
  }
  std::copy(points.begin(), points.end(), mesh.face_points.begin() + static_cast<std::ptrdiff_t>(mesh.face_start[internal]));
  std::copy(starts.begin(), starts.end(), mesh.face_start.begin() + static_cast<std::ptrdiff_t>(internal) + 1);
  std::copy(owners.begin(), owners.end(), mesh.owner.begin() + static_cast<std::ptrdiff_t>(internal));
  auto next = static_cast<std::uint32_t>(internal);
  for (MeshPatch& p : patches) p.first_face = next, next += p.faces;
  mesh.patches = std::move(patches);
}

std::uint32_t connected_parts(const PolyhedralMesh& mesh, std::vector<std::uint32_t>& part) {
  UnionFind sets(mesh.cells);
  for (std::size_t f = 0; f < mesh.internal_faces(); ++f) sets.unite(mesh.owner[f], mesh.neighbour[f]);
  part.assign(mesh.cells, kUnused);
  std::uint32_t parts = 0;
  for (std::uint32_t c = 0; c < mesh.cells; ++c) {
    std::uint32_t& of_root = part[sets.find(c)];
    if (of_root == kUnused) of_root = parts++;
    part[c] = of_root;
  }
  return parts;
}

CellList kept_cells(const CellList& cells, const std::vector<std::uint8_t>& keep) {
  CellList result;
  for (std::size_t c = 0; c < cells.size(); ++c) {
    if (!keep[c]) continue;
    result.shape.push_back(cells.shape[c]);
    result.corners.insert(result.corners.end(), cells.corners.begin() + static_cast<std::ptrdiff_t>(cells.first[c]), cells.corners.begin() + static_cast<std::ptrdiff_t>(cells.first[c + 1]));
    result.first.push_back(result.corners.size());
  }
  return result;
}

}  // namespace burnish
