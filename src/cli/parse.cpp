#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <set>

#include "burnish/core/error.h"
#include "burnish/io/output_file.h"
#include "command_line.h"
#include "commands.h"
#include "config.h"
#include "streams.h"
#include "suggest.h"

namespace burnish {
namespace {

[[noreturn]] void refuse(const std::string& message, const std::string& hint) {
  throw Error(ErrorCode::usage, message, hint);
}

std::string help_command(const CommandLine& line) {
  return line.command == "clean" ? "burnish --help" : fmt::format("burnish {} --help", line.command);
}

// A word after an option that is another option rather than its value. Negative numbers and names of
// one dash pass, so that their setter can say what is wrong with them.
bool looks_like_option(std::string_view word) {
  if (word.size() < 2 || word[0] != '-') return false;
  return !(word[1] >= '0' && word[1] <= '9') && word[1] != '.';
}

class Parser {
 public:
  Parser(const CommandLine& line, const std::vector<std::string>& arguments, ParsedLine& parsed)
      : line_(line), arguments_(arguments), given_(parsed.given), parsed_(parsed) {}

  void run() {
    parsed_ = {};
    collect();
    add_configured();
    set_options();
    save();
    parsed_.only_saves = !save_path_.empty() && operands_.empty();
    if (!parsed_.only_saves) set_operands();
  }

 private:
  void collect() try {
    bool options_end = false;
    while (next_ < arguments_.size()) {
      const std::string& word = arguments_[next_++];
      if (options_end || word.size() < 2 || word[0] != '-') {
        operands_.push_back(word);
      } else if (word == "--") {
        options_end = true;
      } else if (word[1] == '-') {
        long_option(word);
      } else {
        short_options(word);
      }
    }
  } catch (const Error&) {  // what comes behind the word that is not understood
    const auto end = std::find(arguments_.begin(), arguments_.end(), "--");
    parsed_.json |= std::find(arguments_.begin() + static_cast<std::ptrdiff_t>(next_ - 1), end, "--json") != end;
    throw;
  }

  void long_option(std::string_view word) {
    const std::size_t equals = word.find('=');
    const std::string_view name = word.substr(0, equals);
    const Option* option = line_.find(name);
    if (option == nullptr) refuse_unknown(name);
    if (equals == std::string_view::npos) {
      add(*option, option->value.empty() ? std::string_view{} : value_of(*option, name));
      return;
    }
    if (option->value.empty()) refuse(fmt::format("{} takes no value", name), fmt::format("write {} alone", name));
    add(*option, word.substr(equals + 1));
  }

  void short_options(std::string_view word) {
    // `-overwrite` is a long option with a dash too few, not `-o verwrite`.
    if (line_.find(fmt::format("-{}", word)) != nullptr) refuse_unknown(word);
    for (std::size_t i = 1; i < word.size(); ++i) {
      const Option* option = line_.find(word[i]);
      if (option == nullptr) refuse_unknown(word);
      if (option->value.empty()) {
        add(*option, {});
        continue;
      }
      const std::string name{'-', option->letter};
      add(*option, i + 1 < word.size() ? word.substr(i + 1) : value_of(*option, name));
      return;
    }
  }

  std::string_view value_of(const Option& option, std::string_view name) {
    if (next_ < arguments_.size() && !looks_like_option(arguments_[next_])) return arguments_[next_++];
    if (next_ == arguments_.size()) refuse(fmt::format("{} needs a value: {}", name, option.value.name), fmt::format("write it behind the option: {} {}", name, option.value.name));
    refuse(fmt::format("{} needs a value: {}, found the option '{}'", name, option.value.name, arguments_[next_]),
           fmt::format("a value that begins with a dash is given as {}={}", option.name, arguments_[next_]));
  }

  void add(const Option& option, std::string_view value) {
    const bool first = seen_.insert(option.name).second;
    if (!first && !option.value.empty() && !option.repeatable) refuse(fmt::format("{} is given twice", option.name), "leave one of the two out");
    if (!first && option.value.empty()) std::erase_if(given_, [&](const GivenOption& g) { return g.option == &option; });  // the last one counts
    parsed_.json |= option.name == "--json";
    given_.push_back({&option, std::string(value), {}});
  }

  std::string value_given(std::string_view name) const {
    const auto at = std::find_if(given_.begin(), given_.end(), [&](const GivenOption& g) { return g.option->name == name; });
    if (at == given_.end()) return {};
    if (at->value.empty() || at->value == "-") refuse(fmt::format("{} needs a file's name", name), "standard input and output are for the model");
    return at->value;
  }

  // What the file says goes first, so that the command line has the last word; of options that both give, it has the only one.
  void add_configured() {
    save_path_ = value_given("--save-config");
    const std::string path = value_given("--config");
    if (path.empty()) return;
    std::vector<GivenOption> configured = read_config(path, line_);
    std::erase_if(configured, [&](const GivenOption& g) { return is_overruled(g.option->name); });
    for (const GivenOption& g : configured) seen_.insert(g.option->name);
    parsed_.json = seen_.contains("--json");
    given_.insert(given_.begin(), configured.begin(), configured.end());
  }

  bool is_overruled(std::string_view name) const {
    return seen_.contains(name) || std::any_of(seen_.begin(), seen_.end(), [&](std::string_view seen) { return are_alternatives(seen, name); });
  }

  void set_options() {
    for (const GivenOption& g : given_)
      if (g.option->name == "--units") set(g);
    for (const GivenOption& g : given_)
      if (g.option->name != "--units") set(g);
  }

