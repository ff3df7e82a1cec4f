#include <fmt/format.h>

#include "burnish/core/error.h"
#include "burnish/io/vdb.h"

namespace burnish {

bool has_openvdb() { return false; }

void require_openvdb(const std::string& path) {
  throw Error(ErrorCode::usage, fmt::format("{}: this build writes no .vdb: it was made without OpenVDB", path),
              "install libopenvdb-dev and configure with -DBURNISH_WITH_OPENVDB=ON, or write .vti, .nrrd, .vtu or .htg");
}

WrittenVdb write_vdb(int, const std::string& label, const VdbSource&, Progress&) {
  require_openvdb(label);
  return {};
}

}  // namespace burnish
