// The level set's octree as cells that a file can hold.
#pragma once

#include <optional>
#include <vector>

#include "burnish/io/field_files.h"
#include "burnish/pipeline/field.h"
#include "level_set_gear.h"

namespace burnish {

// Which cells and arrays there are, beside FieldCells.
struct CellChoice {
  std::vector<FieldArray> arrays;                // empty: all that there is something for
  bool at_points = true;
  const Field<std::uint8_t>* accepted = nullptr; // marks of cells, in phi's layout; null: there is no such array
  const Field<float>* curvature = nullptr;       // of cells, as curvature_of_cells has it; null: there is no such array
  std::optional<double> within;                  // finest cells: only cells whose centre is no farther from the surface
  std::optional<double> clamp;                   // finest cells: |phi| ends there
};

// The mean curvature at the centres of cells within a cell (of their level) of the surface, per finest cell; NaN at all others, and where
// there is none (levelset/curvature.h, second order). Only leaves near the surface store values. phi has to be a distance everywhere.
Field<float> curvature_of_cells(const LevelSet& set, Progress& progress);

// Cells and arrays as docs/formats.md describes them; computed when they are asked for, so the object holds 8 bytes a
// block (and 2 a cell, if only some are chosen) beside what it refers to, and everything it refers to must outlive it.
class OctreeCells {
 public:
  // `input_facet`: of the prepared soup's facets, the input's facet behind each; kNoFacet for caps.
  OctreeCells(const BuiltLevelSet& built, const std::vector<std::uint32_t>& input_facet, FieldCells cells, CellChoice choice = {});

  std::size_t count() const { return first_.back(); }
  CellGrid grid() const;

 private:
  bool is_cut(std::size_t leaf) const;
  LatticeCube cube_of(std::size_t leaf, std::uint32_t place) const;
  void count_all();
  void choose_within(double distance);
  void fill_cubes(std::size_t first, std::span<LatticeCube> cubes) const;
  // Calls `value(leaf, cube)` for each cube, with the leaf that holds it or, for cubes larger than leaves, Octree::kNone.
  template <class Value>
  void fill(std::span<const LatticeCube> cubes, double* values, Value&& value) const;

  bool wants(FieldArray array) const;
  double told(double phi) const;  // in model units
  double phi_at(const LatticeCube& cube, std::uint32_t leaf) const;
  double facet_of(const LatticeCube& cube, std::uint32_t leaf) const;
  double curvature_at(const LatticeCube& cube, std::uint32_t leaf) const;
  double confidence_at(const LatticeCube& cube, std::uint32_t leaf) const;
  double is_accepted(const LatticeCube& cube, std::uint32_t leaf) const;
  // The place in its leaf of a cell, or of the cell in the middle of a whole block.
  std::size_t place_of(const LatticeCube& cube, std::uint32_t leaf) const;

  const BuiltLevelSet& built_;
  const Octree& tree_;
  const std::vector<std::uint32_t>& input_facet_;
  FieldCells cells_;
  CellChoice choice_;
  std::vector<std::uint64_t> first_;   // number of each leaf's first cell, and the count
  std::vector<std::uint16_t> places_;  // of the cells that were chosen, in their leaves' Morton order; empty: all are
};

}  // namespace burnish
