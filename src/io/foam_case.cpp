// Which time a case starts from.
#include "burnish/io/foam_case.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>

#include "foam_file.h"
#include "text_scanner.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

// Text of the entries of system/controlDict; empty where they cannot be said.
struct Start {
  std::string from, time;
};

Start start_of(const std::string& path) {
  Start start;
  if (!FoamFile::exists(path)) return start;
  const FoamFile file(path);
  Source source{file.bytes(), file.path(), false, true};
  const FoamHeader header = foam_header(source, file.compressed());
  const std::vector<FoamEntry> entries = foam_entries(source, {header.end, static_cast<std::size_t>(source.end() - header.end)}, header.format);
  if (const FoamEntry* e = find_entry(entries, "startFrom")) start.from = e->value;
  if (const FoamEntry* e = find_entry(entries, "startTime")) start.time = e->value;
  return start;
}

}  // namespace

std::vector<std::string> time_folders(const std::string& case_folder) {
  std::vector<std::string> names;
  std::error_code ignored;
  for (fs::directory_iterator entry(case_folder, ignored), end; entry != end; entry.increment(ignored)) {
    const std::string name = entry->path().filename().string();
    const std::optional<double> time = whole_number(name);
    if (time && std::isfinite(*time) && *time >= 0 && entry->is_directory(ignored)) names.push_back(name);
  }
  std::sort(names.begin(), names.end(), [](const std::string& a, const std::string& b) {
    const double s = *whole_number(a), t = *whole_number(b);
    return s != t ? s < t : a < b;
  });
  return names;
}

std::string start_time_folder(const std::string& case_folder) {
  Start start = start_of(case_folder + "/system/controlDict");
  if (start.from.empty() && start.time.empty()) start = start_of(case_folder + "/../system/controlDict");  // of a part of a decomposed case
  const std::vector<std::string> times = time_folders(case_folder);
  if (start.from == "firstTime" && !times.empty()) return times.front();
  const std::optional<double> time = whole_number(start.time);
  if (start.from == "startTime") return time && *time >= 0 ? time_folder(case_folder, *time) : "0";
  // latestTime is what OpenFOAM takes where nothing is said.
  return times.empty() ? "0" : times.back();
}

std::string time_folder(const std::string& case_folder, double time) {
  for (const std::string& name : time_folders(case_folder))
    if (std::abs(*whole_number(name) - time) <= 1e-9 * time) return name;
  return fmt::format("{}", time);
}

}  // namespace burnish
