#include <fmt/format.h>

#include <algorithm>
#include <set>

#include "burnish/core/error.h"
#include "command_line.h"
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
  Parser(const CommandLine& line, const std::vector<std::string>& arguments)
      : line_(line), arguments_(arguments) {}

  void run() {
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
    set_operands();
  }

 private:
  void long_option(std::string_view word) {
    const std::size_t equals = word.find('=');
    const std::string_view name = word.substr(0, equals);
    const Option* option = line_.find(name);
    if (option == nullptr) refuse_unknown(name);
    if (equals == std::string_view::npos) {
      apply(*option, option->value.empty() ? std::string_view{} : value_of(*option, name));
      return;
    }
    if (option->value.empty()) refuse(fmt::format("{} takes no value", name), fmt::format("write {} alone", name));
    apply(*option, word.substr(equals + 1));
  }

  void short_options(std::string_view word) {
    // `-overwrite` is a long option with a dash too few, not `-o verwrite`.
    if (line_.find(fmt::format("-{}", word)) != nullptr) refuse_unknown(word);
    for (std::size_t i = 1; i < word.size(); ++i) {
      const Option* option = line_.find(word[i]);
      if (option == nullptr) refuse_unknown(word);
      if (option->value.empty()) {
        apply(*option, {});
        continue;
      }
      const std::string name{'-', option->letter};
      apply(*option, i + 1 < word.size() ? word.substr(i + 1) : value_of(*option, name));
      return;
    }
  }

  std::string_view value_of(const Option& option, std::string_view name) {
    if (next_ < arguments_.size() && !looks_like_option(arguments_[next_])) return arguments_[next_++];
    if (next_ == arguments_.size()) refuse(fmt::format("{} needs a value: {}", name, option.value.name), "");
    refuse(fmt::format("{} needs a value: {}, found the option '{}'", name, option.value.name, arguments_[next_]),
           fmt::format("a value that begins with a dash is given as {}={}", option.name, arguments_[next_]));
  }

  void apply(const Option& option, std::string_view value) {
    const bool first = seen_.insert(option.name).second;
    if (!first && !option.value.empty() && !option.repeatable) refuse(fmt::format("{} is given twice", option.name), "leave one of the two out");
    option.set({option.name, value, option.value.words});
  }

  void set_operands() {
    if (operands_.size() > line_.operands.size()) refuse_surplus_operand();
    if (operands_.size() < line_.operands.size()) {
      refuse(fmt::format("{} is missing", line_.operands[operands_.size()].value.name),
             fmt::format("the usage is: {}", line_.usage.front()));
    }
    for (std::size_t i = 0; i < operands_.size(); ++i) {
      const Operand& operand = line_.operands[i];
      operand.set({operand.value.name, operands_[i], operand.value.words});
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
  std::set<std::string_view> seen_;
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

void parse(const CommandLine& line, const std::vector<std::string>& arguments) {
  Parser(line, arguments).run();
}

}  // namespace burnish
