// OutputFile: nothing half-written is ever seen under the name the user gave.
#pragma once

#include <cstdint>
#include <span>
#include <string>

namespace burnish {

// A temporary file beside its destination (`.name.XXXXXX.tmp`), which `commit` renames into place.
// Unless committed, the destructor removes it; so does `remove_all_temporaries`, from a signal handler.
class OutputFile {
 public:
  // Creates the temporary. Throws Error{unwritable_output}: the destination exists and `overwrite` is
  // false, the folder is missing or not writable, the destination is a folder, a device or a pipe.
  // With `overwrite`, a destination that is a link to a file means that file; the link stays.
  OutputFile(const std::string& destination, bool overwrite);
  ~OutputFile();
  OutputFile(const OutputFile&) = delete;
  OutputFile& operator=(const OutputFile&) = delete;

  int fd() const { return fd_; }
  const std::string& temporary_path() const { return temporary_; }
  const std::string& destination() const { return destination_; }

  // Size of the temporary so far; 0 if the system does not say.
  std::uint64_t bytes() const;
  // Empties the temporary, for writing it anew.
  void truncate();
  // Writes the temporary's bytes to another open file descriptor, for results that go to standard output. Throws
  // Error{unwritable_output}, naming `label`, when the system refuses them.
  void copy_to(int fd, const std::string& label) const;
  // Flushes to disk and renames onto the destination, with the permissions of the file it replaces, or
  // those of a new file.
  // Refuses, as the constructor does, if the destination appeared meanwhile and `overwrite` is false.
  void commit();
  // The same of several, all or none: all are flushed before the first is renamed, and what has been renamed gets its old file back when a later one is refused.
  // Between two renames a crash, or another program, can find some new and some old; a file system without RENAME_EXCHANGE gives no old file back.
  static void commit(std::span<OutputFile* const> files);

  // Unlinks the temporaries of all living OutputFiles (the first 64 of them). Async-signal-safe.
  static void remove_all_temporaries() noexcept;

 private:
  enum class Place { temporary, fresh, exchanged, replaced };

  void flush_to_disk();
  void put_in_place(bool may_be_taken_back);
  void take_back() noexcept;
  void finish();

  std::string destination_;
  std::string temporary_;
  bool overwrite_;
  Place place_ = Place::temporary;  // of the bytes; once they are exchanged, the temporary is the old file
  int fd_ = -1;
  int slot_ = -1;
};

}  // namespace burnish