  // Messages about a value tell where it was given.
  void set(const GivenOption& given) const try {
    given.option->set({given.option->name, given.value, given.option->value.words, unit()});
  } catch (const Error& error) {
    if (given.place.empty()) throw;
    throw Error(error.code(), fmt::format("{}: {}", given.place, error.what()), error.hint());
  }

  std::optional<ModelUnit> unit() const { return line_.unit != nullptr ? *line_.unit : std::nullopt; }

  void save() const {
    if (save_path_.empty()) return;
    for (const std::string& operand : operands_)
      if (same_file(operand, save_path_)) refuse(fmt::format("{}: --save-config names the input", save_path_), "give another name");
    require_no_file_of_options();
    require_no_alternatives();
    OutputFile file(save_path_, seen_.contains("--overwrite"));
    write_text(file.fd(), save_path_, config_text(line_, given_));
    file.commit();
  }

  // A configuration may be saved in its own place, which --overwrite has to allow, but not in that of another file of the run.
  void require_no_file_of_options() const {
    for (const GivenOption& g : given_)
      if (g.option->value.kind == Value::Kind::file && !is_outside_of_config(*g.option) && same_file(g.value, save_path_))
        refuse(fmt::format("{}: {} and {} name the same file", save_path_, g.option->name, "--save-config"), "give one of them another name");
  }

  // What no run would take is not saved.
  void require_no_alternatives() const {
    const auto says_something = [](const GivenOption& g) { return std::ranges::find(g.option->value.words, g.value) == g.option->value.words.end(); };  // unlike `--cell auto`
    for (const GivenOption& one : given_)
      for (const GivenOption& other : given_)
        if (are_alternatives(one.option->name, other.option->name) && says_something(one) && says_something(other))
          refuse(fmt::format("{} and {} exclude each other", one.option->name, other.option->name), "give one of the two");
  }

  void set_operands() {
    const bool many = !line_.operands.empty() && line_.operands.back().many;
    if (operands_.size() > line_.operands.size() && !many) refuse_surplus_operand();
    if (operands_.size() < line_.operands.size()) {
      refuse(fmt::format("{} is missing", line_.operands[operands_.size()].value.name),
             fmt::format("the usage is: {}", line_.usage.front()));
    }
    for (std::size_t i = 0; i < operands_.size(); ++i) {
      const Operand& operand = line_.operands[std::min(i, line_.operands.size() - 1)];
      operand.set({operand.value.name, operands_[i], operand.value.words, unit()});
    }
  }

  [[noreturn]] void refuse_unknown(std::string_view word) const {
    std::vector<std::string> names;
    for (const Option& option : line_.options) names.emplace_back(option.name);
    const auto near = nearest(word.starts_with("--") ? std::string(word) : fmt::format("-{}", word), names);
    refuse(fmt::format("unknown option '{}'", word),
           near ? fmt::format("did you mean '{}'?", *near)
                : fmt::format("'{}' lists the options", help_command(line_)));
  }

  [[noreturn]] void refuse_surplus_operand() const {
    const std::string& surplus = operands_[line_.operands.size()];
    const bool output_is_open = line_.find('o') != nullptr && !seen_.contains("--output");
    refuse(fmt::format("unexpected argument '{}'", surplus),
           output_is_open ? fmt::format("the output is named with -o: -o {}", surplus)
                          : fmt::format("the usage is: {}", line_.usage.front()));
  }

  const CommandLine& line_;
  const std::vector<std::string>& arguments_;
  std::size_t next_ = 0;
  std::vector<std::string> operands_;
  std::vector<GivenOption>& given_;
  ParsedLine& parsed_;
  std::set<std::string_view> seen_;
  std::string save_path_;
};

}  // namespace

const Option* CommandLine::find(std::string_view name) const {
  const auto at =
      std::find_if(options.begin(), options.end(), [&](const Option& o) { return o.name == name; });
  return at == options.end() ? nullptr : &*at;
}

const Option* CommandLine::find(char letter) const {
  const auto has_letter = [&](const Option& o) { return o.letter != 0 && o.letter == letter; };
  const auto at = std::find_if(options.begin(), options.end(), has_letter);
  return at == options.end() ? nullptr : &*at;
}

void parse(const CommandLine& line, const std::vector<std::string>& arguments, ParsedLine& parsed) { Parser(line, arguments, parsed).run(); }

namespace {

// As a word of its own: --cell is not in "--cell-max".
bool names(std::string_view message, std::string_view word) {
  const auto is_of_name = [&](std::size_t at) { return at < message.size() && (std::isalnum(static_cast<unsigned char>(message[at])) != 0 || message[at] == '-'); };
  for (std::size_t at = message.find(word); at != message.npos; at = message.find(word, at + 1))
    if ((at == 0 || !is_of_name(at - 1)) && !is_of_name(at + word.size())) return true;
  return false;
}

}  // namespace

Error with_places(const Error& error, const ParsedLine& parsed) {
  std::string places;
  for (const GivenOption& g : parsed.given) {
    const std::string letter = g.option->letter != 0 ? fmt::format("-{}", g.option->letter) : std::string(g.option->name);
    if (!g.place.empty() && (names(error.what(), g.option->name) || names(error.what(), letter))) places += fmt::format("{}{}", places.empty() ? "" : ", ", g.place);
  }
  return places.empty() ? error : Error(error.code(), fmt::format("{}: {}", places, error.what()), error.hint());
}

}  // namespace burnish
