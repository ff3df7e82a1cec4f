#include "stl_colors.h"

#include <algorithm>

namespace burnish {
namespace {

constexpr std::string_view kPartColor = "COLOR=";
constexpr std::uint16_t kFlag = 0x8000;

Color part_color(std::string_view header) {
  const auto byte = [&](std::size_t i) {
    return static_cast<std::uint32_t>(
        static_cast<unsigned char>(header[header.find(kPartColor) + kPartColor.size() + i]));
  };
  return color_of(byte(0), byte(1), byte(2), byte(3));
}

// Five bits widened to eight, and back: to the nearest, so that there and back again is the same.
std::uint32_t widened(std::uint32_t five) { return ((five & 31) * 255 + 15) / 31; }
std::uint32_t narrowed(std::uint32_t eight) { return (eight * 31 + 127) / 255; }

Color magics_color(std::uint16_t a) { return color_of(widened(a), widened(a >> 5u), widened(a >> 10u)); }
Color viscam_color(std::uint16_t a) { return color_of(widened(a >> 10u), widened(a >> 5u), widened(a)); }

bool look_like_viscam(std::span<const std::uint16_t> attributes) {
  if (attributes.empty()) return false;
  const std::uint16_t first = attributes.front();
  const bool uniform =
      std::all_of(attributes.begin(), attributes.end(), [&](std::uint16_t a) { return a == first; });
  if (uniform && first >> 8u == (first & 0xffu)) return false;
  return std::all_of(attributes.begin(), attributes.end(),
                     [](std::uint16_t a) { return a == 0 || (a & kFlag); });
}

std::vector<Color> magics_colors(Color part, std::span<const std::uint16_t> attributes) {
  const bool unset =
      std::all_of(attributes.begin(), attributes.end(), [](std::uint16_t a) { return a == 0; });
  std::vector<Color> colors;
  colors.reserve(attributes.size());
  for (const std::uint16_t a : attributes) colors.push_back(unset || (a & kFlag) ? part : magics_color(a));
  return colors;
}

Color most_frequent(std::span<const Color> colors) {
  std::vector<Color> sorted(colors.begin(), colors.end());
  std::sort(sorted.begin(), sorted.end());
  std::ptrdiff_t most = 0;
  Color result = kNoColor;
  for (auto run = sorted.begin(); run != sorted.end();) {
    const auto end = std::upper_bound(run, sorted.end(), *run);
    if (end - run > most) most = end - run, result = *run;
    run = end;
  }
  return result;
}

}  // namespace

bool has_part_color(std::string_view header) {
  const std::size_t at = header.find(kPartColor);
  return at != header.npos && at + kPartColor.size() + 4 <= header.size();
}

std::string stl_header_text(std::string_view header) {
  std::string_view text = header.substr(0, header.find('\0'));
  text = text.substr(0, text.find(kPartColor));
  return std::string(text.substr(0, text.find_last_not_of(" \t\r\n") + 1));
}

std::vector<Color> colors_of_attributes(std::string_view header, std::span<const std::uint16_t> attributes) {
  std::vector<Color> colors;
  if (has_part_color(header)) {
    colors = magics_colors(part_color(header), attributes);
  } else if (look_like_viscam(attributes)) {
    colors.reserve(attributes.size());
    for (const std::uint16_t a : attributes) colors.push_back(a & kFlag ? viscam_color(a) : kNoColor);
  }
  const bool none = std::all_of(colors.begin(), colors.end(), [](Color c) { return c == kNoColor; });
  return none ? std::vector<Color>{} : colors;
}

ColorAttributes::ColorAttributes(std::span<const Color> colors) {
  if (std::find(colors.begin(), colors.end(), kNoColor) == colors.end()) part_ = most_frequent(colors);
}

std::string ColorAttributes::header_suffix() const {
  if (part_ == kNoColor) return {};
  std::string suffix(kPartColor);
  for (int i = 0; i < 4; ++i) suffix += static_cast<char>(channel(part_, i));
  return suffix;
}

std::uint16_t ColorAttributes::operator()(Color color) const {
  const bool by_viscam = part_ == kNoColor;
  if (by_viscam ? color == kNoColor : color == part_) return by_viscam ? 0 : kFlag;
  const std::uint32_t red = narrowed(channel(color, 0)), green = narrowed(channel(color, 1)),
                      blue = narrowed(channel(color, 2));
  return static_cast<std::uint16_t>(by_viscam ? kFlag | red << 10 | green << 5 | blue
                                              : red | green << 5 | blue << 10);
}

}  // namespace burnish
