#include "config.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <filesystem>
#include <fstream>
#include <map>
#include <set>
#include <system_error>
#include <utility>

#include "burnish/core/error.h"
#include "commands.h"
#include "suggest.h"

namespace burnish {
namespace {

constexpr std::size_t kLargestFile = std::size_t{1} << 20;
constexpr std::string_view kBlanks = " \t";

std::string_view trimmed(std::string_view text) {
  const std::size_t first = text.find_first_not_of(kBlanks);
  if (first == text.npos) return {};
  return text.substr(first, text.find_last_not_of(kBlanks) - first + 1);
}

// What an unquoted value is before its comment.
std::string_view without_comment(std::string_view text) {
  for (std::size_t i = 0; i < text.size(); ++i)
    if (text[i] == '#' && (i == 0 || kBlanks.find(text[i - 1]) != kBlanks.npos)) return text.substr(0, i);
  return text;
}

// Escapes, and what they stand for.
constexpr std::string_view kEscapes = "\"\\nrt", kEscaped = "\"\\\n\r\t";

class ConfigReader {
 public:
  ConfigReader(const std::string& label, const CommandLine& line) : label_(label), line_(line) {
    for (const CommandEntry& entry : commands()) lines_.emplace(entry.name, full_command_line(*entry.make()));
  }

  std::vector<GivenOption> read(std::string_view text) {
    if (text.starts_with("\xEF\xBB\xBF")) text.remove_prefix(3);
    if (text.find('\0') != text.npos) throw Error(ErrorCode::usage, fmt::format("{}: not a text file", label_), "a configuration has lines such as: smooth = 0.5");
    while (!text.empty()) {
      const std::size_t end = std::min(text.find('\n'), text.size());
      ++number_;
      std::string_view row = text.substr(0, end);
      if (row.ends_with('\r')) row.remove_suffix(1);
      read_row(trimmed(row));
      text.remove_prefix(std::min(end + 1, text.size()));
    }
    return take();
  }

 private:
  std::string place() const { return fmt::format("{}:{}", label_, number_); }

  [[noreturn]] void refuse(const std::string& complaint, const std::string& hint = {}) const {
    throw Error(ErrorCode::usage, fmt::format("{}: {}", place(), complaint), hint);
  }

  void read_row(std::string_view row) {
    if (row.empty() || row[0] == '#') return;
    if (row[0] == '[') return begin_section(row);
    const std::size_t equals = row.find('=');
    if (equals == row.npos) refuse(fmt::format("expected 'name = value', found '{}'", row), "a switch is set with 'name = true'");
    const std::string name(trimmed(row.substr(0, equals)));
    const Option& option = option_named(name);
    if (is_outside_of_config(option)) refuse(fmt::format("'{}' cannot be set in a configuration", name), "give it on the command line");
    add(option, name, value_of(trimmed(row.substr(equals + 1)), name));
  }

  void begin_section(std::string_view row) {
    row = trimmed(without_comment(row));
    if (!row.ends_with(']')) refuse(fmt::format("expected '[command]', found '{}'", row), "a section begins with a command in brackets, such as [clean]");
    section_ = std::string(trimmed(row.substr(1, row.size() - 2)));
    if (!lines_.contains(section_)) refuse_section();
    if (!sections_.insert(section_).second) refuse(fmt::format("[{}] is there twice", section_), "put both parts together");
  }

  [[noreturn]] void refuse_section() const {
    const auto near = nearest_command(section_);
    refuse(fmt::format("unknown command '[{}]'", section_), near && *near != "help" ? fmt::format("did you mean '[{}]'?", *near) : "'burnish help' lists the commands");
  }

  // Of the section's command; before the first one, of this run's or else of any.
  const Option& option_named(const std::string& name) const {
    const std::string full = "--" + name;
    if (!section_.empty()) {
      if (const Option* option = lines_.at(section_).find(full)) return *option;
      refuse_name(name, {&lines_.at(section_)});
    }
    if (const Option* option = line_.find(full)) return *option;
    std::vector<const CommandLine*> all;
    for (const auto& [command, line] : lines_) {
      if (const Option* option = line.find(full)) return *option;
      all.push_back(&line);
    }
    refuse_name(name, all);
  }

