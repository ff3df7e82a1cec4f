#include "folder_swap.h"

#include <fcntl.h>
#include <stdio.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <random>
#include <system_error>

#include "burnish/core/error.h"
#include "system_hint.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

[[noreturn]] void fail(const std::string& path, int error) {
  throw Error(ErrorCode::unwritable_output, path + ": cannot be written: " + std::strerror(error), write_hint(error));
}

void rename_or_fail(const std::string& from, const std::string& to) {
  if (::rename(from.c_str(), to.c_str()) != 0) fail(to, errno);
}

// A name that nothing has.
std::string temporary_beside(const fs::path& folder) {
  constexpr std::string_view kLetters = "abcdefghijklmnopqrstuvwxyz0123456789";
  std::random_device random;
  std::error_code ignored;
  for (;;) {
    std::string name = "." + folder.filename().string() + ".";
    for (int i = 0; i < 6; ++i) name += kLetters[random() % kLetters.size()];
    const fs::path path = folder.parent_path() / (name + ".tmp");
    if (!fs::exists(fs::symlink_status(path, ignored))) return path.string();
  }
}

std::string resolved(const std::string& folder) {
  std::error_code error;
  const fs::path path = fs::canonical(folder, error);
  return error ? folder : path.string();
}

}  // namespace

FolderSwap::FolderSwap(const std::string& destination) : destination_(resolved(destination)) {
  std::error_code error;
  const fs::path parent = fs::path(destination_).parent_path();
  for (fs::path p = parent; !p.empty() && !fs::exists(p, error); p = p.parent_path()) made_.push_back(p.string());
  fs::create_directories(parent, error);
  if (error) fail(parent.string(), error.value());
  const std::string temporary = temporary_beside(destination_);
  fs::create_directory(temporary, error);
  if (error) fail(destination_, error.value());
  temporary_ = temporary;
}

FolderSwap::~FolderSwap() {
  std::error_code ignored;
  if (committed_) return;
  fs::remove_all(temporary_, ignored);
  for (const std::string& folder : made_) fs::remove(folder, ignored);  // unless somebody has put something there
}

void FolderSwap::commit() {
  std::error_code ignored;
  if (!fs::exists(fs::symlink_status(destination_, ignored))) {
    rename_or_fail(temporary_, destination_);
    committed_ = true;
    return;
  }
  std::string old = temporary_;
  if (::renameat2(AT_FDCWD, temporary_.c_str(), AT_FDCWD, destination_.c_str(), RENAME_EXCHANGE) != 0) {
    if (errno != EINVAL && errno != ENOSYS) fail(destination_, errno);
    old = temporary_beside(destination_);
    rename_or_fail(destination_, old);
    rename_or_fail(temporary_, destination_);
  }
  committed_ = true;
  // The mesh is in its place: what cannot be removed is no failure of writing it.
  fs::remove_all(old, ignored);
}

void remove_folder(const std::string& folder) {
  const std::string away = temporary_beside(folder);
  rename_or_fail(folder, away);
  std::error_code error;
  fs::remove_all(away, error);
  if (error) fail(folder, error.value());
}

}  // namespace burnish
