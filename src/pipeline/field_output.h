// Writing a field to the file that was asked for, and telling what came of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "burnish/core/progress.h"
#include "burnish/io/field_files.h"
#include "burnish/io/output_file.h"
#include "burnish/pipeline/field.h"
#include "field_samples.h"

namespace burnish {

// Nodes of a uniform grid, in model units.
struct SampleGrid {
  std::array<std::uint32_t, 3> nodes{};
  Vec3 origin;
  double spacing = 1;
};

// The grid that `content` asks for, of a model with this box and a level set with this finest cell. It begins at the box' lower corner and ends less than a
// spacing beyond the upper one. Throws Error{usage} for a spacing that is none, Error{memory_limit} beyond 2^33 nodes.
SampleGrid sample_grid(const FieldContent& content, const Box3& model, double cell);

class FieldOutput {
 public:
  // Without a `path` there is none. Creates the file before the work: one that cannot be written is to be known before it, not after.
  FieldOutput(const std::string& path, bool overwrite);

  bool is_wanted() const { return file_.has_value(); }
  FieldFormat format() const { return format_; }

  // Throws Error{memory_limit} with the hint if writing so many cells beside `held` bytes takes more than the budget.
  void require_memory(std::size_t cells, std::uint64_t held, std::uint64_t budget, const std::string& hint) const;
  // The same of samples, of which a layer at least is held at once.
  void require_memory(const SampleGrid& grid, std::uint64_t held, std::uint64_t budget) const;
  // "writing", with the number of cells, or of samples, if they are many.
  static std::string stage(std::size_t count, const char* what = "cells");

  // Each writes and commits. A .vtu or .htg:
  void write(const CellGrid& grid, Progress& progress);
  // A .vti or .nrrd; |phi| ends at `clamp` finest cells, if that is set.
  void write(const SampleGrid& grid, const FieldSamples& samples, const GridFrame& frame, const std::optional<double>& clamp, Progress& progress);
  // A .vdb: voxels are the finest cells, index points the lattice's nodes, `half_width` the band's half width in voxels. [T-EXPORT-3]
  // Throws Error{memory_limit} if that takes, beside `held` bytes, more than the budget.
  void write(const LevelSet& set, const FieldSamples& samples, double half_width, std::uint64_t held, std::uint64_t budget, Progress& progress);

  // file, format, and once it is written the rest; `cells` is the caller's.
  const FieldFile& told() const { return told_; }

 private:
  void commit();
  // Throws if `needed` bytes are more than the budget.
  void refuse_beyond(std::uint64_t budget, std::uint64_t needed, const std::string& what, const std::string& hint) const;

  FieldFormat format_ = FieldFormat::vtu;
  FieldFile told_;
  std::optional<OutputFile> file_;
};

}  // namespace burnish
