#include "mapped_file.h"

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "burnish/core/error.h"

namespace burnish {
namespace {

[[noreturn]] void fail(const std::string& label, const std::string& what, const std::string& hint = {}) {
  throw Error(ErrorCode::unreadable_input, label + ": cannot be read: " + what, hint);
}

class Descriptor {
 public:
  explicit Descriptor(const std::string& path) : owned_(path != "-") {
    do fd_ = owned_ ? ::open(path.c_str(), O_RDONLY | O_CLOEXEC) : STDIN_FILENO;
    while (fd_ < 0 && errno == EINTR);
  }
  ~Descriptor() {
    if (owned_ && fd_ >= 0) ::close(fd_);
  }
  Descriptor(const Descriptor&) = delete;
  Descriptor& operator=(const Descriptor&) = delete;
  int get() const { return fd_; }

 private:
  bool owned_;
  int fd_ = -1;
};

}  // namespace

MappedFile::MappedFile(const std::string& path) {
  const std::string label = input_label(path);
  const Descriptor file(path);
  struct stat status {};
  if (file.get() < 0 || ::fstat(file.get(), &status) != 0) fail(label, std::strerror(errno));
  if (S_ISDIR(status.st_mode)) fail(label, "it is a folder", "name a file in it");
  const bool from_start = path != "-";  // standard input may stand anywhere in its file
  if (from_start && S_ISREG(status.st_mode) && map(file.get(), static_cast<std::size_t>(status.st_size)))
    return;
  read_to_end(file.get(), label);
}

MappedFile::~MappedFile() {
  if (mapping_) ::munmap(mapping_, bytes_.size());
}

bool MappedFile::map(int fd, std::size_t size) {
  if (size == 0) return false;
  void* start = ::mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, fd, 0);
  if (start == MAP_FAILED) return false;
  mapping_ = start;
  bytes_ = {static_cast<const char*>(start), size};
  return true;
}

void MappedFile::read_to_end(int fd, const std::string& label) {
  std::size_t size = 0;
  for (;;) {
    if (size == buffer_.size()) buffer_.resize(size == 0 ? 1 << 16 : 2 * size);
    const ssize_t got = ::read(fd, buffer_.data() + size, buffer_.size() - size);
    if (got < 0 && errno == EINTR) throw Error(ErrorCode::interrupted, "interrupted while reading " + label, "start again: nothing was written");
    if (got < 0) fail(label, std::strerror(errno));
    if (got == 0) break;
    size += static_cast<std::size_t>(got);
  }
  bytes_ = {buffer_.data(), size};
}

std::string input_label(const std::string& path) { return path == "-" ? "standard input" : path; }

}  // namespace burnish
