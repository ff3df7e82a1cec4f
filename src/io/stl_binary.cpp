// Binary STL: 80 bytes of header, a 32-bit count, and 50 bytes per facet: normal and three vertices as
// little-endian float32, 16 bits of attributes. Normals are not looked at; attributes may be colours.
//
// The count lies in the wild. Facets promised but not there are an error. Bytes beyond the count are
// read as facets if they are a whole number of them with coordinates in the range of the others
// (programs that never come back to fill in the count leave 0 there); otherwise they are ignored.
// Either way there is a warning.
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>

#include "huge_pages.h"
#include "readers.h"
#include "stl_colors.h"

namespace burnish {
namespace {

static_assert(std::endian::native == std::endian::little, "the reader copies little-endian floats");

constexpr std::size_t kHeaderBytes = 80;
constexpr std::size_t kPrefix = 84;
constexpr std::size_t kFacetBytes = 50;
constexpr std::size_t kNormalBytes = 12;
constexpr std::size_t kAttributeAt = 48;

using Corners = std::array<float, 9>;

Corners corners_of(const char* facet) {
  Corners c;
  std::memcpy(c.data(), facet + kNormalBytes, sizeof c);
  return c;
}

std::uint16_t attribute_of(const char* facet) {
  std::uint16_t attribute = 0;
  std::memcpy(&attribute, facet + kAttributeAt, sizeof attribute);
  return attribute;
}

bool all_finite(const Corners& corners) {
  return std::all_of(corners.begin(), corners.end(), [](float c) { return std::isfinite(c); });
}

float largest_coordinate(const char* facets, std::size_t count) {
  float largest = 0;
  for (std::size_t f = 0; f < count; ++f)
    for (const float c : corners_of(facets + f * kFacetBytes))
      largest = std::isnan(c) ? INFINITY : std::max(largest, std::abs(c));
  return largest;
}

// Whether the facets beyond the count are facets, and not a trailer of some other meaning.
bool are_plausible(const char* facets, std::size_t promised, std::size_t held) {
  if (promised == 0) return true;
  const float limit = 1000 * largest_coordinate(facets, promised);
  return largest_coordinate(facets + promised * kFacetBytes, held - promised) <= limit;
}

// The facets to read: the count of the header confronted with the size of the file.
std::size_t facets_to_read(const Source& source, std::vector<std::string>& warnings) {
  std::uint32_t promised = 0;
  std::memcpy(&promised, source.begin() + kPrefix - sizeof promised, sizeof promised);
  const std::size_t rest = source.bytes.size() - kPrefix;
  const std::size_t held = rest / kFacetBytes;
  if (promised > held) {
    const std::string what = fmt::format("truncated at byte {}: header promises {}, file holds {}",
                                         source.bytes.size(), counted(promised, "triangle"), held);
    if (!source.salvage || held == 0) source.fail(what, held == 0 ? "re-export the file" : kSalvageHint);
    warnings.push_back(what);
    return held;
  }
  if (rest == promised * kFacetBytes) return promised;
  if (rest % kFacetBytes == 0 && are_plausible(source.begin() + kPrefix, promised, held)) {
    warnings.push_back(
        fmt::format("header promises {}, file holds {}: all were read", counted(promised, "triangle"), held));
    return held;
  }
  warnings.push_back(fmt::format("{} behind the last of {} ignored",
                                 counted(rest - promised * kFacetBytes, "byte"),
                                 counted(promised, "triangle")));
  return promised;
}

// Appends facets a few at a time from a small buffer: resizing the vectors first would write each of
// their pages twice.
class FacetReader {
 public:
  FacetReader(const Source& source, TriangleSoup& soup) : source_(source), soup_(soup) {}

  void read(const char* facets, std::size_t count) {
    reserve_on_huge_pages(soup_.points, 3 * count);
    reserve_on_huge_pages(soup_.facets, count);
    for (std::size_t f = 0; f < count; f += kBatch)
      read_batch(facets + f * kFacetBytes, std::min(kBatch, count - f));
  }
  const Tally& dropped() const { return dropped_; }
  bool has_attributes() const { return attribute_bits_ != 0; }

 private:
  static constexpr std::size_t kBatch = 64;

  void read_batch(const char* facets, std::size_t count) {
    std::array<Vec3, 3 * kBatch> points;
    std::size_t kept = 0;
    for (std::size_t f = 0; f < count; ++f) {
      const Corners c = corners_of(facets + f * kFacetBytes);
      attribute_bits_ |= attribute_of(facets + f * kFacetBytes);
      if (!all_finite(c)) {
        refuse(facets + f * kFacetBytes);
        continue;
      }
      for (std::size_t i = 0; i < 3; ++i) points[3 * kept + i] = {c[3 * i], c[3 * i + 1], c[3 * i + 2]};
      ++kept;
    }
    append(points.data(), kept);
  }

  void append(const Vec3* points, std::size_t facets) {
    std::array<Facet, kBatch> indices;
    const auto base = static_cast<std::uint32_t>(soup_.points.size());
    for (std::uint32_t f = 0; f < facets; ++f)
      indices[f] = {base + 3 * f, base + 3 * f + 1, base + 3 * f + 2};
    soup_.points.insert(soup_.points.end(), points, points + 3 * facets);
    soup_.facets.insert(soup_.facets.end(), indices.data(), indices.data() + facets);
  }

  void refuse(const char* facet) {
    if (!source_.salvage) {
      const std::size_t index = (static_cast<std::size_t>(facet - source_.begin()) - kPrefix) / kFacetBytes;
      source_.fail_at(facet, fmt::format("facet {} has a coordinate that is not a finite number", index),
                      "re-export the file, or pass --salvage to leave such facets out");
    }
    dropped_.add(facet);
  }

  const Source& source_;
  TriangleSoup& soup_;
  std::uint16_t attribute_bits_ = 0;  // all bits that any facet sets
  Tally dropped_;
};

// The attributes of the facets that were kept. A pass of its own: hardly a file has any.
std::vector<std::uint16_t> kept_attributes(const char* facets, std::size_t count) {
  std::vector<std::uint16_t> attributes;
  attributes.reserve(count);
  for (const char* facet = facets; facet < facets + count * kFacetBytes; facet += kFacetBytes)
    if (all_finite(corners_of(facet))) attributes.push_back(attribute_of(facet));
  return attributes;
}

}  // namespace

MeshFile read_stl_binary(const Source& source) {
  if (source.bytes.size() < kPrefix)
    source.fail(
        fmt::format("a binary STL has at least {} bytes, this file has {}", kPrefix, source.bytes.size()),
        "re-export the file");
  MeshFile file;
  file.format = MeshFormat::stl_binary;
  const std::string_view header = source.bytes.substr(0, kHeaderBytes);
  file.header = stl_header_text(header);
  const std::size_t count = facets_to_read(source, file.warnings);
  if (count > kMaxFacets)
    source.fail(fmt::format("{} are more than the {} that can be read", counted(count, "facet"), kMaxFacets),
                "split the file");
  FacetReader reader(source, file.soup);
  reader.read(source.begin() + kPrefix, count);
  if (reader.has_attributes() || has_part_color(header))
    file.soup.colors = colors_of_attributes(header, kept_attributes(source.begin() + kPrefix, count));
  if (const Tally& dropped = reader.dropped(); dropped.count() > 0)
    file.warnings.push_back(fmt::format("left out {} with coordinates that are not finite, the first at {}",
                                        counted(dropped.count(), "facet"), source.place(dropped.first())));
  return file;
}

}  // namespace burnish
