// What this library was built from and with: the same for every build of the same sources with the same tools (no time, no path).
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace burnish {

struct BuildInfo {
  // A library that was built in, or could have been.
  struct Dependency {
    std::string_view name;     // "CGAL"
    std::string_view version;  // "5.5.1"; empty: built without it
    bool has_it() const { return !version.empty(); }
  };

  std::string_view version;     // "0.1.0": semantic versioning
  std::string_view date;        // on which the version got its number, "2026-11-22"; not that of the build
  std::string_view commit;      // of git, with "-dirty" when files were changed since; empty: unknown
  std::string_view compiler;    // "GNU 12.2.0"
  std::string_view build_type;  // "Release"; may be empty
  std::string_view parallel;    // backend of core/parallel: "tbb" or "threads"
  std::string_view licence;     // SPDX: of the library together with what it is linked to
  std::vector<Dependency> dependencies;  // those that are always there, then the optional ones
};

// Never throws; the texts live as long as the program.
const BuildInfo& build_info();

// A line each, the first "burnish X.Y.Z", the others "name   value" in one column.
std::string to_text(const BuildInfo& info);
// One JSON object: version, commit (or null), compiler, build_type, parallel, licence, dependencies {name: version, or null}.
std::string to_json(const BuildInfo& info);

}  // namespace burnish
