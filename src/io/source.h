// Source: the bytes a reader works on, and how it complains about them.
#pragma once

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

#include "burnish/core/error.h"

namespace burnish {

inline constexpr std::string_view kSalvageHint = "re-export the file, or pass --salvage to use what is there";

struct Source {
  std::string_view bytes;
  std::string label;  // the file's name in messages
  bool salvage = false;
  bool is_text = true;  // places are lines of a text, or else bytes

  const char* begin() const { return bytes.data(); }
  const char* end() const { return bytes.data() + bytes.size(); }

  // "line 12" or "byte 1284". Lines end in LF, CR or CRLF; they are counted only here, where it
  // matters, and not while reading.
  std::string place(const char* at) const;

  // Throws Error{unreadable_input}: "label: message".
  [[noreturn]] void fail(const std::string& message, std::string_view hint = kSalvageHint) const;
  // Throws Error{unreadable_input}: "label: place: message".
  [[noreturn]] void fail_at(const char* at, const std::string& message,
                            std::string_view hint = kSalvageHint) const;
};

// `bytes` in quotes for a message: cut to a readable length, everything but printable ASCII escaped.
std::string quoted(std::string_view bytes);

// "1 facet", "2 facets".
std::string counted(std::size_t n, std::string_view noun, std::string_view plural = {});

// Counts one kind of irregularity and remembers where it was first seen.
class Tally {
 public:
  void add(const char* at) {
    if (count_++ == 0) first_ = at;
  }
  std::size_t count() const { return count_; }
  const char* first() const { return first_; }

 private:
  std::size_t count_ = 0;
  const char* first_ = nullptr;
};

}  // namespace burnish
