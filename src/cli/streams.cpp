#include "streams.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <system_error>

#include "burnish/core/error.h"

namespace burnish {
namespace {

// Empties `text` into `fd`; returns 0 or the error number.
int write_all(int fd, std::string_view text) noexcept {
  while (!text.empty()) {
    const ssize_t written = ::write(fd, text.data(), text.size());
    if (written < 0 && errno == EINTR) continue;
    if (written < 0) return errno;
    text.remove_prefix(static_cast<std::size_t>(written));
  }
  return 0;
}

}  // namespace

void occupy_standard_streams() {
  for (int fd = 0; fd <= 2; ++fd) {
    if (::fcntl(fd, F_GETFD) >= 0) continue;
    // The lowest free descriptor is `fd` itself. Opened the wrong way round: reading or writing fails.
    if (::open("/dev/null", fd == 0 ? O_WRONLY : O_RDONLY) != fd) return;
  }
}

bool is_terminal(int fd) { return ::isatty(fd) == 1; }

void write_text(int fd, const std::string& label, std::string_view text) {
  const int failure = write_all(fd, text);
  if (failure == 0) return;
  throw Error(ErrorCode::unwritable_output,
              fmt::format("{}: cannot write: {}", label, std::generic_category().message(failure)), "look at where it goes to: a disk that is full, or a program that has ended");
}

void write_stdout(std::string_view text) { write_text(STDOUT_FILENO, "standard output", text); }

void write_stdout_if_possible(std::string_view text) noexcept { write_all(STDOUT_FILENO, text); }

void write_stderr(std::string_view text) noexcept { write_all(STDERR_FILENO, text); }

}  // namespace burnish
