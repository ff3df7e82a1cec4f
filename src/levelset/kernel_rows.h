// Rows of eight nodes in vector registers, for units that are compiled for several processors.
#pragma once

#include <cstdint>
#include <cstring>

#include "burnish/octree/field.h"

#if defined(__x86_64__) && defined(__GNUC__) && !defined(__SANITIZE_THREAD__) && !defined(__SANITIZE_ADDRESS__) && \
    !defined(__clang__)
#define BURNISH_DISPATCH __attribute__((target_clones("default", "arch=x86-64-v3", "arch=x86-64-v4")))
#else
#define BURNISH_DISPATCH
#endif
// Inlined into every clone, so that it is compiled for that clone's processor.
#define BURNISH_INLINE inline __attribute__((always_inline))

namespace burnish::detail {

typedef double Row __attribute__((vector_size(kBlockSide * sizeof(double))));
typedef std::int64_t Mask __attribute__((vector_size(kBlockSide * sizeof(std::int64_t))));

BURNISH_INLINE Row row_of(double v) { return Row{} + v; }

BURNISH_INLINE Row load(const double* from) {
  Row row;
  std::memcpy(&row, from, sizeof row);
  return row;
}
BURNISH_INLINE Row load(const float* from) {
  typedef float Values __attribute__((vector_size(kBlockSide * sizeof(float))));
  Values values;
  std::memcpy(&values, from, sizeof values);
  return __builtin_convertvector(values, Row);
}
template <class T>
BURNISH_INLINE Row load_scaled(const T* from, double scale) {
  return load(from) * scale;
}

BURNISH_INLINE void store(const Row& row, double* to) { std::memcpy(to, &row, sizeof row); }
BURNISH_INLINE void store(const Row& row, float* to) {
  typedef float Values __attribute__((vector_size(kBlockSide * sizeof(float))));
  const Values values = __builtin_convertvector(row, Values);
  std::memcpy(to, &values, sizeof values);
}

BURNISH_INLINE Row larger(const Row& a, const Row& b) { return a > b ? a : b; }
BURNISH_INLINE Row smaller(const Row& a, const Row& b) { return a < b ? a : b; }
BURNISH_INLINE Row magnitude(const Row& a) { return larger(a, -a); }

// A byte per lane, 0xff where the mask is set; lane 0 lowest.
BURNISH_INLINE std::uint64_t bytes_of(const Mask& mask) {
  typedef std::int8_t Bytes __attribute__((vector_size(kBlockSide)));
  const Bytes bytes = __builtin_convertvector(mask, Bytes);
  std::uint64_t bits;
  std::memcpy(&bits, &bytes, sizeof bits);
  return bits;
}
// A bit per lane.
BURNISH_INLINE unsigned bits_of(const Mask& mask) {
  return static_cast<unsigned>(((bytes_of(mask) & 0x8040201008040201u) * 0x0101010101010101u) >> 56);
}

}  // namespace burnish::detail
