// How meshes are written into an HTML page: quantised, delta coded, deflated, as base64. src/html/decode.js reads them.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "burnish/core/vec.h"
#include "burnish/surface/triangle_soup.h"

namespace burnish {

// 16-bit coordinates in a box: p = lower + q * step, each axis for itself.
struct Quantisation {
  Vec3 lower, step;  // a step is 0 where the box is flat

  static Quantisation of(const Box3& box);
  // The closest that there is: off by half a step at most, for points in the box.
  std::array<std::uint16_t, 3> operator()(const Vec3& p) const;
};

// The soup's points in the order in which its facets use them, without those that no facet uses.
TriangleSoup ordered_by_first_use(const TriangleSoup& soup);

using Bytes = std::vector<std::uint8_t>;

// Tuples of `channels` values: of each value the difference to that of the tuple before (modulo 65536, small ones of either sign to small
// numbers), channel by channel, first all low bytes of a channel, then all high ones. 2 bytes a value.
Bytes packed_tuples(std::span<const std::uint16_t> values, std::size_t channels);

// Indices of a soup ordered by first use: how far each is below the least one that was not used yet (0: it is that one), 7 bits a byte, the lowest first, the highest
// bit set on all bytes but the last.
Bytes packed_indices(std::span<const Facet> facets);

// A zlib stream as base64.
std::string deflated_base64(const Bytes& bytes);

// Points as base64 of packed tuples.
std::string encoded_points(std::span<const Vec3> points, const Quantisation& quantisation);

// Values in [-most, most] as 16-bit numbers: value = most * (int16 / 32767). `most` is 0 for zeros only.
std::string encoded_values(std::span<const double> values, double most);

}  // namespace burnish
