// The level set's octree as cells that a file can hold.
#pragma once

#include <vector>

#include "burnish/io/field_files.h"
#include "burnish/pipeline/field.h"
#include "level_set_gear.h"

namespace burnish {

// Cells and arrays as docs/formats.md describes them; computed when they are asked for, so the object holds 8 bytes a
// block beside what it refers to, and everything it refers to must outlive it.
class OctreeCells {
 public:
  // `input_facet`: of the prepared soup's facets, the input's facet behind each; kNoFacet for caps.
  // `accepted`: marks of cells, in phi's layout; null: there is no such array.
  OctreeCells(const BuiltLevelSet& built, const std::vector<std::uint32_t>& input_facet, FieldCells cells, const Field<std::uint8_t>* accepted = nullptr);

  std::size_t count() const { return first_.back(); }
  CellGrid grid() const;

 private:
  void fill_cubes(std::size_t first, std::span<LatticeCube> cubes) const;
  // Calls `value(leaf, cube)` for each cube, with the leaf that holds it or, for cubes larger than leaves, Octree::kNone.
  template <class Value>
  void fill(std::span<const LatticeCube> cubes, double* values, Value&& value) const;

  double phi_at(const LatticeCube& cube, std::uint32_t leaf) const;
  double facet_of(const LatticeCube& cube, std::uint32_t leaf) const;
  double is_accepted(const LatticeCube& cube, std::uint32_t leaf) const;
  // The place in its leaf of a cell, or of the cell in the middle of a whole block.
  std::size_t place_of(const LatticeCube& cube, std::uint32_t leaf) const;

  const BuiltLevelSet& built_;
  const Octree& tree_;
  const std::vector<std::uint32_t>& input_facet_;
  const Field<std::uint8_t>* accepted_;
  std::vector<std::uint64_t> first_;  // number of each leaf's first cell, and the count
};

}  // namespace burnish
