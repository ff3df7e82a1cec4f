// The files of src/html and third_party/three, in the library's own bytes.
#pragma once

#include <string_view>

namespace burnish {

// The file of that name, e.g. "style.css"; empty if there is none.
std::string_view html_asset(std::string_view name);

}  // namespace burnish
