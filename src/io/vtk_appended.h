// VtkAppended: VTK's XML with its arrays behind the text, raw and compressed.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

#include "fd_writer.h"

namespace burnish {

// First the text, in which arrays are announced; then, in the same order, their bytes. Where an array begins is known only
// once those before it are compressed, so the text has room for it that is filled in afterwards: the file must be able to seek.
//
// An array is a table (count of blocks, their size, that of the last one if it is shorter, then the size of each once
// compressed; 64-bit) and its blocks, each a zlib stream. Blocks are compressed in parallel, and are the same for any
// number of threads.
class VtkAppended {
 public:
  VtkAppended(int fd, const std::string& label) : out_(fd, label), fd_(fd), label_(label) {}

  void text(std::string_view text);
  // A DataArray of one component (Points: three). `numbers` is what NumberOfTuples counts.
  void announce(std::string_view type, std::string_view name, std::size_t tuples, int components = 1);
  // Ends the text; arrays follow.
  void begin_data();

  // The next array announced, of so many bytes, which `put` brings in any portions.
  void begin_array(std::size_t bytes);
  void put(const void* bytes, std::size_t size);
  void end_array();

  // Ends the file.
  void finish();

 private:
  static constexpr std::size_t kBlock = std::size_t{1} << 18;
  static constexpr std::size_t kBatch = 64;  // blocks compressed at once

  void compress_batch();
  void put_at(std::uint64_t position, const void* bytes, std::size_t size);

  FdWriter out_;
  int fd_;
  std::string label_;
  std::uint64_t position_ = 0;            // bytes put so far
  std::uint64_t data_ = 0;                // position of the first array
  std::vector<std::uint64_t> offsets_;    // where the text has room for each array's offset
  std::size_t next_ = 0;                  // array
  std::uint64_t array_ = 0;               // position of the running array
  std::vector<std::uint64_t> table_;      // the running array's
  std::size_t compressed_ = 0;            // blocks of it
  std::vector<char> waiting_;             // bytes of it
};

}  // namespace burnish
