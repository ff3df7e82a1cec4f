# Writes a C++ source that holds files as arrays of bytes:
#   cmake -DOUTPUT=assets.cpp "-DFILES=a.css;b.js" -P EmbedFiles.cmake
# defines `std::string_view burnish::html_asset(std::string_view name)` (src/pipeline/html_assets.h).
set(arrays "")
set(rows "")
set(number 0)
foreach(file IN LISTS FILES)
  get_filename_component(name "${file}" NAME)
  file(READ "${file}" bytes HEX)
  string(REGEX REPLACE "(..)" "0x\\1," bytes "${bytes}")
  string(APPEND arrays "constexpr unsigned char kFile${number}[] = {${bytes}0};\n")
  string(APPEND rows "  if (name == \"${name}\") return {reinterpret_cast<const char*>(kFile${number}), sizeof kFile${number} - 1};\n")
  math(EXPR number "${number} + 1")
endforeach()
file(WRITE "${OUTPUT}" "// Made by cmake/EmbedFiles.cmake.
#include \"html_assets.h\"

namespace burnish {
namespace {
${arrays}}  // namespace

std::string_view html_asset(std::string_view name) {
${rows}  return {};
}

}  // namespace burnish
")
