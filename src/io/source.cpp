#include "source.h"

#include <fmt/format.h>

namespace burnish {
namespace {

std::size_t line_number(const char* begin, const char* at) {
  std::size_t line = 1;
  for (const char* p = begin; p < at; ++p)
    if (*p == '\n' || (*p == '\r' && !(p + 1 < at && p[1] == '\n'))) ++line;
  return line;
}

}  // namespace

std::string Source::place(const char* at) const {
  if (is_text) return fmt::format("line {}", line_number(begin(), at));
  return fmt::format("byte {}", at - begin());
}

void Source::fail(const std::string& message, std::string_view hint) const {
  throw Error(ErrorCode::unreadable_input, label + ": " + message, std::string(hint));
}

void Source::fail_at(const char* at, const std::string& message, std::string_view hint) const {
  fail(place(at) + ": " + message, hint);
}

std::string quoted(std::string_view bytes) {
  constexpr std::size_t kLongest = 40;
  std::string out = "'";
  for (const char c : bytes.substr(0, kLongest)) {
    if (c >= 0x20 && c < 0x7f)
      out += c;
    else
      out += fmt::format("\\x{:02x}", static_cast<unsigned char>(c));
  }
  return out + (bytes.size() > kLongest ? "...'" : "'");
}

std::string counted(std::size_t n, std::string_view noun, std::string_view plural) {
  if (n == 1) return fmt::format("1 {}", noun);
  return plural.empty() ? fmt::format("{} {}s", n, noun) : fmt::format("{} {}", n, plural);
}

}  // namespace burnish
