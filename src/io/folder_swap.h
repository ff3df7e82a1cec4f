// FolderSwap: a folder that replaces another one as a whole.
#pragma once

#include <string>
#include <vector>

namespace burnish {

// A new folder beside its destination (`.name.XXXXXX.tmp`), which `commit` puts in the place of what is there. Unless committed, the destructor
// removes it, and the folders that were made for it. The destination may be a link to a folder: then that folder is replaced.
class FolderSwap {
 public:
  // Creates the new folder, and those that the destination is to be in. Throws Error{unwritable_output}.
  explicit FolderSwap(const std::string& destination);
  ~FolderSwap();
  FolderSwap(const FolderSwap&) = delete;
  FolderSwap& operator=(const FolderSwap&) = delete;

  const std::string& folder() const { return temporary_; }
  const std::string& destination() const { return destination_; }

  // One exchange of names, where the file system has that (ext4, xfs, btrfs, tmpfs): at any time the name means the old folder or the new one, whole.
  // Elsewhere two renames, between which there is none of that name. Then the old folder is removed.
  void commit();

 private:
  std::string destination_;
  std::string temporary_;
  std::vector<std::string> made_;  // folders that were not there, the innermost first
  bool committed_ = false;
};

// Removes a folder with all that is in it; under its name it is there whole or not at all. Throws Error{unwritable_output}.
void remove_folder(const std::string& folder);

}  // namespace burnish
