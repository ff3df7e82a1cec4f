// Folders that files of a run are to be in.
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace burnish {

// Makes them; those that stay empty are removed in the end.
class MadeFolders {
 public:
  MadeFolders() = default;
  ~MadeFolders();
  MadeFolders(const MadeFolders&) = delete;
  MadeFolders& operator=(const MadeFolders&) = delete;

  // The folder that `file` is to be in; nothing for an empty name. Throws Error{unwritable_output}.
  void make_for(const std::string& file);
  // The same if that is `place` or within it. What cannot be made is told of by the file that was to be in it.
  void make_for(const std::string& file, const std::string& place);

 private:
  void make(const std::filesystem::path& folder);

  std::vector<std::filesystem::path> made_;
};

}  // namespace burnish
