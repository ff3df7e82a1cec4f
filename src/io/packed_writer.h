// PackedWriter: bytes to a file, gzipped if asked to.
#pragma once

#include <zlib.h>

#include <array>
#include <charconv>
#include <string>
#include <string_view>

#include "burnish/io/output_file.h"
#include "fd_writer.h"

namespace burnish {

// Numbers as text are the shortest that read back as the same one. Throws Error{unwritable_output} as FdWriter does.
class PackedWriter {
 public:
  PackedWriter(const OutputFile& file, bool compressed);
  ~PackedWriter();
  PackedWriter(const PackedWriter&) = delete;
  PackedWriter& operator=(const PackedWriter&) = delete;

  void put(std::string_view bytes) { compressed_ ? gather(bytes) : out_.put(bytes); }
  template <class Number>
  void put_number(Number value) {
    std::array<char, 32> digits;
    put({digits.data(), static_cast<std::size_t>(std::to_chars(digits.data(), digits.data() + digits.size(), value).ptr - digits.data())});
  }
  // The bytes of a number as they are in memory.
  template <class Number>
  void put_raw(Number value) {
    put({reinterpret_cast<const char*>(&value), sizeof value});
  }
  // What was not finished is lost.
  void finish();

 private:
  void gather(std::string_view bytes);
  void squeeze(int flush);

  std::string label_;
  FdWriter out_;
  bool compressed_;
  std::string waiting_;
  z_stream stream_{};
};

}  // namespace burnish
