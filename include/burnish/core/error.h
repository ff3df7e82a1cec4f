// Errors: one type, one table from cause to exit code.
//
// Library code throws `Error`; only `main` catches it. `assert` is for Burnish's own bugs and is
// never reached by input, however broken.
#pragma once

#include <stdexcept>
#include <string>
#include <string_view>

namespace burnish {

// Why a run could not deliver. The order is that of the table in error.cpp.
enum class ErrorCode {
  answer_is_no,        // `check` found defects, `compare` exceeded its limit
  usage,               // the command line or an option's value is wrong
  unreadable_input,    // the input is missing, broken, or holds no facets
  unwritable_output,   // the output exists, or cannot be written
  guarantee_unmet,     // the result could not be verified, or the input bounds no solid
  memory_limit,        // the memory budget does not allow the resolution asked for
  time_limit,          // the run took longer than it may
  bug,                 // a broken invariant of Burnish itself
  interrupted,         // Ctrl-C
};

// The process exit code of an error: 1, 2, 3, 4, 5, 6, 7, 70 or 130 in the order above; 0 is success.
int exit_code(ErrorCode code);
// The name of an error as it stands in JSON reports, e.g. "unreadable_input".
std::string_view name(ErrorCode code);

// What went wrong, and the way out.
//
// `what()` names the file, the place in it, what was expected and what was found, without a final
// period or newline. `hint()` is one sentence on what the user can do, or empty.
class Error : public std::runtime_error {
 public:
  Error(ErrorCode code, const std::string& message, std::string hint = {})
      : std::runtime_error(message), code_(code), hint_(std::move(hint)) {}

  ErrorCode code() const { return code_; }
  const std::string& hint() const { return hint_; }

 private:
  ErrorCode code_;
  std::string hint_;
};

}  // namespace burnish
