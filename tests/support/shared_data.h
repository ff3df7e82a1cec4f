// The evaluation data, where they are: real files, listed in a manifest.
#pragma once

#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <map>
#include <sstream>
#include <string>
#include <vector>

namespace burnish::test {

inline std::filesystem::path data_folder() {
  const char* named = std::getenv("BURNISH_SHARED_DATA");
  return named && *named ? std::filesystem::path(named) : std::filesystem::path(BURNISH_SOURCE_DIR) / ".." / "shared" / "data";
}

using Row = std::map<std::string, std::string>;

// The manifest's rows, each by the names of the columns. Empty where there is no manifest.
inline std::vector<Row> manifest() {
  const auto cells = [](const std::string& line) {
    std::vector<std::string> fields;
    std::istringstream in(line);
    for (std::string field; std::getline(in, field, '\t');) fields.push_back(field);
    return fields;
  };
  std::ifstream in(data_folder() / "MANIFEST.tsv");
  std::string line;
  std::getline(in, line);
  const std::vector<std::string> names = cells(line);
  std::vector<Row> rows;
  while (std::getline(in, line)) {
    const std::vector<std::string> fields = cells(line);
    Row& row = rows.emplace_back();
    for (std::size_t i = 0; i < std::min(names.size(), fields.size()); ++i) row[names[i]] = fields[i];
  }
  return rows;
}

inline std::filesystem::path file_of(const Row& row) { return data_folder() / row.at("class") / (row.at("name") + ".stl"); }

}  // namespace burnish::test
