// The commands of the program, one source each.
#pragma once

#include <array>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "command_line.h"

namespace burnish {

std::unique_ptr<Command> make_clean_command();    // burnish IN -o OUT
std::unique_ptr<Command> make_sweep_command();    // burnish sweep IN --smooth L,L -o OUT-{}.stl
std::unique_ptr<Command> make_check_command();    // burnish check FILE
std::unique_ptr<Command> make_compare_command();  // burnish compare A B
std::unique_ptr<Command> make_field_command();    // burnish field FILE
std::unique_ptr<Command> make_curvature_command();  // burnish curvature FILE
std::unique_ptr<Command> make_ic_command();       // burnish ic IN --case CASE
std::unique_ptr<Command> make_mesh_command();     // burnish mesh IN -o CASE
std::unique_ptr<Command> make_example_command();  // burnish example SHAPE -o FILE
std::unique_ptr<Command> make_completion_command();  // burnish completion SHELL
std::unique_ptr<Command> make_man_command();      // burnish man

struct CommandEntry {
  std::string_view name;
  std::string_view summary;
  std::unique_ptr<Command> (*make)();
};

// All of them; the first is the one that needs no name.
const std::vector<CommandEntry>& commands();

// The command of that name, or none.
const CommandEntry* find_command(std::string_view name);
// The name of the command that `word` seems to mean.
std::optional<std::string> nearest_command(std::string_view word);

// The command's own table, and what all commands have: --config and --save-config.
CommandLine full_command_line(Command& command);

// Throws the better error for an input that does not exist, when its name resembles a file beside it.
// Everything else about the input is for its reader to judge.
void require_plausible_input(const std::string& path);

// The one name of the file that `path` names: absolute, and with links followed as far as they exist. Files that would be written may not be there yet.
std::string resolved_path(const std::string& path);
// Whether two paths name the same file, through whatever links.
bool same_file(const std::string& a, const std::string& b);

// A file, and the option or the operand that names it.
struct NamedFile {
  std::string_view by;
  std::string path;  // empty: none is named
};
// The first two that name the same file, in their order, if there are. Standard streams, "-", are no files.
std::optional<std::array<NamedFile, 2>> named_twice(const std::vector<NamedFile>& files);

}  // namespace burnish
