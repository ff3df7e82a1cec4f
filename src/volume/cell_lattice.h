// The lattice that a volume mesh is made of: cells of an octree, their nodes, and the faces between them.
//
// **Units.** A cell of level l is a cube of side 2^(l + 1) lattice units of a level set whose finest cells are half as large as the mesh's: so corners and
// centres of all cells are nodes of the level set. Corner c of a cell is at bits x = c & 1, y = c >> 1 & 1, z = c >> 2. Face f = 2 axis + side.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/levelset/level_set.h"
#include "burnish/octree/octree.h"
#include "burnish/volume/flow_mesh.h"
#include "mesh_refinement.h"

namespace burnish {

inline constexpr std::uint32_t kNoNode = 0xffffffffu;

// The corners of a face, anticlockwise seen from outside.
inline constexpr std::array<std::array<int, 4>, 6> kFaceCorners{{{0, 4, 6, 2}, {1, 3, 7, 5}, {0, 1, 5, 4}, {2, 6, 7, 3}, {0, 2, 3, 1}, {4, 5, 7, 6}}};

// A face's points: corners and the middles of edges that are divided, anticlockwise seen from outside. At most 8.
struct FacePolygon {
  std::array<std::uint32_t, 8> node{};
  int size = 0;
  bool is_quad() const { return size == 4; }
};

class CellLattice {
 public:
  // Cells of level `surface_level` wherever the surface passes, larger where it is flat and away from it, smaller in refinements, as the options say; `options.cell` is the side of such cells.
  // `region`: what of the lattice is wanted. The level set's leaves at the surface are of level `surface_level` or below, and as fine as `level_set_boxes` says. Throws Error:
  // memory_limit for more cells than 32 bits count, interrupted.
  CellLattice(const LevelSet& set, const FlowMeshOptions& options, std::span<const LatticeRefinement> refinements, int surface_level, const LatticeBox& region, Progress& progress);

  const Octree& tree() const { return tree_; }
  std::size_t cells() const { return tree_.size(); }
  bool exists(std::size_t cell) const { return exists_[cell] != 0; }
  // Of the cell that holds a point of the lattice, in its units.
  int level_at(const Vec3& p) const;

  // Nodes: corners first, then the centre of cell c at centre(c).
  std::size_t nodes() const { return keys_.size() + tree_.size(); }
  std::uint32_t centre(std::size_t cell) const { return static_cast<std::uint32_t>(keys_.size() + cell); }
  std::uint32_t corner(std::size_t cell, int c) const { return corners_[cell * 8 + static_cast<std::size_t>(c)]; }
  bool is_centre(std::uint32_t node) const { return node >= keys_.size(); }
  // In lattice units.
  std::array<std::int64_t, 3> position(std::uint32_t node) const;

  // Whether a node stands in the middle of one of its edges, or of one of its faces.
  bool hangs(std::size_t cell) const { return split_edges_[cell] != 0 || split_faces_[cell] != 0; }
  bool is_split(std::size_t cell, int face) const { return split_faces_[cell] >> face & 1; }
  FacePolygon polygon(std::size_t cell, int face) const;

  // The cell across a face that is not split: of the same level or the next; Octree::kNone at the end of what exists.
  std::uint32_t across(std::size_t cell, int face) const;
  // The cells across a face that is split.
  std::span<const std::uint32_t> finer_across(std::size_t cell, int face) const;
  // Whether the face is told from this cell: each face once, from the finer side, or the lower one.
  bool owns(std::size_t cell, int face) const;

 private:
  void choose_cells(const LevelSet& set, const FlowMeshOptions& options, std::span<const LatticeRefinement> refinements, int surface_level, const LatticeBox& region, Progress& progress);
  void mark_existing(const LatticeBox& region);
  void number_nodes();
  void mark_splits();
  std::uint32_t find(std::uint64_t key) const;

  Octree tree_;
  std::vector<std::uint8_t> exists_;
  std::vector<std::uint64_t> keys_;       // of corners, ascending
  std::vector<std::uint32_t> corners_;    // 8 a cell
  std::vector<std::uint16_t> split_edges_;
  std::vector<std::uint8_t> split_faces_;
};

}  // namespace burnish
