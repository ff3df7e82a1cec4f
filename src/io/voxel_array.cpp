#include "voxel_array.h"

#include <fmt/format.h>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <vector>

#include "burnish/core/parallel.h"
#include "text_scanner.h"

namespace burnish::detail {
namespace {

constexpr std::size_t kGrain = std::size_t{1} << 16;   // numbers unpacked at once
constexpr std::size_t kWindow = std::size_t{1} << 20;  // bytes inflated at once: whole numbers of any type
constexpr std::size_t kMostPerCall = std::size_t{1} << 30;  // zlib counts in 32 bits
constexpr double kTellApart = 0x1p-40;                      // of the largest coordinate: the least spacing, of which 4096 steps are left

template <class T>
T swapped(T value) {
  auto bytes = std::bit_cast<std::array<char, sizeof(T)>>(value);
  std::reverse(bytes.begin(), bytes.end());
  return std::bit_cast<T>(bytes);
}

template <class T>
void unpack_as(bool is_swapped, const char* bytes, std::span<float> to) {
  parallel_ranges(to.size(), kGrain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) {
      T value;
      std::memcpy(&value, bytes + i * sizeof(T), sizeof(T));
      to[i] = static_cast<float>(is_swapped ? swapped(value) : value);
    }
  });
}

[[noreturn]] void too_few(const Source& source, std::size_t numbers, std::size_t found) {
  source.fail(fmt::format("expected {} values, found {}", numbers, found), kVoxelHint);
}

// Streams of gzip or zlib, one behind the other.
class Inflater {
 public:
  Inflater(const Source& source, std::string_view stream) : source_(source), rest_(stream) {
    if (::inflateInit2(&z_, 15 + 32) != Z_OK) throw Error(ErrorCode::memory_limit, "zlib: not enough memory to decompress", "free some memory, or crop the volume");
  }
  ~Inflater() { ::inflateEnd(&z_); }
  Inflater(const Inflater&) = delete;
  Inflater& operator=(const Inflater&) = delete;

  // The next `size` bytes at most; fewer only at the end.
  std::size_t read(char* to, std::size_t size) {
    std::size_t done = 0;
    while (done < size && !ended_) {
      feed();
      z_.next_out = reinterpret_cast<Bytef*>(to + done);
      z_.avail_out = static_cast<uInt>(size - done);
      const int status = ::inflate(&z_, Z_NO_FLUSH);
      done = size - z_.avail_out;
      if (status == Z_STREAM_END) next_member();
      else if (status == Z_BUF_ERROR && z_.avail_in == 0 && rest_.empty()) ended_ = true;
      else if (status != Z_OK) source_.fail(fmt::format("compressed data are damaged: {}", z_.msg ? z_.msg : "they end too early"), kVoxelHint);
    }
    return done;
  }

 private:
  void feed() {
    if (z_.avail_in > 0) return;
    const std::size_t n = std::min(rest_.size(), kMostPerCall);
    z_.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(rest_.data()));
    z_.avail_in = static_cast<uInt>(n);
    rest_.remove_prefix(n);
  }

  // What follows and is no stream is padding.
  void next_member() {
    feed();
    ended_ = z_.avail_in == 0 || z_.next_in[0] != 0x1f || ::inflateReset(&z_) != Z_OK;
  }

  const Source& source_;
  std::string_view rest_;
  z_stream z_{};
  bool ended_ = false;
};

constexpr std::array<int, 256> base64_digits() {
  std::array<int, 256> digits{};
  digits.fill(-1);
  constexpr std::string_view kDigits = "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  for (std::size_t i = 0; i < kDigits.size(); ++i) digits[static_cast<unsigned char>(kDigits[i])] = static_cast<int>(i);
  return digits;
}

}  // namespace

std::size_t size_of(VoxelType type) {
  switch (type) {
    case VoxelType::uint8:
    case VoxelType::int8: return 1;
    case VoxelType::uint16:
    case VoxelType::int16: return 2;
    case VoxelType::uint32:
    case VoxelType::int32:
    case VoxelType::float32: return 4;
    case VoxelType::uint64:
    case VoxelType::int64:
    case VoxelType::float64: break;
  }
  return 8;
}

std::size_t checked_count(const Source& source, const std::array<std::uint32_t, 3>& nodes, double bytes, double per_number, std::uint64_t memory) {
  double count = 1;
  for (const std::uint32_t n : nodes) count *= n;
  const std::string size = fmt::format("{} x {} x {} values", nodes[0], nodes[1], nodes[2]);
  if (count < 1) source.fail(size + ": expected at least one along each axis", kVoxelHint);
  if (count * per_number > bytes)
    source.fail(fmt::format("{} cannot be in the {:.0f} bytes that are there for them: the file is cut off, or its header is wrong", size, bytes), kVoxelHint);
  if (count * sizeof(float) > static_cast<double>(memory))
    throw Error(ErrorCode::memory_limit, fmt::format("{}: {} need {:.1f} GB; the budget is {:.1f} GB", source.label, size, count * sizeof(float) * 0x1p-30, static_cast<double>(memory) * 0x1p-30),
                "raise --memory, or crop or resample the volume");
  return static_cast<std::size_t>(count);
}

