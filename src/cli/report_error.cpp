#include "report_error.h"

#include <fmt/format.h>

#include <new>

#include "burnish/pipeline/report.h"
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

namespace {

int fail(const Error& error, std::string& json) {
  if (error.code() == ErrorCode::bug && error.hint().empty())
    return fail({ErrorCode::bug, error.what(), "this is a bug of Burnish: please report it with the command and the input file"}, json);
  print_error(error);
  json = to_json(error);
  return exit_code(error.code());
}

}  // namespace

int guarded(const std::function<int()>& work, std::string& json) try {
  return work();
} catch (const Error& error) {
  return fail(error, json);
} catch (const std::bad_alloc&) {
  return fail({ErrorCode::memory_limit, "out of memory", "ask for less, such as larger cells (--cell), or free some memory"}, json);
} catch (const std::exception& error) {
  return fail({ErrorCode::bug, fmt::format("internal error: {}", error.what())}, json);
}

}  // namespace burnish
