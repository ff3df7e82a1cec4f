// MappedFile: the bytes of a whole input, mapped where possible, read where not.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace burnish {

// A regular file is mapped read-only; a pipe, a terminal, standard input ("-") and files that do not
// know their size are read to their end. The bytes live as long as the object.
class MappedFile {
 public:
  // Throws Error{unreadable_input} naming `path` and the system's reason, and Error{interrupted} when a
  // signal wakes a read: programs install handlers without SA_RESTART to that end.
  explicit MappedFile(const std::string& path);
  ~MappedFile();
  MappedFile(const MappedFile&) = delete;
  MappedFile& operator=(const MappedFile&) = delete;

  std::string_view bytes() const { return bytes_; }

 private:
  bool map(int fd, std::size_t size);
  void read_to_end(int fd, const std::string& label);

  std::string_view bytes_;
  void* mapping_ = nullptr;
  std::vector<char> buffer_;
};

// What messages call the input at `path`: the path itself, or "standard input" for "-".
std::string input_label(const std::string& path);

}  // namespace burnish
