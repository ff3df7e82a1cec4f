// The program: finds the command, runs it, and turns whatever ends it into a message and an exit code.
#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "burnish/core/build_info.h"
#include "burnish/core/error.h"
#include "commands.h"
#include "report_error.h"
#include "signals.h"
#include "streams.h"

namespace burnish {
namespace {

using Words = std::vector<std::string>;

constexpr std::string_view kShortUsage =
    "Usage: burnish IN -o OUT [options]     repair a file\n"
    "       burnish check FILE              look at a file\n"
    "       burnish example SHAPE -o FILE   make a dirty model\n"
    "       burnish --help                  all options\n";

// Whether one of `names` is among the options, that is, before a `--`.
bool has_option(const Words& words, std::initializer_list<std::string_view> names) {
  const auto end = std::find(words.begin(), words.end(), "--");
  return std::find_first_of(words.begin(), end, names.begin(), names.end()) != end;
}

std::string commands_text() {
  std::string text = "Commands:\n";
  for (const CommandEntry& entry : commands()) text += fmt::format("  {:<22}{}\n", entry.name, entry.summary);
  return text + "  help COMMAND          print a command's help\n";
}

int print_help(const CommandEntry& entry) {
  const std::string text = help_text(full_command_line(*entry.make()));
  write_stdout(&entry == &commands().front() ? fmt::format("{}\n{}", text, commands_text()) : text);
  return 0;
}

[[noreturn]] void refuse_command(const std::string& word) {
  const auto near = nearest_command(word);
  throw Error(ErrorCode::usage, fmt::format("unknown command '{}'", word),
              near ? fmt::format("did you mean '{}'?", *near) : "'burnish help' lists the commands");
}

int run_help(const Words& words) {
  if (words.size() < 2 || words[1].starts_with('-')) return print_help(commands().front());
  const CommandEntry* entry = find_command(words[1]);
  if (entry == nullptr) refuse_command(words[1]);
  return print_help(*entry);
}

// A first word that is no file, but nearly a command, was meant as one.
void refuse_misspelled_command(const std::string& word) {
  std::error_code ignored;
  if (!word.starts_with('-') && nearest_command(word) && !std::filesystem::exists(word, ignored)) {
    refuse_command(word);
  }
}

// A command's name that does not come first is taken for a file; say so before something odd is said.
void refuse_late_command(const Words& words) {
  std::error_code ignored;
  for (std::size_t i = 1; i < words.size() && words[0].starts_with('-'); ++i) {
    const bool names_command = words[i] == "check" || words[i] == "example";
    if (!names_command || std::filesystem::exists(words[i], ignored)) continue;
    throw Error(ErrorCode::usage, fmt::format("the command '{}' has to come first", words[i]),
                fmt::format("burnish {} ...", words[i]));
  }
}

// An error of the command line that is about options of a file tells where they stand.
int run_command(Command& command, const ParsedLine& parsed) try {
  return command.run();
} catch (const Error& error) {
  if (error.code() != ErrorCode::usage) throw;
  throw with_places(error, parsed);
}

// `parsed`: of the command, once it is known.
int run(Words words, ParsedLine& parsed) {
  if (words.empty()) {
    write_stderr(kShortUsage);
    return exit_code(ErrorCode::usage);
  }
  if (words[0] == "help") return run_help(words);
  const CommandEntry* entry = find_command(words[0]);
  if (entry != nullptr) words.erase(words.begin());
  const CommandEntry& chosen = entry != nullptr ? *entry : commands().front();
  if (has_option(words, {"--help", "-h"})) return print_help(chosen);
  if (has_option(words, {"--version"})) {
    write_stdout(has_option(words, {"--json"}) ? to_json(build_info()) : to_text(build_info()));
    return 0;
  }
  if (entry == nullptr) {
    refuse_misspelled_command(words[0]);
    refuse_late_command(words);
  }
  const std::unique_ptr<Command> command = chosen.make();
  const CommandLine line = full_command_line(*command);
  parse(line, words, parsed);
  return parsed.only_saves ? 0 : run_command(*command, parsed);
}

}  // namespace
}  // namespace burnish

int main(int argc, char** argv) {
  burnish::occupy_standard_streams();
  burnish::install_signal_handlers();
  const burnish::Words words(argv + std::min(argc, 1), argv + argc);
  burnish::ParsedLine parsed;
  parsed.json = burnish::has_option(words, {"--json"});  // until the words are understood
  std::string error;
  const int code = burnish::guarded([&] { return burnish::run(words, parsed); }, error);
  // Standard output may be what failed, so nothing is made of its refusal.
  if (!error.empty() && parsed.json) burnish::write_stdout_if_possible(error);
  return code;
}
