#include "burnish/io/output_file.h"

#include <fcntl.h>
#include <limits.h>
#include <sys/stat.h>
#include <unistd.h>

#include <array>
#include <atomic>
#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <random>

#include "burnish/core/error.h"
#include "fd_writer.h"
#include "system_hint.h"

namespace burnish {
namespace {

// The temporaries that exist, where a signal handler can find them without locks or allocation. A slot
// is claimed (free -> filling), filled, and only then made visible (-> live).
enum SlotState { kFree, kFilling, kLive };

struct Slot {
  std::atomic<int> state{kFree};
  std::array<char, PATH_MAX> path{};
};

std::array<Slot, 64> g_slots;
static_assert(std::atomic<int>::is_always_lock_free, "a signal handler reads it");

// A slot's index, or -1 when all are taken or the path is too long: such a file is not removed on
// signals, and all else works.
int register_temporary(const std::string& path) {
  if (path.size() >= PATH_MAX) return -1;
  for (std::size_t i = 0; i < g_slots.size(); ++i) {
    int expected = kFree;
    if (!g_slots[i].state.compare_exchange_strong(expected, kFilling)) continue;
    std::memcpy(g_slots[i].path.data(), path.c_str(), path.size() + 1);
    g_slots[i].state.store(kLive);
    return static_cast<int>(i);
  }
  return -1;
}

void release_slot(int& slot) {
  if (slot >= 0) g_slots[static_cast<std::size_t>(slot)].state.store(kFree);
  slot = -1;
}

[[noreturn]] void fail(const std::string& path, const std::string& what, const std::string& hint = {}) {
  throw Error(ErrorCode::unwritable_output, path + ": " + what, hint);
}

[[noreturn]] void fail_exists(const std::string& path) {
  fail(path, "exists already", "pass --overwrite to replace it");
}

[[noreturn]] void fail_errno(const std::string& path, int error) {
  fail(path, std::string("cannot be written: ") + std::strerror(error), write_hint(error));
}

// Refuses destinations that must not be replaced. A link to a file stands for that file.
std::string checked_destination(const std::string& path, bool overwrite) {
  struct stat status {};
  if (path.empty()) fail("the output", "has no name", "name a file, or pass '-' for standard output");
  if (path.back() == '/') fail(path, "is a folder", "name a file in it");
  if (::lstat(path.c_str(), &status) != 0) return path;
  if (S_ISDIR(status.st_mode)) fail(path, "is a folder", "name a file in it");
  if (!S_ISREG(status.st_mode) && !S_ISLNK(status.st_mode))
    fail(path, "is not a regular file", "pass '-' to write to standard output");
  if (!overwrite) fail_exists(path);
  if (!S_ISLNK(status.st_mode)) return path;
  char* resolved = ::realpath(path.c_str(), nullptr);
  if (!resolved) return path;  // a dangling link is replaced itself
  const std::string target(resolved);
  std::free(resolved);
  return checked_destination(target, overwrite);
}

// `.name.XXXXXX.tmp` in the destination's folder, so that the rename stays within one file system.
std::string temporary_beside(const std::string& destination, std::random_device& random) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  constexpr std::size_t kLongestName = 200;  // file systems allow 255 bytes
  const std::size_t slash = destination.rfind('/');
  const std::size_t folder = slash == destination.npos ? 0 : slash + 1;
  std::string path = destination.substr(0, folder) + "." + destination.substr(folder, kLongestName) + ".";
  for (int i = 0; i < 6; ++i) path += kLetters[random() % kLetters.size()];
  return path + ".tmp";
}

// Renames without ever replacing a file. Returns 0 or the error.
int rename_new(const char* from, const char* to) {
  if (::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_NOREPLACE) == 0) return 0;
  if (errno != EINVAL && errno != ENOSYS) return errno;
  if (::link(from, to) == 0) return ::unlink(from) == 0 ? 0 : errno;
  if (errno == EEXIST) return errno;
  // A file system without links: the best that is left, with a gap between the look and the rename.
  struct stat status {};
  if (::lstat(to, &status) == 0) return EEXIST;
  return ::rename(from, to) == 0 ? 0 : errno;
}

}  // namespace

