#include "field_output.h"

#include <fmt/format.h>
#include <sys/stat.h>

#include "burnish/core/error.h"

namespace burnish {
namespace {

constexpr std::size_t kManyCells = 50'000'000;  // from here on, their number is said before they are written

}  // namespace

FieldOutput::FieldOutput(const std::string& path, bool overwrite) {
  told_.file = path;
  if (path.empty()) return;
  format_ = field_format_for_writing(path);
  told_.format = name(format_);
  file_.emplace(path, overwrite);
}

void FieldOutput::require_memory(std::size_t cells, std::uint64_t held, std::uint64_t budget, const std::string& hint) const {
  const std::uint64_t needed = held + bytes_to_write_field(cells, format_);
  if (needed <= budget) return;
  throw Error(ErrorCode::memory_limit,
              fmt::format("{}: writing {} cells takes about {:.1f} GB; the budget is {:.1f} GB", told_.file, cells,
                          static_cast<double>(needed) * 0x1p-30, static_cast<double>(budget) * 0x1p-30),
              hint);
}

std::string FieldOutput::stage(std::size_t cells) {
  return cells > kManyCells ? fmt::format("writing {} million cells", cells / 1'000'000) : "writing";
}

void FieldOutput::write(const CellGrid& grid, Progress& progress) {
  const WrittenField written = write_field(file_->fd(), file_->destination(), grid, format_, progress);
  struct stat status {};
  if (::fstat(file_->fd(), &status) == 0) told_.bytes = static_cast<std::uint64_t>(status.st_size);
  file_->commit();
  told_.written = true;
  told_.cell_count = written.cells;
  told_.point_count = written.points;
  told_.octant_count = written.octants;
}

}  // namespace burnish
