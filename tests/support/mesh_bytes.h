// Small mesh files in memory, for the tests of the readers.
#pragma once

#include <gtest/gtest.h>
#include <stdlib.h>
#include <unistd.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <initializer_list>
#include <span>
#include <string>
#include <vector>

#include "burnish/core/error.h"
#include "burnish/io/mesh_io.h"

namespace burnish::test {

// Whether `text` contains all of `parts`; shows the text when it does not.
inline ::testing::AssertionResult contains(const std::string& text,
                                           std::initializer_list<std::string> parts) {
  for (const std::string& part : parts)
    if (text.find(part) == std::string::npos)
      return ::testing::AssertionFailure() << "no \"" << part << "\" in \"" << text << '"';
  return ::testing::AssertionSuccess();
}

using Triangle = std::array<Vec3, 3>;

inline std::vector<Triangle> tetrahedron() {
  const Vec3 o{0, 0, 0}, x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  return {{o, y, x}, {o, x, z}, {o, z, y}, {x, y, z}};
}

template <class T>
void append_raw(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof value);
}

// A binary STL that promises `count` facets and holds `triangles`. Attributes repeat; by default they are
// junk.
inline std::string binary_stl(const std::vector<Triangle>& triangles, std::uint32_t count,
                              std::string header = "test",
                              const std::vector<std::uint16_t>& attributes = {0x2020}) {
  header.resize(80, '\0');
  append_raw(header, count);
  std::size_t facet = 0;
  for (const Triangle& t : triangles) {
    for (int i = 0; i < 3; ++i) append_raw(header, 0.0f);
    for (const Vec3& p : t)
      for (int axis = 0; axis < 3; ++axis) append_raw(header, static_cast<float>(p[axis]));
    append_raw(header, attributes[facet++ % attributes.size()]);
  }
  return header;
}

inline std::string binary_stl(const std::vector<Triangle>& triangles) {
  return binary_stl(triangles, static_cast<std::uint32_t>(triangles.size()));
}

inline MeshFile read_text(const std::string& bytes, const std::string& label = "test.stl",
                          bool salvage = false) {
  return read_mesh(std::as_bytes(std::span(bytes)), label, {salvage});
}

// The bytes that write_mesh gives.
inline std::string written(const TriangleSoup& soup, const MeshWriteOptions& options) {
  std::string path = (std::filesystem::temp_directory_path() / "burnish_io_XXXXXX").string();
  const int fd = ::mkstemp(path.data());
  ::unlink(path.c_str());
  write_mesh(fd, "test", soup, options);
  std::string bytes(static_cast<std::size_t>(::lseek(fd, 0, SEEK_END)), '\0');
  EXPECT_EQ(::pread(fd, bytes.data(), bytes.size(), 0), static_cast<ssize_t>(bytes.size()));
  ::close(fd);
  return bytes;
}

// The error that reading gives: its message and, after a bar, its hint. Empty when there was none.
inline std::string read_error(const std::string& bytes, const std::string& label = "test.stl",
                              bool salvage = false) {
  try {
    read_text(bytes, label, salvage);
  } catch (const Error& error) {
    return std::string(error.what()) + " | " + error.hint();
  }
  return {};
}

// The corners of all facets in order, whatever the numbering of points.
inline std::vector<Triangle> triangles_of(const TriangleSoup& soup) {
  std::vector<Triangle> triangles;
  for (std::size_t f = 0; f < soup.facets.size(); ++f)
    triangles.push_back({soup.corner(f, 0), soup.corner(f, 1), soup.corner(f, 2)});
  return triangles;
}

}  // namespace burnish::test
