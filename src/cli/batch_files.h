// Where each of several inputs' files go: one rule for all options that name a file.
//
//   what is given         for the input parts/a.stl
//   out/, or a folder     out/a.stl (or the suffix that the option's files have)
//   out/{}-clean.ply      out/a-clean.ply; so is every further {}, in names of folders, too
//   out.stl               out.stl: for one input only
#pragma once

#include <string>
#include <string_view>
#include <vector>

#include "made_folders.h"

namespace burnish {

// Whether the name stands for a file per input: it ends with a slash, is a folder that exists, or has {} in it.
bool is_place(const std::string& given);

// The file for `input`. `suffix` is that of files in a folder, such as ".json"; empty: the input's name as it is.
// Throws Error{usage} for standard input, which has no name. What is no place is returned as it is.
std::string file_for(const std::string& given, const std::string& input, std::string_view suffix);

// An option that names a file per input.
struct PlacedOption {
  std::string_view option;  // "--report"
  std::string* path;        // what it was given; empty: it was not. To be replaced by an input's own file
  std::string_view suffix;  // as in file_for
};

// The one file `name` of a place for all inputs together: in the folder, or, of a pattern, in the folder that stands before its first {}. Empty for an empty place.
std::string file_for_all(const std::string& given, const std::string& name);

// A file that is written besides those of the options.
struct OtherFile {
  std::string_view option;  // that asks for it
  std::string file;
  std::string content;      // what it holds, for messages: "the summary"
};

// The files of all inputs, and the folders of those that were given as places.
class PlacedFiles {
 public:
  // Throws Error{usage}, before anything is done: standard input is to have a name; and of several inputs: an option names one file for all of them; two files have one
  // name, `others` among them; a file would replace an input. For one input, whoever runs it has to look.
  PlacedFiles(const std::vector<std::string>& inputs, std::vector<PlacedOption> options, const std::vector<OtherFile>& others = {});

  // Gives each option its file for that input.
  void take(std::size_t input) const;
  // Makes the folders; those that stay empty are removed in the end. Throws Error{unwritable_output}.
  void make_folders();
  // Those of an option, input by input; none if it was not given.
  const std::vector<std::string>& of_option(std::size_t option) const { return files_[option]; }

 private:
  std::vector<PlacedOption> options_;
  std::vector<bool> is_place_;                   // by option
  std::vector<std::vector<std::string>> files_;  // [option][input]
  MadeFolders folders_;
};

}  // namespace burnish
