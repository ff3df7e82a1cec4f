#include "commands.h"
#include "manual.h"
#include "shared_rows.h"
#include "streams.h"
#include "values.h"

namespace burnish {
namespace {

constexpr std::string_view kNotes =
    R"(Packages install the scripts where shells look for them. For one shell only:
  bash: source <(burnish completion bash)
  zsh:  source <(burnish completion zsh)     after compinit
  fish: burnish completion fish | source
)";

class CompletionCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"completion",
            "Prints a script for a shell that completes commands, options, their values and\nthe names of files.",
            {"burnish completion bash|zsh|fish"},
            {{word("SHELL", {"bash", "zsh", "fish"}), "bash (4 or later), zsh (5) or fish (3).", [this](const GivenValue& v) { shell_ = place_among(v); }}},
            {help_row("Options")},
            kNotes};
  }

  int run() override {
    constexpr std::string (*kScripts[])() = {bash_completion, zsh_completion, fish_completion};
    write_stdout(kScripts[shell_]());
    return 0;
  }

 private:
  std::size_t shell_ = 0;
};

class ManCommand : public Command {
 public:
  CommandLine command_line() override {
    return {"man",
            "Prints the manual page of the program and all its commands, for man or mandoc.",
            {"burnish man [--markdown]"},
            {},
            {{"--markdown", 0, "", "Options", "Print the options of all commands as Markdown instead.", switch_on(markdown_)}, help_row("Options")},
            "Example:\n  burnish man | man -l -\n"};
  }

  int run() override {
    write_stdout(markdown_ ? options_as_markdown() : manual_page());
    return 0;
  }

 private:
  bool markdown_ = false;
};

}  // namespace

std::unique_ptr<Command> make_completion_command() { return std::make_unique<CompletionCommand>(); }
std::unique_ptr<Command> make_man_command() { return std::make_unique<ManCommand>(); }

}  // namespace burnish
