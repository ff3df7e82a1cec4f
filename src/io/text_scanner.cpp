#include "text_scanner.h"

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <string>

namespace burnish {
namespace {

// Powers of ten that are exact in double.
constexpr std::array<double, 23> kPowersOfTen{1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};

constexpr bool is_digit(char c) { return static_cast<unsigned char>(c - '0') < 10; }

// A plain decimal as digits * 10^exponent. `end` is null when it is none or has too many digits.
struct Decimal {
  std::uint64_t digits = 0;
  int exponent = 0;
  const char* end = nullptr;
};

const char* scan_exponent(const char* p, const char* end, int& exponent) {
  const bool negative = p < end && *p == '-';
  if (p < end && (*p == '-' || *p == '+')) ++p;
  const char* first = p;
  int value = 0;
  while (p < end && is_digit(*p) && p - first < 4) value = 10 * value + (*p++ - '0');
  if (p == first || (p < end && is_digit(*p))) return nullptr;
  exponent += negative ? -value : value;
  return p;
}

Decimal scan_decimal(const char* p, const char* end) {
  Decimal d;
  const char* first = p;
  while (p < end && is_digit(*p)) d.digits = 10 * d.digits + static_cast<std::uint64_t>(*p++ - '0');
  std::ptrdiff_t count = p - first;
  if (p < end && *p == '.') {
    const char* fraction = ++p;
    while (p < end && is_digit(*p)) d.digits = 10 * d.digits + static_cast<std::uint64_t>(*p++ - '0');
    count += p - fraction;
    if (count <= 19) d.exponent = static_cast<int>(fraction - p);
  }
  if (count == 0 || count > 19) return d;  // 20 digits may have wrapped around
  if (p < end && (*p == 'e' || *p == 'E')) p = scan_exponent(p + 1, end, d.exponent);
  d.end = p;
  return d;
}

// Clinger's fast path: both factors are exact, so that the one rounding gives the nearest double.
bool is_exact(const Decimal& d) {
  return d.end && d.digits <= (std::uint64_t{1} << 53) && d.exponent >= -22 && d.exponent <= 22;
}

double exact_value(const Decimal& d) {
  const double digits = static_cast<double>(d.digits);
  if (d.exponent < 0) return digits / kPowersOfTen[static_cast<std::size_t>(-d.exponent)];
  return digits * kPowersOfTen[static_cast<std::size_t>(d.exponent)];
}

// from_chars does not say on which side a number is out of range: the place of its first digit that
// is not zero does, for no exponent within reach of ambiguity is out of range.
double out_of_range(const char* p, const char* end) {
  std::ptrdiff_t magnitude = 0;
  bool seen_point = false, seen_digit = false;
  for (; p < end && *p != 'e' && *p != 'E'; ++p) {
    if (*p == '.')
      seen_point = true;
    else if (!seen_point && (seen_digit || *p != '0'))
      seen_digit = true, ++magnitude;
    else if (seen_point && !seen_digit && *p == '0')
      --magnitude;
    else
      seen_digit = true;
  }
  if (p == end) return magnitude > 0 ? std::numeric_limits<double>::infinity() : 0;
  const bool negative = ++p < end && *p == '-';
  std::ptrdiff_t exponent = 0;
  for (; p < end; ++p)
    if (is_digit(*p) && exponent < std::numeric_limits<std::ptrdiff_t>::max() / 32)
      exponent = 10 * exponent + (*p - '0');
  return magnitude + (negative ? -exponent : exponent) > 0 ? std::numeric_limits<double>::infinity() : 0;
}

}  // namespace

const char* read_number(const char* begin, const char* end, double& value) {
  const bool negative = begin < end && *begin == '-';
  const char* p = begin < end && (*begin == '-' || *begin == '+') ? begin + 1 : begin;
  if (p == end || *p == '-') return nullptr;
  if (const Decimal d = scan_decimal(p, end); is_exact(d)) {
    value = negative ? -exact_value(d) : exact_value(d);
    return d.end;
  }
  double magnitude = 0;
  const auto [behind, error] = std::from_chars(p, end, magnitude);
  if (error == std::errc::invalid_argument) return nullptr;
  if (error == std::errc::result_out_of_range) magnitude = out_of_range(p, behind);
  value = negative ? -magnitude : magnitude;
  return behind;
}

bool has_decimal_comma(std::string_view word) {
  const std::size_t comma = word.find(',');
  return comma != word.npos && word.find('.') == word.npos && whole_number(word, true).has_value();
}

std::optional<double> whole_number(std::string_view word, bool decimal_comma) {
  double value = 0;
  if (const std::size_t comma = word.find(','); decimal_comma && comma != word.npos) {
    std::string with_point(word);
    with_point[comma] = '.';
    return whole_number(with_point);
  }
  const char* end = word.data() + word.size();
  if (read_number(word.data(), end, value) != end || word.empty()) return std::nullopt;
  return value;
}

bool TextScanner::number(double& value) {
  skip_blanks();
  const char* behind = read_number(position_, end_, value);
  if (!behind || (behind < end_ && !is_blank(*behind)) || !std::isfinite(value)) return false;
  position_ = behind;
  return true;
}

}  // namespace burnish
