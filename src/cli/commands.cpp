#include "commands.h"

#include <fmt/format.h>

#include <algorithm>
#include <filesystem>
#include <iterator>

#include "burnish/core/error.h"
#include "config.h"
#include "suggest.h"

namespace burnish {

const std::vector<CommandEntry>& commands() {
  static const std::vector<CommandEntry> table = {
      {"clean", "repair a file; the word 'clean' may be left out", make_clean_command},
      {"sweep", "repair a file once and smooth it at several strengths", make_sweep_command},
      {"check", "look at a file without changing it", make_check_command},
      {"compare", "say how far two surfaces are from each other", make_compare_command},
      {"field", "build the level set on its octree: report, check and export it", make_field_command},
      {"curvature", "take the curvatures of the surface: report and export them", make_curvature_command},
      {"mesh", "fill the inside or the outside with cells for flow simulation", make_mesh_command},
      {"ic", "write volume fractions onto the mesh of an OpenFOAM case", make_ic_command},
      {"example", "make a dirty model to try things on", make_example_command},
      {"completion", "print the completion script of a shell: bash, zsh or fish", make_completion_command},
      {"man", "print the manual page", make_man_command},
  };
  return table;
}

const CommandEntry* find_command(std::string_view name) {
  const auto& table = commands();
  const auto at =
      std::find_if(table.begin(), table.end(), [&](const CommandEntry& entry) { return entry.name == name; });
  return at == table.end() ? nullptr : &*at;
}

std::optional<std::string> nearest_command(std::string_view word) {
  std::vector<std::string> names = {"help"};
  for (const CommandEntry& entry : commands()) names.emplace_back(entry.name);
  return nearest(word, names);
}

CommandLine full_command_line(Command& command) {
  CommandLine line = command.command_line();
  const auto is_help = [](const Option& o) { return o.name == "--help"; };
  const auto help = std::find_if(line.options.begin(), line.options.end(), is_help);
  const std::vector<Option> rows = config_rows(help->group == "Messages" ? "Configuration" : help->group);
  line.options.insert(help->group == "Messages" ? line.options.end() : help, rows.begin(), rows.end());
  return line;
}

void require_plausible_input(const std::string& path) {
  std::error_code ignored;
  if (path == "-" ||
      std::filesystem::symlink_status(path, ignored).type() != std::filesystem::file_type::not_found) {
    return;
  }
  const auto near = nearest_file(path);
  if (!near) return;
  throw Error(ErrorCode::unreadable_input, fmt::format("{}: no such file", path),
              fmt::format("did you mean '{}'?", *near));
}

std::string resolved_path(const std::string& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  const fs::path resolved = fs::weakly_canonical(fs::absolute(path), error);
  return (error ? fs::absolute(path).lexically_normal() : resolved).string();
}

bool same_file(const std::string& a, const std::string& b) { return resolved_path(a) == resolved_path(b); }

std::optional<std::array<NamedFile, 2>> named_twice(const std::vector<NamedFile>& files) {
  const auto is_file = [](const NamedFile& f) { return !f.path.empty() && f.path != "-"; };
  for (auto one = files.begin(); one != files.end(); ++one)
    for (auto other = std::next(one); other != files.end(); ++other)
      if (is_file(*one) && is_file(*other) && same_file(one->path, other->path)) return {{*one, *other}};
  return {};
}

}  // namespace burnish
