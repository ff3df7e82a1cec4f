// Writing cells to the file that was asked for, and telling what came of it.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include "burnish/core/progress.h"
#include "burnish/io/field_files.h"
#include "burnish/io/output_file.h"
#include "burnish/pipeline/field.h"

namespace burnish {

class FieldOutput {
 public:
  // Without a `path` there is none. Creates the file before the work: one that cannot be written is to be known before it, not after.
  FieldOutput(const std::string& path, bool overwrite);

  bool is_wanted() const { return file_.has_value(); }
  FieldFormat format() const { return format_; }

  // Throws Error{memory_limit} with the hint if writing so many cells beside `held` bytes takes more than the budget.
  void require_memory(std::size_t cells, std::uint64_t held, std::uint64_t budget, const std::string& hint) const;
  // "writing", with the number of cells if they are many.
  static std::string stage(std::size_t cells);
  // Writes and commits.
  void write(const CellGrid& grid, Progress& progress);

  // file, format, and once it is written the rest; `cells` is the caller's.
  const FieldFile& told() const { return told_; }

 private:
  FieldFormat format_ = FieldFormat::vtu;
  FieldFile told_;
  std::optional<OutputFile> file_;
};

}  // namespace burnish
