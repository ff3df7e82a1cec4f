#include "values.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <optional>

#include "burnish/core/error.h"
#include "suggest.h"

namespace burnish {
namespace {

constexpr std::string_view kLengthHint =
    "lengths are written as 0.5 (the model's units), 0.2% (of the diagonal) or 2h (cells)";

[[noreturn]] void refuse(const GivenValue& given, std::string_view complaint, std::string_view hint) {
  throw Error(ErrorCode::usage, fmt::format("{} {}: {}", given.name, given.text, complaint),
              std::string(hint));
}

// All of the text as a finite number.
std::optional<double> number_in(std::string_view text) {
  double value = 0;
  const char* const end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end && std::isfinite(value) ? std::optional(value) : std::nullopt;
}

// A number and the name of a unit.
bool ends_with_unit(std::string_view text) {
  const std::size_t letters = text.find_last_not_of("abcdefghijklmnopqrstuvwxyz") + 1;
  return letters > 0 && parse_length(text.substr(0, letters)) && model_unit(text.substr(letters));
}

[[noreturn]] void refuse_length(const GivenValue& given) {
  if (given.text.starts_with('-')) refuse(given, "a length must be greater than zero", "for example 0.5 (the model's units) or 0.2% (of the diagonal)");
  if (given.text.find(',') != std::string_view::npos) {
    refuse(given, "not a length", "numbers have a decimal point, not a comma: 0.5");
  }
  if (!given.unit && ends_with_unit(given.text)) {
    refuse(given, "not a length", "leave the unit out: a plain number is in the model's own units; or say what these are, such as --units mm");
  }
  refuse(given, "not a length", given.unit ? fmt::format("{}, or with a unit: 0.5{}", kLengthHint, name(*given.unit)) : std::string(kLengthHint));
}

}  // namespace

Length positive_length(const GivenValue& given) {
  const auto length = parse_length(given.text, given.unit);
  if (!length) refuse_length(given);
  if (!(length->value > 0)) refuse(given, "a length must be greater than zero", "for example 0.5 (the model's units) or 0.2% (of the diagonal)");
  return *length;
}

Length length_without_cells(const GivenValue& given) {
  const Length length = positive_length(given);
  if (length.unit == LengthUnit::cells) {
    refuse(given, "this length cannot be given in cells",
           "write it as 0.5 (the model's units) or 0.2% (of the diagonal)");
  }
  return length;
}

VolumeLimit volume_limit(const GivenValue& given) {
  const bool percent = given.text.ends_with('%');
  const GivenValue digits = given.part(percent ? given.text.substr(0, given.text.size() - 1) : given.text);
  return {non_negative_number(digits), percent};
}

std::size_t place_among(const GivenValue& given, const std::vector<std::string>& words) {
  const auto at = std::find(words.begin(), words.end(), given.text);
  if (at != words.end()) return static_cast<std::size_t>(at - words.begin());
  const auto near = nearest(given.text, words);
  refuse(given, fmt::format("expected one of {}", fmt::join(words, ", ")), near ? fmt::format("did you mean '{}'?", *near) : std::string("--help tells what each of them does"));
}

std::size_t place_among(const GivenValue& given) { return place_among(given, {given.words.begin(), given.words.end()}); }

bool is_listed(const GivenValue& given) { return std::find(given.words.begin(), given.words.end(), given.text) != given.words.end(); }

std::uint64_t integer_within(const GivenValue& given, std::uint64_t least, std::uint64_t most) {
  std::uint64_t value = 0;
  const char* const end = given.text.data() + given.text.size();
  const auto [stop, error] = std::from_chars(given.text.data(), end, value);
  if (error != std::errc{} || stop != end || value < least || value > most) {
    refuse(given, fmt::format("expected a whole number from {} to {}", least, most), fmt::format("write it in digits alone, such as {} {}", given.name, std::max<std::uint64_t>(least, 1)));
  }
  return value;
}

double finite_number(const GivenValue& given) {
  const std::optional<double> value = number_in(given.text);
  if (!value) refuse(given, "expected a number", "write it with a decimal point and without a unit, such as 0.5");
  return *value;
}

double non_negative_number(const GivenValue& given) {
  const std::optional<double> value = number_in(given.text);
  if (!value || *value < 0) refuse(given, "expected a number that is not negative", "write 0 or more, with a decimal point and without a unit, such as 0.5");
  return *value;
}

double positive_number(const GivenValue& given) {
  const double value = non_negative_number(given);
  if (!(value > 0)) refuse(given, "expected a number greater than zero", "write it with a decimal point and without a unit, such as 0.5");
  return value;
}

std::uint64_t byte_count(const GivenValue& given) {
  const auto bytes = parse_bytes(given.text);
  if (!bytes) refuse(given, "not an amount of memory", "write it as 800M or 4G");
  return *bytes;
}

std::vector<std::string_view> parts_of(std::string_view list) {
  std::vector<std::string_view> result;
  for (std::size_t comma = list.find(','); comma != std::string_view::npos; comma = list.find(',')) {
    result.push_back(list.substr(0, comma));
    list.remove_prefix(comma + 1);
  }
  result.push_back(list);
  return result;
}

Box3 box_of(const GivenValue& given) {
  std::vector<double> numbers;
  for (const std::string_view part : parts_of(given.text)) numbers.push_back(finite_number(given.part(part)));
  const auto refuse_box = [&](std::string_view expected) { refuse(given, fmt::format("expected {}", expected), "for example 0,0,0,10,10,20"); };
  if (numbers.size() != 6) refuse_box("six numbers, xmin,ymin,zmin,xmax,ymax,zmax");
  Box3 result;
  result.lower = {numbers[0], numbers[1], numbers[2]}, result.upper = {numbers[3], numbers[4], numbers[5]};
  for (int a = 0; a < 3; ++a)
    if (result.lower[a] > result.upper[a]) refuse_box("lower corners first");
  return result;
}

std::vector<std::pair<std::string, std::string_view>> named_values(const GivenValue& given, std::string_view example) {
  std::vector<std::pair<std::string, std::string_view>> values;
  for (const std::string_view part : parts_of(given.text)) {
    const std::size_t equals = part.rfind('=');
    if (equals == part.npos || equals == 0) refuse(given, fmt::format("expected NAME=V, found '{}'", part), fmt::format("for example {}", example));
    values.emplace_back(std::string(part.substr(0, equals)), part.substr(equals + 1));
  }
  return values;
}

Value redistance_methods(std::string_view name) { return word(name, {"closest", "fmm", "pde-weno5", "pde-first"}); }

Setter switch_on(bool& flag) {
  return [&flag](const GivenValue&) { flag = true; };
}

Setter store_text(std::string& text) {
  return [&text](const GivenValue& given) {
    if (given.text.empty()) throw Error(ErrorCode::usage, fmt::format("{} is empty", given.name), "name a file, or leave it out");
    text = given.text;
  };
}

}  // namespace burnish
