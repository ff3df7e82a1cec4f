#include "burnish/core/build_info.h"

#include <fmt/format.h>

#include "build_commit.h"  // both written by cmake/BurnishBuildInfo.cmake
#include "build_facts.h"

namespace burnish {
namespace {

std::string quoted(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string quoted_or_null(std::string_view text) { return text.empty() ? "null" : quoted(text); }

}  // namespace

const BuildInfo& build_info() {
  static const BuildInfo info{kVersion, kVersionDate, kCommit, kCompiler, kBuildType, kParallel, "GPL-3.0-or-later", {BURNISH_DEPENDENCY_ROWS}};
  return info;
}

std::string to_text(const BuildInfo& info) {
  std::string text = fmt::format("burnish {}\n", info.version);
  const auto add = [&](std::string_view name, std::string_view value) { text += fmt::format("{:<14}{}\n", name, value); };
  add("commit", info.commit.empty() ? "unknown" : info.commit);
  add("compiler", info.compiler);
  add("build type", info.build_type.empty() ? "none" : info.build_type);
  add("parallel", info.parallel);
  for (const BuildInfo::Dependency& d : info.dependencies) add(d.name, d.has_it() ? d.version : "no");
  add("licence", info.licence);
  return text;
}

std::string to_json(const BuildInfo& info) {
  std::string rows;
  for (const BuildInfo::Dependency& d : info.dependencies) rows += fmt::format("{}\n    {}: {}", rows.empty() ? "" : ",", quoted(d.name), quoted_or_null(d.version));
  return fmt::format(
      "{{\n  \"version\": {},\n  \"commit\": {},\n  \"compiler\": {},\n  \"build_type\": {},\n  \"parallel\": {},\n  \"licence\": {},\n  \"dependencies\": {{{}\n  }}\n}}\n",
      quoted(info.version), quoted_or_null(info.commit), quoted(info.compiler), quoted(info.build_type), quoted(info.parallel), quoted(info.licence), rows);
}

}  // namespace burnish
