// How a command ends: what came of the run, then why there is no more.
#pragma once

#include <optional>

#include "burnish/core/error.h"
#include "console.h"
#include "report_error.h"
#include "streams.h"

namespace burnish {

// Warnings; then the result as JSON, or, unless the command is to be quiet or there is nothing to sum up, `summary()`.
template <class Result, class Summary>
void tell(const Result& result, bool json, bool quiet, Console& console, bool has_summary, Summary&& summary) {
  console.end_stage();
  console.warn(result.input, result.warnings);
  if (json)
    write_stdout(to_json(result));
  else if (!quiet && has_summary)
    write_stdout(summary());
}

// Prints the failure, if there is one. Returns its exit code, or 0.
inline int end_with(const std::optional<Error>& failure) {
  if (!failure) return 0;
  print_error(*failure);
  return exit_code(failure->code());
}

}  // namespace burnish
