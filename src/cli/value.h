// What the value of an option or an operand is. Its setter, completion and the manuals read one description.
#pragma once

#include <string_view>
#include <utility>
#include <vector>

namespace burnish {

// Converts from a plain name, such as "NAME": then it is any text.
struct Value {
  enum class Kind {
    text,       // nothing that could be offered
    file,       // its name ends in one of `words`, or in anything when there are none
    folder,
    word,       // one of `words`
    word_list,  // some of `words`, between commas
    named_word, // NAME=W,NAME=W with some of `words`
    length,     // 0.5, 0.2% or 2h, or one of `words`
    number,     // or one of `words`
    count,      // a whole number
    bytes,      // 800M
  };

  Value(const char* shown) : name(shown) {}
  Value(std::string_view shown, Kind what, std::vector<std::string_view> list = {}) : name(shown), kind(what), words(std::move(list)) {}

  // Of an option: there is no value, it is a switch.
  bool empty() const { return name.empty(); }

  std::string_view name;  // what stands for it in help, e.g. "FILE"
  Kind kind = Kind::text;
  std::vector<std::string_view> words;  // as they are typed; of a file: suffixes, with their dot
};

inline Value file(std::string_view name, std::vector<std::string_view> suffixes = {}) { return {name, Value::Kind::file, std::move(suffixes)}; }
inline Value folder(std::string_view name) { return {name, Value::Kind::folder}; }
inline Value word(std::string_view name, std::vector<std::string_view> words) { return {name, Value::Kind::word, std::move(words)}; }
inline Value word_list(std::string_view name, std::vector<std::string_view> words) { return {name, Value::Kind::word_list, std::move(words)}; }
inline Value named_word(std::string_view name, std::vector<std::string_view> words) { return {name, Value::Kind::named_word, std::move(words)}; }
inline Value length(std::string_view name, std::vector<std::string_view> words = {}) { return {name, Value::Kind::length, std::move(words)}; }
inline Value number(std::string_view name, std::vector<std::string_view> words = {}) { return {name, Value::Kind::number, std::move(words)}; }
inline Value count(std::string_view name) { return {name, Value::Kind::count}; }
inline Value bytes(std::string_view name) { return {name, Value::Kind::bytes}; }

}  // namespace burnish
