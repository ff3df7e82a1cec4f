// What is made of the option tables for others to read: manuals, and completion for shells.
//
// All are functions of the tables alone, and the same text for every build of the same version.
#pragma once

#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "command_line.h"
#include "commands.h"

namespace burnish {

// A command with its table, which points into it.
struct DescribedCommand {
  std::string_view name;
  std::string_view summary;  // that of the list of commands
  std::unique_ptr<Command> command;
  CommandLine line;
};

// All commands, in the order of commands(); the first needs no name.
std::vector<DescribedCommand> described_commands();

// The groups of a table's options, in the order in which it names them first.
std::vector<std::string_view> groups_of(const CommandLine& line);

// An exit code and what it means for all commands together.
struct ExitStatus {
  int code;
  std::string_view meaning;
};
const std::vector<ExitStatus>& exit_statuses();

// The manual page burnish(1) of all commands, for man and mandoc (man macros, no warnings).
std::string manual_page();
// The options of all commands as Markdown: docs/options.md.
std::string options_as_markdown();

// Scripts that define completion of the word `burnish`: for bash 4, zsh 5 and fish 3 and later, without need of anything else.
std::string bash_completion();
std::string zsh_completion();
std::string fish_completion();

}  // namespace burnish
