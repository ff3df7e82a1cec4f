#include "report_error.h"

#include "streams.h"

namespace burnish {

void print_error(const Error& error) noexcept {
  // Piecewise, because out of memory is one of the errors that end here.
  write_stderr("burnish: ");
  write_stderr(error.what());
  write_stderr("\n");
  if (error.hint().empty()) return;
  write_stderr("  hint: ");
  write_stderr(error.hint());
  write_stderr("\n");
}

}  // namespace burnish
