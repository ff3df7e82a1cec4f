// TextScanner: words, numbers and lines of a text in memory.
#pragma once

#include <cstdint>
#include <cstring>
#include <optional>
#include <string_view>

namespace burnish {

constexpr bool is_line_end(char c) { return c == '\n' || c == '\r'; }
constexpr bool is_blank(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }

// Reads the decimal number at the start of [begin, end), with an optional sign, as the nearest double:
// infinite when it is too large, zero when too small. "nan" and "inf" are numbers here. Returns the
// position behind it, or nullptr when there is none.
const char* read_number(const char* begin, const char* end, double& value);

// The number that all of `word` is; with `decimal_comma`, one written like "1,5".
std::optional<double> whole_number(std::string_view word, bool decimal_comma = false);

// True for "1,5" and its like.
bool has_decimal_comma(std::string_view word);

// Up to eight letters of a keyword in one integer, upper case folded to lower; 0 for longer words.
constexpr std::uint64_t fold_keyword(std::string_view word) {
  if (word.size() > 8) return 0;
  std::uint64_t key = 0x2020202020202020u;
  for (std::size_t i = 0; i < word.size(); ++i)
    key |= std::uint64_t{static_cast<unsigned char>(word[i])} << (8 * i);
  return key;
}

class TextScanner {
 public:
  explicit TextScanner(std::string_view text) : position_(text.data()), end_(text.data() + text.size()) {}

  const char* position() const { return position_; }
  void move_to(const char* position) { position_ = position; }
  const char* end() const { return end_; }

  void skip_blanks() {
    while (position_ < end_ && is_blank(*position_)) ++position_;
  }
  // True when nothing but blanks is left. Skips them.
  bool at_end() {
    skip_blanks();
    return position_ == end_;
  }
  // The next word, empty at the end. `peek` leaves it there.
  std::string_view peek() {
    skip_blanks();
    const char* p = position_;
    while (p < end_ && !is_blank(*p)) ++p;
    return {position_, static_cast<std::size_t>(p - position_)};
  }
  std::string_view word() {
    const std::string_view w = peek();
    position_ += w.size();
    return w;
  }
  // What is left of the line without blanks around it. Moves to its end, before CR or LF.
  std::string_view rest_of_line() {
    const char* p = position_;
    while (position_ < end_ && !is_line_end(*position_)) ++position_;
    const char* q = position_;
    while (p < q && is_blank(*p)) ++p;
    while (p < q && is_blank(q[-1])) --q;
    return {p, static_cast<std::size_t>(q - p)};
  }
  // Reads a finite number that is a word of its own. Otherwise does not move and returns false.
  bool number(double& value);

 private:
  const char* position_;
  const char* end_;
};

}  // namespace burnish
