// FdWriter: a buffer in front of a file descriptor.
#pragma once

#include <cstddef>
#include <cstring>
#include <string>
#include <string_view>
#include <vector>

namespace burnish {

// Interrupted and short writes are continued; every other refusal of the system (disk full, closed
// pipe) throws Error{unwritable_output} naming `label` and the reason. A closed pipe only arrives here
// as an error in programs that ignore SIGPIPE. What was not flushed when the writer dies is lost.
class FdWriter {
 public:
  FdWriter(int fd, std::string label) : fd_(fd), label_(std::move(label)), buffer_(kCapacity) {}

  // Room for `size` <= kLargest bytes, to be filled at once and handed over with `commit`.
  char* reserve(std::size_t size) {
    if (kCapacity - used_ < size) flush();
    return buffer_.data() + used_;
  }
  void commit(std::size_t size) { used_ += size; }

  void put(std::string_view text);
  // The shortest decimal that reads back as the same number.
  void put(double value) { put_number(value); }
  void put(float value) { put_number(value); }
  void put(std::size_t value) { put_number(value); }
  // The bytes of a number as they are in memory.
  template <class T>
  void put_raw(T value) {
    std::memcpy(reserve(sizeof value), &value, sizeof value);
    commit(sizeof value);
  }
  void flush();

  static constexpr std::size_t kLargest = 4096;

 private:
  static constexpr std::size_t kCapacity = std::size_t{1} << 18;

  template <class Number>
  void put_number(Number value);

  int fd_;
  std::string label_;
  std::vector<char> buffer_;
  std::size_t used_ = 0;
};

}  // namespace burnish