  [[noreturn]] void refuse_name(const std::string& name, const std::vector<const CommandLine*>& lines) const {
    std::vector<std::string> names;
    for (const CommandLine* line : lines)
      for (const Option& option : line->options) names.emplace_back(option.name.substr(2));
    const auto near = nearest(name.substr(std::min(name.find_first_not_of('-'), name.size())), names);
    const std::string help = section_.empty() || section_ == "clean" ? "burnish --help" : fmt::format("burnish {} --help", section_);
    refuse(fmt::format("unknown option '{}'{}", name, section_.empty() ? "" : fmt::format(" in [{}]", section_)),
           near ? fmt::format("did you mean '{}'?", *near) : fmt::format("'{}' lists the options; their names stand here without dashes", help));
  }

  std::string value_of(std::string_view text, const std::string& name) const {
    if (text.starts_with('"')) return quoted_value(text.substr(1));
    const std::string_view value = trimmed(without_comment(text));
    if (value.empty()) refuse(fmt::format("'{}' has no value", name), "delete the line, or make a comment of it, to leave the option out");
    return std::string(value);
  }

  std::string quoted_value(std::string_view text) const {
    std::string value;
    for (std::size_t i = 0; i < text.size(); ++i) {
      if (text[i] == '"') {
        if (!trimmed(without_comment(text.substr(i + 1))).empty()) refuse(fmt::format("expected a comment behind the quoted value, found '{}'", trimmed(text.substr(i + 1))), "put a # before it, or a backslash before a quote that belongs to the value");
        return value;
      }
      value += text[i] == '\\' ? escaped(text.substr(++i, 1)) : text[i];
    }
    refuse("a quoted value has no end", "add a \" at the end of the line");
  }

  char escaped(std::string_view letter) const {
    const std::size_t at = letter.empty() ? kEscapes.npos : kEscapes.find(letter[0]);
    if (at == kEscapes.npos) refuse(fmt::format("expected one of \\\" \\\\ \\n \\r \\t in a quoted value, found '\\{}'", letter), "a backslash is written as \\\\");
    return kEscaped[at];
  }

  void add(const Option& option, const std::string& name, std::string value) {
    const bool first = seen_.emplace(section_, name).second;
    if (!first && !option.repeatable) refuse(fmt::format("'{}' is there twice", name), "an option has one line");
    if (option.value.empty() && value != "true" && value != "false")
      refuse(fmt::format("'{}' is a switch: expected true or false, found '{}'", name, value), fmt::format("{} = true", name));
    if (!section_.empty() && section_ != line_.command) return;
    const Option* own = line_.find(option.name);
    if (own != nullptr) (section_.empty() ? common_ : own_).push_back({own, std::move(value), place()});
  }

  // What the command's section says is said last, and alone.
  std::vector<GivenOption> take() {
    std::set<const Option*> overruled;
    for (const GivenOption& given : own_) overruled.insert(given.option);
    const auto is_overruled = [&](const GivenOption& given) {
      return overruled.contains(given.option) || std::any_of(overruled.begin(), overruled.end(), [&](const Option* o) { return are_alternatives(o->name, given.option->name); });
    };
    std::erase_if(common_, is_overruled);
    common_.insert(common_.end(), own_.begin(), own_.end());
    std::erase_if(common_, [](const GivenOption& given) { return given.option->value.empty() && given.value == "false"; });
    for (GivenOption& given : common_)
      if (given.option->value.empty()) given.value.clear();
    return std::move(common_);
  }

