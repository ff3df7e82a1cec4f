// What a run shows in a viewer, .vtp or .ply, on its way out.
#pragma once

#include <cstdint>
#include <string>

#include "burnish/io/marked_cells.h"
#include "burnish/io/output_file.h"
#include "burnish/io/point_data.h"

namespace burnish {

// Created before the work: a file that cannot be written is to be known before it, not after.
class ViewerFile {
 public:
  // Throws Error as marked_format_for_writing and OutputFile do.
  ViewerFile(const std::string& path, bool overwrite) : format_(marked_format_for_writing(path)), file_(path, overwrite) {}

  MarkedFormat format() const { return format_; }

  // Write, and give the file its name. Return its size in bytes.
  std::uint64_t write(const PointData& data) {
    write_point_data(file_.fd(), file_.destination(), data, format_);
    return commit();
  }
  std::uint64_t write(const MarkedCells& cells) {
    write_marked_cells(file_.fd(), file_.destination(), cells, format_);
    return commit();
  }

 private:
  std::uint64_t commit() {
    const std::uint64_t bytes = file_.bytes();
    file_.commit();
    return bytes;
  }

  MarkedFormat format_;
  OutputFile file_;
};

}  // namespace burnish
