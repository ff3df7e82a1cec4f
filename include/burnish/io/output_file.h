// OutputFile: nothing half-written is ever seen under the name the user gave.
#pragma once

#include <string>

namespace burnish {

// A temporary file beside its destination (`.name.XXXXXX.tmp`), which `commit` renames into place.
// Unless committed, the destructor removes it; so does `remove_all_temporaries`, from a signal handler.
class OutputFile {
 public:
  // Creates the temporary. Throws Error{unwritable_output}: the destination exists and `overwrite` is
  // false, the folder is missing or not writable, the destination is a folder, a device or a pipe.
  // With `overwrite`, a destination that is a link to a file means that file; the link stays.
  OutputFile(std::string destination, bool overwrite);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  int fd() const { return fd_; }
  const std::string& temporary_path() const { return temporary_; }
  const std::string& destination() const { return destination_; }

  // Empties the temporary, for writing it anew.
  void truncate();
  // Writes the temporary's bytes to another open file descriptor, for results that go to standard output. Throws
  // Error{unwritable_output}, naming `label`, when the system refuses them.
  void copy_to(int fd, const std::string& label) const;
  // Flushes to disk and renames onto the destination, with the permissions of the file it replaces, or
  // those of a new file.
  // Refuses, as the constructor does, if the destination appeared meanwhile and `overwrite` is false.
  void commit();

  // Unlinks the temporaries of all living OutputFiles (the first 64 of them). Async-signal-safe.
  static void remove_all_temporaries() noexcept;

 private:
  std::string destination_;
  std::string temporary_;
  bool overwrite_;
  int fd_ = -1;
  int slot_ = -1;
};

}  // namespace burnish
