#include "burnish/core/length.h"

#include <charconv>
#include <cmath>

namespace burnish {
namespace {

// Reads a non-negative finite number from the front of `text` and drops it there.
std::optional<double> take_number(std::string_view& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc{} || !std::isfinite(value) || std::signbit(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

}  // namespace

std::optional<Length> parse_length(std::string_view text, const std::optional<ModelUnit>& unit) {
  const auto value = take_number(text);
  if (!value) return std::nullopt;
  if (text.empty()) return Length{*value, LengthUnit::model};
  if (text == "%") return Length{*value, LengthUnit::percent_of_diagonal};
  if (text == "h") return Length{*value, LengthUnit::cells};
  if (const auto given = model_unit(text); unit && given) return Length{converted(*value, *given, *unit), LengthUnit::model};
  return std::nullopt;
}

std::optional<unsigned long long> parse_bytes(std::string_view text) {
  const auto value = take_number(text);
  if (!value || *value <= 0) return std::nullopt;
  double scale = 1;
  if (!text.empty()) {
    constexpr std::string_view kSuffixes = "kmgt";
    const char lower = static_cast<char>(text[0] | 0x20);
    const std::size_t power = kSuffixes.find(lower);
    if (power != std::string_view::npos) {
      scale = std::ldexp(1.0, 10 * (static_cast<int>(power) + 1));
      text.remove_prefix(1);
    }
    if (!text.empty() && text != "B" && text != "iB" && text != "b") return std::nullopt;
  }
  const double bytes = *value * scale;
  if (bytes < 1 || bytes > 9e18) return std::nullopt;
  return static_cast<unsigned long long>(bytes);
}

}  // namespace burnish
