// A temporary folder of a test's own, with small helpers for the files in it.
#pragma once

#include <fcntl.h>
#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <cstddef>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <string>

#include "burnish/io/mesh_io.h"
#include "burnish/surface/weld.h"

namespace burnish::test {

class Folder {
 public:
  Folder() {
    std::string path = (std::filesystem::temp_directory_path() / "burnish_test_XXXXXX").string();
    path_ = ::mkdtemp(path.data());
  }
  ~Folder() { std::filesystem::remove_all(path_); }
  Folder(const Folder&) = delete;
  Folder& operator=(const Folder&) = delete;

  std::string path(const std::string& name) const { return path_ / name; }
  bool has(const std::string& name) const { return std::filesystem::exists(path_ / name); }
  std::ptrdiff_t file_count() const { return std::distance(std::filesystem::directory_iterator(path_), {}); }
  std::string bytes(const std::string& name) const {
    std::ifstream in(path_ / name, std::ios::binary);
    return {std::istreambuf_iterator<char>(in), {}};
  }

  // Writes in the format that the name asks for, and returns the path.
  std::string write(const std::string& name, const TriangleSoup& soup) const {
    const int fd = ::open(path(name).c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    EXPECT_GE(fd, 0);
    write_mesh(fd, name, soup, {.format = format_for_writing(name)});
    ::close(fd);
    return path(name);
  }
  TriangleSoup read(const std::string& name) const { return weld(read_mesh(path(name)).soup); }

 private:
  std::filesystem::path path_;
};

}  // namespace burnish::test
