// Options from a file, and back into one.
//
//   # what all commands are to know
//   units = mm
//   [clean]
//   smooth = 0.2mm          # as --smooth 0.2mm
//   overwrite = true        # a switch: true or false
//   report = "a # b.json"   # quoted: \" \\ \n \r \t
//
// A line is `name = value`, `[command]`, or nothing; ` #` begins a comment. Names are those of the options, without dashes; an option that may be
// repeated may have several lines. What stands before the first `[command]` is for all commands that have such an option. Bytes of values
// are taken as they are.
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "command_line.h"

namespace burnish {

// The rows of --config and --save-config, for the heading `group`. Their setters do nothing: `parse` looks for them.
std::vector<Option> config_rows(std::string_view group);

// Whether the option says what to do with configurations, or ends the run before there is one: no file can hold it.
bool is_outside_of_config(const Option& option);

// Whether two options are two ways to say one thing, such as --cell and --resolution: commands refuse both. Of one that the command line has, and one in a file,
// the file's does not count; no more does one before the sections beside one in the command's own.
bool are_alternatives(std::string_view one, std::string_view other);

// The options that the file has for the command of `line`, in order; switches that are false left out.
// All sections are checked for names that exist, and none of their values is set. Throws Error{usage}: the file cannot be read or is larger than 1 MiB, a line is
// malformed, a name is unknown (suggesting the nearest), is there twice, or cannot be in a file; with the place.
std::vector<GivenOption> read_config(const std::string& path, const CommandLine& line);
// The same of a text; `label` stands for the path.
std::vector<GivenOption> parse_config(std::string_view text, const std::string& label, const CommandLine& line);

// A file that `read_config` gives these options for, in this order, each with its help; behind them, as comments, what else the command knows.
std::string config_text(const CommandLine& line, const std::vector<GivenOption>& given);

}  // namespace burnish
