// How large cells have to be for a mesh to have about so many.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "burnish/pipeline/flow_mesh_job.h"

namespace burnish {

// Of a mesh, for each of the surface's area in cells: a first guess, of the order of what models have inside.
inline constexpr double kCellsPerArea = 12;

// Proposes cells, and learns from what they gave. The number of cells of a graded mesh goes with the surface's area over the cell's, and a little faster: its exponent is
// taken from the last two trials.
class CellChooser {
 public:
  // `area` of the surface, in the cell's units.
  CellChooser(std::uint64_t wanted, double area) : wanted_(static_cast<double>(wanted)), area_(area) {}

  // The next cell to be tried, or none: the last one was near enough, or there were enough of them.
  std::optional<double> next() const;
  void learn(double cell, std::uint64_t cells) { trials_.push_back({cell, cells}); }
  const std::vector<MeshTrial>& trials() const { return trials_; }

 private:
  double cell_for(double cells) const;

  double wanted_, area_;
  std::vector<MeshTrial> trials_;
};

}  // namespace burnish
