#include "burnish/core/error.h"
#include "burnish/io/volume_files.h"

namespace burnish {

bool has_cgns() { return false; }

void require_cgns(const std::string& path) {
  throw Error(ErrorCode::usage, path + ": this build writes no .cgns: it was made without the CGNS library", "install libcgns-dev and configure with -DBURNISH_WITH_CGNS=ON, or write .vtu, .msh or .su2");
}

void write_cgns(const std::string& path, const VolumeMesh&, const VolumeWriteOptions&, Progress&) { require_cgns(path); }

}  // namespace burnish
