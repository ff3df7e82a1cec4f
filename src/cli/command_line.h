// The command line as data: one table per command, which parsing, help and suggestions all read.
//
// A command describes itself in a CommandLine whose setters write into the command's settings. Adding
// an option is adding a row to one table; nothing else has to know of it.
#pragma once

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/core/model_unit.h"
#include "value.h"

namespace burnish {

// A value as it was given, and by which option or operand: setters name both in their messages.
struct GivenValue {
  std::string_view name;  // "--cell", or an operand's name
  std::string_view text;  // empty for a switch
  std::span<const std::string_view> words = {};  // those that its row lists
  std::optional<ModelUnit> unit = std::nullopt;  // of the model, if --units has told it: lengths may then have a unit of their own

  // A part of the value, such as one of several lengths.
  GivenValue part(std::string_view some) const { return {name, some, words, unit}; }
};

// Stores a value. Throws Error{usage} for one that means nothing.
using Setter = std::function<void(const GivenValue&)>;

struct Option {
  std::string_view name;   // "--output"
  char letter = 0;         // 'o' if it is also -o; 0: there is no short form
  Value value;             // "NAME", file("FILE", {".stl"}), word("M", {"auto", "local"}), ...; empty: a switch
  std::string_view group;  // its heading in help; options of a group stand together
  std::string_view help;
  Setter set;
  bool repeatable = false;  // may be given more than once, each time with another value
  std::string_view opposite = {};  // of a switch, the one that says the contrary: what `False` means where options are values
};

// An argument without a name of its own. Every operand is required.
struct Operand {
  Value value;
  std::string_view help;
  Setter set;
  bool many = false;  // of the last one: it may be given several times, and is set each time
};

struct CommandLine {
  std::string_view command;  // "check"
  std::string_view summary;  // one line
  std::vector<std::string_view> usage;
  std::vector<Operand> operands;
  std::vector<Option> options;
  std::string_view notes;  // printed at the end of its help: examples, exit codes
  const std::optional<ModelUnit>* unit = nullptr;  // what --units sets; null: the command has no such option

  const Option* find(std::string_view name) const;
  const Option* find(char letter) const;
};

// An option with its value, and the place where it was given: "burnish.ini:7", or nothing for the command line.
struct GivenOption {
  const Option* option = nullptr;
  std::string value;
  std::string place;
};

// What a command line came to. The options point into the table.
struct ParsedLine {
  std::vector<GivenOption> given;  // in the order in which they were set
  bool json = false;               // --json is among them; of words that are not understood, too: how to answer can be told all the same
  bool only_saves = false;         // that was all: there are no operands
};

// `error` with the places, in front, of options that it names and that stand in a file.
Error with_places(const Error& error, const ParsedLine& parsed);

// One command of the program. Its settings live in the object, its table points into them.
class Command {
 public:
  virtual ~Command() = default;
  virtual CommandLine command_line() = 0;
  // Does what the settings say, once `parse` has filled them. Returns the exit code.
  virtual int run() = 0;
};

// Runs the setters of `line` for the `arguments` (without the program's and the command's name).
//
// Understood: `--name value`, `--name=value`, `-n value`, `-nvalue`, switches run together (`-qv`), and
// `--`, after which everything is an operand. A lone `-` is an operand or a value. Options of the file that --config
// names are set first, in its order, except those that the arguments have too, or an alternative of; --units is set before all others.
// Writes the file that --save-config names (cli/config.h). `parsed` is filled in as far as things got, whatever is thrown.
// Throws Error{usage} for unknown options (suggesting the nearest), missing or surplus values, options
// given twice that are not repeatable, and operands too many or too few; as cli/config.h says for the two files.
void parse(const CommandLine& line, const std::vector<std::string>& arguments, ParsedLine& parsed);

// The full help of a command, at most 80 columns wide.
std::string help_text(const CommandLine& line);

}  // namespace burnish
