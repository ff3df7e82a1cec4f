#include "readers.h"
#include "threemf.h"
#include "zip_archive.h"

namespace burnish {

void require_3mf(const std::string& path, ErrorCode code) {
  throw Error(code, path + ": this build reads and writes no .3mf: it was made without lib3mf", "install lib3mf-dev and configure with -DBURNISH_WITH_3MF=ON, or use .stl, .ply or .obj");
}

MeshFile read_3mf(const Source& source) {
  static_cast<void>(zip_entries(source));
  require_3mf(source.label, ErrorCode::unreadable_input);
  return {};
}

}  // namespace burnish
