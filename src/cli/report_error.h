// How an error reaches the user.
#pragma once

#include "burnish/core/error.h"

namespace burnish {

// `burnish: <what>` and, if there is one, `  hint: <hint>` on standard error.
void print_error(const Error& error) noexcept;

}  // namespace burnish
