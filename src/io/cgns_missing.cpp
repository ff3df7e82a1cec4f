#include "burnish/core/error.h"
#include "burnish/io/volume_files.h"

namespace burnish {

bool has_cgns() { return false; }

void write_cgns(const std::string& path, const VolumeMesh&, const VolumeWriteOptions&, Progress&) {
  throw Error(ErrorCode::usage, path + ": this build writes no .cgns: it was made without the CGNS library", "install libcgns-dev and configure with -DBURNISH_WITH_CGNS=ON, or write .vtu, .msh or .su2");
}

}  // namespace burnish