  const std::string& label_;
  const CommandLine& line_;
  std::map<std::string, CommandLine, std::less<>> lines_;  // names and flags only: the commands they point into are gone
  std::size_t number_ = 0;
  std::string section_;
  std::set<std::string> sections_;
  std::set<std::pair<std::string, std::string>> seen_;
  std::vector<GivenOption> common_, own_;
};

std::string text_of_file(const std::string& path) {
  std::error_code error;
  std::ifstream file(path, std::ios::binary);
  std::string text(kLargestFile + 1, '\0');
  if (!file || std::filesystem::is_directory(path, error)) {
    const auto near = nearest_file(path);
    const std::string reason = file ? "it is a folder" : std::generic_category().message(errno);
    throw Error(ErrorCode::usage, fmt::format("{}: the configuration cannot be read: {}", path, reason), near && *near != path ? fmt::format("did you mean '{}'?", *near) : "look at its name and its rights");
  }
  file.read(text.data(), static_cast<std::streamsize>(text.size()));
  if (file.bad()) throw Error(ErrorCode::usage, fmt::format("{}: the configuration cannot be read", path), "copy it to another disk, or give the options on the command line");
  text.resize(static_cast<std::size_t>(file.gcount()));
  if (text.size() > kLargestFile) throw Error(ErrorCode::usage, fmt::format("{}: expected a configuration, found more than a megabyte", path), "name the file with the options");
  return text;
}

bool needs_quotes(std::string_view value) {
  constexpr std::string_view kPlain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789._%+,:/={}@~-";
  return value.empty() || value.find_first_not_of(kPlain) != value.npos;
}

std::string written_value(std::string_view value) {
  if (!needs_quotes(value)) return std::string(value);
  std::string text = "\"";
  for (const char c : value) {
    const std::size_t at = kEscaped.find(c);
    text += at == kEscaped.npos ? std::string(1, c) : std::string{'\\', kEscapes[at]};
  }
  return text + '"';
}

}  // namespace

std::vector<Option> config_rows(std::string_view group) {
  const Setter nothing = [](const GivenValue&) {};
  return {{"--config", 0, file("FILE"), group, "Take options from FILE, in lines such as 'smooth = 0.5'. What the command line says goes first.", nothing},
          {"--save-config", 0, file("FILE"), group, "Write the options of this run for --config. Without an input, nothing else is done.", nothing}};
}

bool is_outside_of_config(const Option& option) {
  constexpr std::string_view kOutside[] = {"--config", "--save-config", "--help", "--version"};
  return std::find(std::begin(kOutside), std::end(kOutside), option.name) != std::end(kOutside);
}

bool are_alternatives(std::string_view one, std::string_view other) {
  constexpr std::pair<std::string_view, std::string_view> kAlternatives[] = {{"--cell", "--resolution"},         {"--cell", "--cells"},     {"--quiet", "--verbose"},
                                                                             {"--keep-openings", "--max-hole"}, {"--inside", "--outside"}, {"--samples", "--spacing"}};
  return std::any_of(std::begin(kAlternatives), std::end(kAlternatives), [&](const auto& a) { return a == std::pair{one, other} || a == std::pair{other, one}; });
}

std::vector<GivenOption> parse_config(std::string_view text, const std::string& label, const CommandLine& line) { return ConfigReader(label, line).read(text); }

std::vector<GivenOption> read_config(const std::string& path, const CommandLine& line) { return parse_config(text_of_file(path), path, line); }

std::string config_text(const CommandLine& line, const std::vector<GivenOption>& given) {
  std::string text = fmt::format("# Options of burnish {0}, for --config. What is given on the command line goes first.\n[{0}]\n", line.command);
  std::set<const Option*> written;
  for (const GivenOption& g : given) {
    if (is_outside_of_config(*g.option)) continue;
    const bool first = written.insert(g.option).second;
    if (!first && g.option->value.empty()) continue;  // a switch that was given twice
    if (first) text += fmt::format("\n# {}\n", g.option->help);
    text += fmt::format("{} = {}\n", g.option->name.substr(2), g.option->value.empty() ? "true" : written_value(g.value));
  }
  text += "\n# --- not set\n";
  for (const Option& option : line.options)
    if (!written.contains(&option) && !is_outside_of_config(option))
      text += fmt::format("\n# {}\n#{} = {}\n", option.help, option.name.substr(2), option.value.empty() ? "true" : option.value.name);
  return text;
}

}  // namespace burnish
