// What is more than the numbers of a file, or of a soup, can count: one refusal for each, with the count as its argument.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <string>

#include "burnish/core/error.h"
#include "readers.h"

namespace burnish {

constexpr std::uint64_t kMostOf32Bits = 0xffffffffu;

// One more point, or `more` more facets, for a soup that has so many.
inline void require_room_for_point(const Source& source, const char* at, std::uint64_t points) {
  if (points >= kMaxFacets) source.fail_at(at, fmt::format("more than the {} points that can be read", kMaxFacets), "split the file");
}
inline void require_room_for_facets(const Source& source, const char* at, std::uint64_t facets, std::uint64_t more) {
  if (facets + more > 3 * std::uint64_t{kMaxFacets}) source.fail_at(at, "more facets than can be read", "split the file");
}
// Of an STL, whose facets bring three points each.
inline void require_room_for_facet(const Source& source, std::uint64_t facets) {
  if (facets >= kMaxFacets) source.fail(fmt::format("more than the {} facets that can be read", kMaxFacets), "split the file");
}
// Of a 3MF, whose objects are put together.
inline void require_room_for_object(const Source& source, std::uint64_t points, std::uint64_t facets) {
  if (points > kMostOf32Bits || facets > kMostOf32Bits) source.fail("holds more points than 32 bits count", "split the model, or export it as STL, in parts");
}

// Bytes of a file in an archive, and where the next one would begin.
inline void require_zip_without_64(const std::string& label, std::uint64_t size, std::uint64_t next) {
  if (size >= kMostOf32Bits || next >= kMostOf32Bits)
    throw Error(ErrorCode::unwritable_output, label + ": the model takes 4 GiB of a ZIP archive or more", "write .ply or .stl");
}
// Of a CGNS file, whose library was built for numbers of so many bits, with a sign.
inline void require_signed(const std::string& label, std::uint64_t items, int bits) {
  if (items >= std::uint64_t{1} << (bits - 1))
    throw Error(ErrorCode::usage, fmt::format("{}: {} items are more than numbers of {} bits count", label, items, bits), "write an OpenFOAM case or a .vtu");
}
// Of a mesh of OpenFOAM, in labels of 32 bits.
inline void require_32_bit_labels(const std::string& folder, std::uint64_t corners) {
  if (corners > kMostOf32Bits / 2)
    throw Error(ErrorCode::usage, fmt::format("{}: {} corners of faces are more than labels of 32 bits count", folder, corners), "choose larger cells, or write labels of 64 bits");
}

}  // namespace burnish