void unpack(NumberLayout layout, const char* bytes, std::span<float> to) {
  const bool is_swapped = layout.big_endian != (std::endian::native == std::endian::big);
  switch (layout.type) {
    case VoxelType::uint8: return unpack_as<std::uint8_t>(is_swapped, bytes, to);
    case VoxelType::int8: return unpack_as<std::int8_t>(is_swapped, bytes, to);
    case VoxelType::uint16: return unpack_as<std::uint16_t>(is_swapped, bytes, to);
    case VoxelType::int16: return unpack_as<std::int16_t>(is_swapped, bytes, to);
    case VoxelType::uint32: return unpack_as<std::uint32_t>(is_swapped, bytes, to);
    case VoxelType::int32: return unpack_as<std::int32_t>(is_swapped, bytes, to);
    case VoxelType::uint64: return unpack_as<std::uint64_t>(is_swapped, bytes, to);
    case VoxelType::int64: return unpack_as<std::int64_t>(is_swapped, bytes, to);
    case VoxelType::float32: return unpack_as<float>(is_swapped, bytes, to);
    case VoxelType::float64: return unpack_as<double>(is_swapped, bytes, to);
  }
}

void read_raw(const Source& source, std::string_view bytes, NumberLayout layout, std::span<float> to) {
  const std::size_t size = size_of(layout.type);
  if (bytes.size() / size < to.size()) too_few(source, to.size(), bytes.size() / size);
  unpack(layout, bytes.data(), to);
}

void read_deflated(const Source& source, std::string_view stream, NumberLayout layout, std::uint64_t skip, std::span<float> to, Progress& progress) {
  const std::size_t size = size_of(layout.type), total = to.size();
  Inflater inflater(source, stream);
  std::vector<char> window(kWindow);
  while (skip > 0) {
    progress.check();
    const std::size_t n = inflater.read(window.data(), static_cast<std::size_t>(std::min<std::uint64_t>(skip, kWindow)));
    if (n == 0) too_few(source, total, 0);
    skip -= n;
  }
  while (!to.empty()) {
    progress.check();
    const std::size_t n = std::min(to.size(), kWindow / size), found = inflater.read(window.data(), n * size) / size;
    if (found < n) too_few(source, total, total - to.size() + found);
    unpack(layout, window.data(), to.first(n));
    to = to.subspan(n);
  }
}

void read_words(const Source& source, std::string_view text, std::span<float> to, Progress& progress) {
  const char *p = text.data(), *end = p + text.size();
  for (std::size_t i = 0; i < to.size(); ++i) {
    if (i % kGrain == 0) progress.check();
    while (p < end && (is_blank(*p) || *p == ',')) ++p;
    if (p == end) too_few(source, to.size(), i);
    double value;
    const char* next = read_number(p, end, value);
    if (next == nullptr || (next < end && !is_blank(*next) && *next != ','))
      source.fail_at(p, fmt::format("expected a number, found {}", quoted({p, static_cast<std::size_t>(std::find_if(p, end, is_blank) - p)})), kVoxelHint);
    to[i] = static_cast<float>(value);
    p = next;
  }
}

std::string decode_base64(std::string_view text, std::size_t most) {
  static constexpr std::array<int, 256> kDigits = base64_digits();
  std::string bytes;
  bytes.reserve(std::min(most, text.size() / 4 * 3 + 3));
  std::uint32_t bits = 0;
  int digits = 0;
  const auto flush = [&] {  // a group, or the part of one that padding ends
    for (int b = 0; b + 1 < digits && bytes.size() < most; ++b) bytes += static_cast<char>(bits << 6 * (4 - digits) >> (16 - 8 * b) & 0xff);
    bits = 0;
    digits = 0;
  };
  for (const char c : text) {
    if (bytes.size() >= most) break;
    const int digit = kDigits[static_cast<unsigned char>(c)];
    if (digit >= 0) {
      bits = bits << 6 | static_cast<std::uint32_t>(digit);
      if (++digits == 4) flush();
    } else if (c == '=') {
      flush();
    } else if (!is_blank(c)) {
      break;
    }
  }
  flush();
  return bytes;
}

void require_places(const Source& source, const VoxelVolume& volume) {
  for (int axis = 0; axis < 3; ++axis) {
    const double spacing = volume.spacing[axis], first = volume.origin[axis], last = first + spacing * (volume.nodes[static_cast<std::size_t>(axis)] - 1.0);
    const double largest = std::max(std::abs(first), std::abs(last));
    if (!(spacing >= kLeastLength && spacing <= kLargestLength))
      source.fail(fmt::format("expected a spacing between {:g} and {:g}, found {:g}", kLeastLength, kLargestLength, spacing), "give it in another unit");
    if (!(largest <= kLargestLength && spacing >= kTellApart * largest))
      source.fail(fmt::format("expected voxels at places that can be told apart, found a spacing of {:g} at coordinates of {:g}", spacing, largest), "move the origin towards 0");
  }
}

void reverse_axis(VoxelVolume& volume, std::size_t axis) {
  std::size_t stride = 1;
  for (std::size_t a = 0; a < axis; ++a) stride *= volume.nodes[a];
  const std::size_t n = volume.nodes[axis], rows = volume.size() / (n * stride);
  parallel_for(rows, [&](std::size_t row) {
    float* first = volume.values.data() + row * n * stride;
    for (std::size_t i = 0; i < n / 2; ++i) std::swap_ranges(first + i * stride, first + (i + 1) * stride, first + (n - 1 - i) * stride);
  }, 64);
}

}  // namespace burnish::detail
