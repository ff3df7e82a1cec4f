#include "fd_writer.h"

#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <charconv>

#include "burnish/core/error.h"
#include "system_hint.h"

namespace burnish {

void FdWriter::put(std::string_view text) {
  while (!text.empty()) {
    const std::size_t n = std::min(text.size(), kLargest);
    std::memcpy(reserve(n), text.data(), n);
    commit(n);
    text.remove_prefix(n);
  }
}

template <class Number>
void FdWriter::put_number(Number value) {
  constexpr std::size_t kLongest = 40;
  char* begin = reserve(kLongest);
  commit(static_cast<std::size_t>(std::to_chars(begin, begin + kLongest, value).ptr - begin));
}
template void FdWriter::put_number(double);
template void FdWriter::put_number(float);
template void FdWriter::put_number(std::size_t);

void FdWriter::flush() {
  std::size_t done = 0;
  while (done < used_) {
    const ssize_t n = ::write(fd_, buffer_.data() + done, used_ - done);
    if (n >= 0) {
      done += static_cast<std::size_t>(n);
    } else if (errno != EINTR) {
      throw Error(ErrorCode::unwritable_output, label_ + ": cannot be written: " + std::strerror(errno), write_hint(errno));
    }
  }
  used_ = 0;
}

}  // namespace burnish
