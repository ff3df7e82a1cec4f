// The file of --report.
#pragma once

#include <filesystem>
#include <initializer_list>
#include <optional>
#include <string>
#include <system_error>
#include <vector>

#include "burnish/io/output_file.h"
#include "streams.h"

namespace burnish {

// The folder of a case that is not there yet, for reports that are to lie in it. Empty: none. What stays empty is removed in the end.
class FolderForReports {
 public:
  FolderForReports(const std::string& folder, std::initializer_list<std::string> reports) {
    namespace fs = std::filesystem;
    if (folder.empty()) return;
    const fs::path wanted = fs::absolute(folder).lexically_normal() / "";
    for (const std::string& report : reports) {
      if (report.empty()) continue;
      const fs::path parent = fs::absolute(report).lexically_normal().parent_path();
      if ((parent / "").string().starts_with(wanted.string())) make(parent);
    }
  }
  ~FolderForReports() {
    std::error_code ignored;
    for (auto folder = made_.rbegin(); folder != made_.rend(); ++folder) std::filesystem::remove(*folder, ignored);
  }
  FolderForReports(const FolderForReports&) = delete;
  FolderForReports& operator=(const FolderForReports&) = delete;

 private:
  // Outermost first. What cannot be made is told of by the file that is to be in it.
  void make(const std::filesystem::path& folder) {
    std::error_code error;
    if (std::filesystem::exists(folder, error) || folder.parent_path() == folder) return;
    make(folder.parent_path());
    if (std::filesystem::create_directory(folder, error)) made_.push_back(folder);
  }

  std::vector<std::filesystem::path> made_;
};

// Created before the work, so that a report that cannot be written is known before it and not after. Nothing at all for an empty path.
class ReportFile {
 public:
  ReportFile(const std::string& path, bool overwrite) : path_(path) {
    if (!path.empty()) file_.emplace(path, overwrite);
  }
  // Only if it is wanted.
  void write(const std::string& text) {
    write_text(file_->fd(), path_, text);
    file_->commit();
  }
  bool wanted() const { return file_.has_value(); }

 private:
  std::string path_;
  std::optional<OutputFile> file_;
};

}  // namespace burnish
