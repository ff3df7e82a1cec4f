#include "made_folders.h"

#include <fmt/format.h>

#include <system_error>

#include "burnish/core/error.h"

namespace burnish {
namespace {

namespace fs = std::filesystem;

fs::path folder_of(const std::string& file) { return fs::absolute(file).lexically_normal().parent_path(); }

}  // namespace

MadeFolders::~MadeFolders() {
  std::error_code ignored;
  for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) fs::remove(*folder, ignored);
}

void MadeFolders::make_for(const std::string& file) {
  if (!file.empty()) make(folder_of(file));
}

void MadeFolders::make_for(const std::string& file, const std::string& place) try {
  if (file.empty()) return;
  const fs::path folder = folder_of(file), within = fs::absolute(place).lexically_normal() / "";
  if ((folder / "").string().starts_with(within.string())) make(folder);
} catch (const Error&) {  // told of by the file
}

// Outermost first.
void MadeFolders::make(const fs::path& folder) {
  std::error_code error;
  if (fs::is_directory(folder, error) || folder.parent_path() == folder) return;
  make(folder.parent_path());
  if (fs::create_directory(folder, error)) made_.push_back(folder);
  if (error) throw Error(ErrorCode::unwritable_output, fmt::format("{}: the folder cannot be made: {}", folder.string(), error.message()), "name another folder");
}

}  // namespace burnish
