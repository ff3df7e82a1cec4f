// Bad cells of a volume mesh, one after the other: one of a cell's points moves to where cells around it are less bad.
#pragma once

#include <cstdint>
#include <vector>

#include "burnish/core/progress.h"
#include "burnish/volume/mesh_quality.h"
#include "point_cells.h"

namespace burnish {

// Polyhedra with faces in one plane count as concave, wherever their points are: without these.
std::vector<BadCell> without_split_ones(const VolumeMesh& mesh, std::vector<BadCell> bad);

// [T-HEX-6] For a mesh whose points alone change; none by more than a fifth of the cells there, or of cells with side 2 `largest`. The same bits always: one thread.
class Mending {
 public:
  // All are kept by reference. `fixed`: per point, whether it has to stay.
  Mending(VolumeMesh& volume, const PointCells& around, const CellFaces& faces, const std::vector<std::uint8_t>& fixed, const MeshQualityLimits& limits, double largest, Progress& progress)
      : volume_(volume), around_(around), faces_(faces), fixed_(fixed), limits_(limits), largest_(largest), progress_(progress) {}

  // Moves points by up to a fifth of a cell, in at most `rounds` rounds; the cells that are bad in the end. 2 ms a bad tetrahedron in the first round, 20 ms later. Throws Error{interrupted}.
  std::vector<BadCell> mend(std::vector<BadCell> bad, int rounds);
  // How often a point has moved.
  std::uint64_t moves() const { return moves_; }

  // The bad cells once these points have moved: those of `bad` and of the cells concerned.
  std::vector<BadCell> judged_again(const std::vector<BadCell>& bad, const std::vector<std::uint32_t>& moved) const;

 private:
  std::vector<std::uint32_t> worst_first(const std::vector<BadCell>& bad) const;
  void mend_cell(std::uint32_t cell, std::size_t tried);
  bool mend_by(std::uint32_t point, std::size_t tried);
  double cell_at(std::uint32_t point) const;
  std::vector<Vec3> places_for(std::uint32_t point);
  double badness(const std::vector<std::uint32_t>& cells) const;
  std::vector<std::uint32_t> cells_concerned(const std::vector<std::uint32_t>& points) const;

  VolumeMesh& volume_;
  const PointCells& around_;
  const CellFaces& faces_;
  const std::vector<std::uint8_t>& fixed_;
  const MeshQualityLimits limits_;
  const double largest_;
  Progress& progress_;
  std::uint64_t moves_ = 0;
};

}  // namespace burnish
