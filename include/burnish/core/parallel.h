// Parallel loops with results that do not depend on the number of threads.
//
// Every verb splits [0, n) into chunks whose boundaries depend on n and the grain only, so a
// floating-point sum has the same bits on one thread and on sixty-four. The backend (TBB by default,
// std::thread under ThreadSanitizer, chosen by the CMake option BURNISH_PARALLEL) is seen by
// parallel.cpp alone.
//
// Exceptions thrown by a body reach the caller; which one, if several bodies throw, is not specified.
#pragma once

#include <algorithm>
#include <cstddef>
#include <functional>
#include <vector>

namespace burnish {

// Runs `body(chunk)` for every chunk in [0, chunks), in any order, possibly at the same time.
void parallel_chunks(std::size_t chunks, const std::function<void(std::size_t)>& body);

// The number of threads the verbs of this header may use now. At least 1.
int thread_count();

// While alive, no more than `threads` threads run the verbs of this header (0: as many as the
// machine has). For programs, not for the library: nothing in Burnish but its command line uses it.
class ThreadLimit {
 public:
  explicit ThreadLimit(int threads);
  ~ThreadLimit();
  ThreadLimit(const ThreadLimit&) = delete;
  ThreadLimit& operator=(const ThreadLimit&) = delete;

 private:
  void* handle_;
};

inline constexpr std::size_t kDefaultGrain = 1024;

// Runs `body(begin, end)` on consecutive ranges of at most `grain` indices that cover [0, n).
template <class Body>
void parallel_ranges(std::size_t n, std::size_t grain, Body&& body) {
  const std::size_t chunks = (n + grain - 1) / grain;
  if (chunks == 1) return body(std::size_t{0}, n);
  parallel_chunks(chunks, [&](std::size_t c) { body(c * grain, std::min(n, (c + 1) * grain)); });
}

// Runs `body(i)` for every i in [0, n).
template <class Body>
void parallel_for(std::size_t n, Body&& body, std::size_t grain = kDefaultGrain) {
  parallel_ranges(n, grain, [&](std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i) body(i);
  });
}

// Folds `range(begin, end) -> T` over the chunks of [0, n) from left to right with `combine`.
// The order of combination is fixed, so the result has the same bits for any number of threads.
template <class T, class Range, class Combine>
T parallel_reduce(std::size_t n, std::size_t grain, T init, Range&& range, Combine&& combine) {
  const std::size_t chunks = (n + grain - 1) / grain;
  std::vector<T> parts(chunks, init);
  parallel_ranges(n, grain, [&](std::size_t begin, std::size_t end) {
    parts[begin / grain] = range(begin, end);
  });
  T result = init;
  for (const T& part : parts) result = combine(result, part);
  return result;
}

// Replaces counts[0..n) by their exclusive prefix sum and returns the total. CSR's second step.
template <class T>
T exclusive_scan_in_place(std::vector<T>& counts) {
  T total{};
  for (T& c : counts) {
    const T here = c;
    c = total;
    total += here;
  }
  return total;
}

// Sorts by operator<. Equal elements must be indistinguishable for the result to be reproducible.
template <class T>
void parallel_sort(std::vector<T>& values) {
  const std::size_t n = values.size();
  if (n < 4 * kDefaultGrain || thread_count() == 1) {
    std::sort(values.begin(), values.end());
    return;
  }
  const std::size_t parts = 8;
  const auto bound = [&](std::size_t p) { return values.begin() + static_cast<std::ptrdiff_t>(n * p / parts); };
  parallel_chunks(parts, [&](std::size_t p) { std::sort(bound(p), bound(p + 1)); });
  for (std::size_t width = 1; width < parts; width *= 2) {
    parallel_chunks(parts / (2 * width), [&](std::size_t p) {
      const std::size_t first = 2 * width * p;
      std::inplace_merge(bound(first), bound(first + width), bound(first + 2 * width));
    });
  }
}

}  // namespace burnish
