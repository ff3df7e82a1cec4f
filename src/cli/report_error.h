// How an error reaches the user.
#pragma once

#include <functional>
#include <string>

#include "burnish/core/error.h"

namespace burnish {

// `burnish: <what>` and, if there is one, `  hint: <hint>` on standard error.
void print_error(const Error& error) noexcept;

// `work()`, or what its exception comes to: it is printed, `json` becomes the error as JSON, and its exit code is returned. Out of memory is an error as
// well, and whatever else is thrown is a bug.
int guarded(const std::function<int()>& work, std::string& json);

}  // namespace burnish
