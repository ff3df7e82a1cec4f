// The file of --report.
#pragma once

#include <optional>
#include <string>

#include "burnish/io/output_file.h"
#include "streams.h"

namespace burnish {

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