OutputFile::OutputFile(const std::string& destination, bool overwrite)
    : destination_(checked_destination(destination, overwrite)), overwrite_(overwrite) {
  std::random_device random;
  do {
    temporary_ = temporary_beside(destination_, random);
    // Registered before it exists: no signal finds a file that nobody would remove.
    slot_ = register_temporary(temporary_);
    fd_ = ::open(temporary_.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
    if (fd_ >= 0) return;
    release_slot(slot_);
  } while (errno == EEXIST || errno == EINTR);
  fail_errno(destination_, errno);
}

OutputFile::~OutputFile() {
  if (fd_ < 0) return;
  ::close(fd_);
  ::unlink(temporary_.c_str());
  release_slot(slot_);
}

std::uint64_t OutputFile::bytes() const {
  struct stat status {};
  return ::fstat(fd_, &status) == 0 ? static_cast<std::uint64_t>(status.st_size) : 0;
}

void OutputFile::truncate() {
  if (::ftruncate(fd_, 0) != 0 || ::lseek(fd_, 0, SEEK_SET) != 0) fail_errno(destination_, errno);
}

void OutputFile::copy_to(int fd, const std::string& label) const {
  FdWriter out(fd, label);
  std::array<char, FdWriter::kLargest> buffer;
  for (off_t at = 0;;) {
    const ssize_t got = ::pread(fd_, buffer.data(), buffer.size(), at);
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) fail_errno(temporary_, errno);
    if (got == 0) break;
    out.put(std::string_view(buffer.data(), static_cast<std::size_t>(got)));
    at += got;
  }
  out.flush();
}

void OutputFile::commit() {
  OutputFile* const file = this;
  commit({&file, 1});
}

void OutputFile::commit(std::span<OutputFile* const> files) {
  for (OutputFile* file : files) file->flush_to_disk();
  std::size_t done = 0;
  try {
    for (; done < files.size(); ++done) files[done]->put_in_place(done + 1 < files.size());
  } catch (...) {
    while (done > 0) files[--done]->take_back();
    throw;
  }
  for (OutputFile* file : files) file->finish();
}

void OutputFile::flush_to_disk() {
  struct stat replaced {};
  if (overwrite_ && ::stat(destination_.c_str(), &replaced) == 0) ::fchmod(fd_, replaced.st_mode & 0777);
  // EINVAL: a file system that has nothing to flush.
  if (::fsync(fd_) != 0 && errno != EINVAL && errno != ENOTSUP) fail_errno(destination_, errno);
}

void OutputFile::put_in_place(bool may_be_taken_back) {
  const char *from = temporary_.c_str(), *to = destination_.c_str();
  struct stat old {};
  const bool replaces = overwrite_ && ::lstat(to, &old) == 0;
  // A folder that appeared meanwhile would be exchanged too.
  if (replaces && may_be_taken_back && !S_ISDIR(old.st_mode) && ::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_EXCHANGE) == 0) {
    place_ = Place::exchanged;
    return;
  }
  const int error = !overwrite_ ? rename_new(from, to) : ::rename(from, to) != 0 ? errno : 0;
  if (error == EEXIST) fail_exists(destination_);
  if (error != 0) fail_errno(destination_, error);
  place_ = replaces ? Place::replaced : Place::fresh;
}

void OutputFile::take_back() noexcept {
  const char *from = destination_.c_str(), *to = temporary_.c_str();
  if (place_ == Place::exchanged) ::renameat2(AT_FDCWD, from, AT_FDCWD, to, RENAME_EXCHANGE);
  if (place_ == Place::fresh) ::rename(from, to);
  place_ = Place::temporary;
}

void OutputFile::finish() {
  if (place_ == Place::exchanged) ::unlink(temporary_.c_str());
  release_slot(slot_);
  const int fd = fd_;
  fd_ = -1;
  if (::close(fd) != 0 && errno != EINTR) fail_errno(destination_, errno);
}

void OutputFile::remove_all_temporaries() noexcept {
  for (const Slot& slot : g_slots)
    if (slot.state.load() == kLive) ::unlink(slot.path.data());
}

}  // namespace burnish
