#include "stl.h"

#include <algorithm>
#include <bit>
#include <charconv>
#include <cmath>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <numeric>
#include <optional>
#include <string_view>

namespace judge {
namespace {

constexpr std::size_t kHeader = 84, kRecord = 50;
static_assert(std::endian::native == std::endian::little);

using Corner = std::array<float, 3>;

// Collects corners facet by facet; welding comes at the end.
struct Corners {
  std::vector<Corner> all;  // three a facet
  std::size_t left_out = 0;

  void add(const Corner& a, const Corner& b, const Corner& c) {
    for (const Corner* corner : {&a, &b, &c})
      for (float x : *corner)
        if (!std::isfinite(x)) {
          ++left_out;
          return;
        }
    all.insert(all.end(), {a, b, c});
  }
};

std::uint32_t promised_facets(std::string_view bytes) {
  std::uint32_t count;
  std::memcpy(&count, bytes.data() + kHeader - 4, 4);
  return count;
}

std::string lower(std::string_view text) {
  std::string result(text);
  for (char& c : result)
    if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
  return result;
}

// Headers of binary files may begin with "solid", and names of ASCII solids may hold any bytes but zero.
bool is_text(std::string_view bytes) {
  if (bytes.size() >= kHeader && bytes.size() == kHeader + kRecord * std::size_t{promised_facets(bytes)})
    return false;
  const std::string start = lower(bytes.substr(0, 4096));
  return start.find('\0') == std::string::npos &&
         (start.find("vertex") != std::string::npos || start.find("facet") != std::string::npos);
}

void read_binary(std::string_view bytes, Corners& corners) {
  if (bytes.size() < kHeader) return;
  // A count that is too small leaves whole records behind: they are facets, too.
  const std::size_t held = (bytes.size() - kHeader) / kRecord, promised = promised_facets(bytes);
  const bool whole = (bytes.size() - kHeader) % kRecord == 0;
  const std::size_t count = whole ? held : std::min(held, promised ? promised : held);
  corners.all.reserve(3 * count);
  for (std::size_t f = 0; f < count; ++f) {
    std::array<Corner, 3> facet;
    std::memcpy(facet.data(), bytes.data() + kHeader + kRecord * f + 12, sizeof facet);
    corners.add(facet[0], facet[1], facet[2]);
  }
}

class Words {
 public:
  explicit Words(std::string_view text) : text_(text) {}

  // The next word, empty at the end of the text.
  std::string_view next() {
    std::size_t begin = at_;
    while (begin < text_.size() && is_blank(text_[begin])) ++begin;
    at_ = begin;
    while (at_ < text_.size() && !is_blank(text_[at_])) ++at_;
    return text_.substr(begin, at_ - begin);
  }

 private:
  static bool is_blank(char c) { return static_cast<unsigned char>(c) <= ' '; }
  std::string_view text_;
  std::size_t at_ = 0;
};

std::optional<float> number(std::string_view word) {
  std::string text(word);
  std::replace(text.begin(), text.end(), ',', '.');
  const char* begin = text.data() + (text.starts_with('+') ? 1 : 0);
  float value = 0;
  const auto [end, error] = std::from_chars(begin, text.data() + text.size(), value);
  // Numbers too small for a float come back as out of range.
  const bool tiny = error == std::errc::result_out_of_range && std::abs(std::strtod(begin, nullptr)) < 1;
  if (tiny) return 0.0f;
  if (error != std::errc() || end != text.data() + text.size()) return std::nullopt;
  return value;
}

// Three corners are a facet, more are a fan of them, fewer are nothing.
void finish_facet(std::vector<Corner>& loop, bool& complete, Corners& corners) {
  if (complete)
    for (std::size_t i = 2; i < loop.size(); ++i) corners.add(loop[0], loop[i - 1], loop[i]);
  corners.left_out += !complete || loop.size() == 1 || loop.size() == 2;
  loop.clear();
  complete = true;
}

void read_text(std::string_view bytes, Corners& corners) {
  Words words(bytes);
  std::vector<Corner> loop;
  bool complete = true;
  for (auto word = words.next(); !word.empty(); word = words.next()) {
    const std::string key = lower(word);
    if (key == "endloop" || key == "endfacet" || key == "facet" || key == "endsolid")
      finish_facet(loop, complete, corners);
    if (key != "vertex") continue;
    Corner corner;
    for (float& x : corner) {
      const auto value = number(words.next());
      complete = complete && value;
      x = value.value_or(0);
    }
    loop.push_back(corner);
  }
  finish_facet(loop, complete, corners);
}

// Corners with equal coordinates become one point.
void weld(Corners& corners, Mesh& mesh) {
  for (Corner& corner : corners.all)
    for (float& x : corner) x += 0.0f;  // -0 becomes +0
  std::vector<std::uint32_t> order(corners.all.size());
  std::iota(order.begin(), order.end(), 0u);
  std::sort(order.begin(), order.end(), [&](auto a, auto b) { return corners.all[a] < corners.all[b]; });
  mesh.facets.resize(order.size() / 3);
  for (std::size_t i = 0; i < order.size(); ++i) {
    const Corner& corner = corners.all[order[i]];
    if (i == 0 || corners.all[order[i - 1]] != corner)
      mesh.points.push_back({corner[0], corner[1], corner[2]});
    mesh.facets[order[i] / 3][order[i] % 3] = static_cast<std::uint32_t>(mesh.points.size() - 1);
  }
}

}  // namespace

Mesh read_stl(const std::string& path) {
  Mesh mesh;
  std::ifstream file(path, std::ios::binary);
  const std::string bytes{std::istreambuf_iterator<char>(file), {}};
  if (!file.is_open() || file.bad()) {
    mesh.error = "cannot be read";
    return mesh;
  }
  Corners corners;
  if (is_text(bytes))
    read_text(bytes, corners);
  else
    read_binary(bytes, corners);
  mesh.left_out = corners.left_out;
  weld(corners, mesh);
  return mesh;
}

}  // namespace judge
