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

BURNISH_INLINE Row load(const double* from) {
  Row row;
  std::memcpy(&row, from, sizeof row);
  return row;
}
BURNISH_INLINE void store(const Row& row, double* to) { std::memcpy(to, &row, sizeof row); }

// Values of another type, multiplied.
template <class T>
BURNISH_INLINE Row load_scaled(const T* from, double scale) {
  typedef T Values __attribute__((vector_size(kBlockSide * sizeof(T))));
  Values values;
  std::memcpy(&values, from, sizeof values);
  return __builtin_convertvector(values, Row) * scale;
}

}  // namespace burnish::detail
