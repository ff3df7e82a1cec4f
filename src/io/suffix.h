// What a name says about a file's format.
#pragma once

#include <string>

namespace burnish {

// The end of a path from the last dot of its last part on, in lower case, such as ".stl"; empty without a
// dot.
std::string suffix_of(const std::string& path);

}  // namespace burnish
