#include "html_encode.h"

#include <zlib.h>

#include <algorithm>
#include <cmath>

#include "burnish/core/error.h"

namespace burnish {
namespace {

constexpr double kLargest = 65535;
constexpr double kLargestSigned = 32767;
constexpr int kLevel = 6;  // of zlib: 9 takes twice as long for 1 % of the size

std::uint16_t zigzag(std::uint16_t difference) {
  return static_cast<std::uint16_t>((difference << 1) ^ (difference & 0x8000 ? 0xffff : 0));
}

std::string base64(const Bytes& bytes) {
  static constexpr char kDigits[] = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    const auto byte = [&](std::size_t k) { return i + k < bytes.size() ? std::uint32_t{bytes[i + k]} : 0u; };
    const std::uint32_t three = byte(0) << 16 | byte(1) << 8 | byte(2);
    for (std::size_t k = 0; k < 4; ++k) text += i + k <= bytes.size() ? kDigits[three >> (18 - 6 * k) & 63] : '=';
  }
  return text;
}

}  // namespace

Quantisation Quantisation::of(const Box3& box) {
  if (box.empty()) return {};
  return {box.lower, box.extent() / kLargest};
}

std::array<std::uint16_t, 3> Quantisation::operator()(const Vec3& p) const {
  std::array<std::uint16_t, 3> q{};
  for (int axis = 0; axis < 3; ++axis)
    if (step[axis] > 0) q[static_cast<std::size_t>(axis)] = static_cast<std::uint16_t>(std::clamp(std::round((p[axis] - lower[axis]) / step[axis]), 0.0, kLargest));
  return q;
}

TriangleSoup ordered_by_first_use(const TriangleSoup& soup) {
  TriangleSoup ordered;
  ordered.facets = soup.facets;
  std::vector<std::uint32_t> place(soup.points.size(), kNoFacet);
  for (Facet& facet : ordered.facets)
    for (std::uint32_t& point : facet) {
      std::uint32_t& p = place[point];
      if (p == kNoFacet) {
        p = static_cast<std::uint32_t>(ordered.points.size());
        ordered.points.push_back(soup.points[point]);
      }
      point = p;
    }
  return ordered;
}

Bytes packed_tuples(std::span<const std::uint16_t> values, std::size_t channels) {
  const std::size_t n = values.size() / channels;
  Bytes bytes(2 * values.size());
  for (std::size_t c = 0; c < channels; ++c) {
    std::uint16_t last = 0;
    for (std::size_t i = 0; i < n; ++i) {
      const std::uint16_t value = values[i * channels + c], code = zigzag(static_cast<std::uint16_t>(value - last));
      bytes[2 * c * n + i] = static_cast<std::uint8_t>(code & 0xff);
      bytes[(2 * c + 1) * n + i] = static_cast<std::uint8_t>(code >> 8);
      last = value;
    }
  }
  return bytes;
}

Bytes packed_indices(std::span<const Facet> facets) {
  Bytes bytes;
  bytes.reserve(6 * facets.size());
  std::uint32_t next = 0;
  for (const Facet& facet : facets)
    for (const std::uint32_t point : facet) {
      std::uint32_t below = next - point;
      if (below == 0) ++next;
      for (; below > 127; below >>= 7) bytes.push_back(static_cast<std::uint8_t>(below & 127) | 128);
      bytes.push_back(static_cast<std::uint8_t>(below));
    }
  return bytes;
}

std::string deflated_base64(const Bytes& bytes) {
  uLongf length = compressBound(static_cast<uLong>(bytes.size()));
  Bytes result(length);
  // Fails for lack of memory only, which the vector would have found.
  if (compress2(result.data(), &length, bytes.data(), static_cast<uLong>(bytes.size()), kLevel) != Z_OK)
    throw Error(ErrorCode::memory_limit, "zlib: not enough memory to compress a mesh", "free some memory, or leave --html out");
  result.resize(length);
  return base64(result);
}

std::string encoded_points(std::span<const Vec3> points, const Quantisation& quantisation) {
  std::vector<std::uint16_t> values;
  values.reserve(3 * points.size());
  for (const Vec3& p : points)
    for (const std::uint16_t q : quantisation(p)) values.push_back(q);
  return deflated_base64(packed_tuples(values, 3));
}

std::string encoded_values(std::span<const double> values, double most) {
  std::vector<std::uint16_t> numbers;
  numbers.reserve(values.size());
  for (const double value : values) {
    const double share = most > 0 ? std::clamp(value / most, -1.0, 1.0) : 0;
    numbers.push_back(static_cast<std::uint16_t>(static_cast<std::int16_t>(std::lround(share * kLargestSigned))));
  }
  return deflated_base64(packed_tuples(numbers, 1));
}

}  // namespace burnish
