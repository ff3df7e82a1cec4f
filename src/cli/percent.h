// How summaries print shares.
#pragma once

#include <fmt/format.h>

#include <cmath>
#include <string>

namespace burnish {

// Two digits, or all before the point: "0.12 %", "100 %". `sign`: "+12 %" too.
inline std::string percent(double value, bool sign = false) {
  const bool whole = std::abs(value) >= 99.5;
  if (sign) return whole ? fmt::format("{:+.0f} %", value) : fmt::format("{:+.2g} %", value);
  return whole ? fmt::format("{:.0f} %", value) : fmt::format("{:.2g} %", value);
}

}  // namespace burnish
