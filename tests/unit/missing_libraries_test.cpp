// What stands in for libraries that a build has not: compiled here under other names, beside the real ones.
#include <fmt/format.h>
#include <gtest/gtest.h>

#include <string>

#include "burnish/core/error.h"
#include "burnish/io/vdb.h"
#include "burnish/io/volume_files.h"
#include "io/readers.h"
#include "io/threemf.h"
#include "io/zip_archive.h"

#define has_cgns has_no_cgns
#define require_cgns require_missing_cgns
#define write_cgns write_missing_cgns
#include "io/cgns_missing.cpp"
#define has_openvdb has_no_openvdb
#define require_openvdb require_missing_openvdb
#define write_vdb write_missing_vdb
#include "io/vdb_missing.cpp"
#define require_3mf require_missing_3mf
#define read_3mf read_missing_3mf
#include "io/threemf_missing.cpp"

namespace burnish {
namespace {

template <class Act>
void expect_refusal(ErrorCode code, const std::string& message, const std::string& package, Act&& act) {
  try {
    act();
    ADD_FAILURE() << "no error: " << message;
  } catch (const Error& error) {
    EXPECT_EQ(std::string(error.what()), message);
    EXPECT_EQ(error.code(), code);
    EXPECT_NE(error.hint().find("install " + package), std::string::npos) << error.hint();
  }
}

TEST(MissingLibraries, AreToldWithTheirPackages) {
  EXPECT_FALSE(has_no_cgns());
  EXPECT_FALSE(has_no_openvdb());
  expect_refusal(ErrorCode::usage, "m.cgns: this build writes no .cgns: it was made without the CGNS library", "libcgns-dev", [] { write_missing_cgns("m.cgns", {}, {}, no_progress()); });
  expect_refusal(ErrorCode::usage, "f.vdb: this build writes no .vdb: it was made without OpenVDB", "libopenvdb-dev", [] { write_missing_vdb(-1, "f.vdb", {}, no_progress()); });
  expect_refusal(ErrorCode::unwritable_output, "m.3mf: this build reads and writes no .3mf: it was made without lib3mf", "lib3mf-dev",
                 [] { require_missing_3mf("m.3mf", ErrorCode::unwritable_output); });
}

}  // namespace
}  // namespace burnish
