#include "burnish/core/parallel.h"

#if defined(BURNISH_PARALLEL_THREADS)
#include <atomic>
#include <cstdint>
#include <exception>
#include <mutex>
#include <system_error>
#include <thread>
#else
#include <tbb/blocked_range.h>
#include <tbb/global_control.h>
#include <tbb/parallel_for.h>

#include <stdexcept>
#include <string>
#include <string_view>

#include "burnish/core/error.h"
#endif

namespace burnish {

#if defined(BURNISH_PARALLEL_THREADS)

namespace {

std::atomic<int> g_limit{0};

int hardware_threads() { return std::max(1u, std::thread::hardware_concurrency()); }

}  // namespace

int thread_count() {
  const int limit = g_limit.load();
  return limit > 0 ? limit : hardware_threads();
}

void parallel_chunks(std::size_t chunks, const std::function<void(std::size_t)>& body) {
  const std::size_t workers = std::min<std::size_t>(chunks, static_cast<std::size_t>(thread_count()));
  std::atomic<std::size_t> next{0};
  std::exception_ptr failure;
  std::mutex failure_mutex;
  const auto work = [&] {
    try {
      for (std::size_t c = next++; c < chunks; c = next++) body(c);
    } catch (...) {
      const std::lock_guard lock(failure_mutex);
      failure = std::current_exception();
      next = chunks;
    }
  };
  std::vector<std::thread> pool;
  try {
    for (std::size_t w = 1; w < workers; ++w) pool.emplace_back(work);
  } catch (const std::system_error&) {
    // Fewer threads than hoped for do the same work.
  }
  work();
  for (std::thread& t : pool) t.join();
  if (failure) std::rethrow_exception(failure);
}

// The handle is the limit that held before.
ThreadLimit::ThreadLimit(int threads) : handle_(reinterpret_cast<void*>(std::intptr_t{g_limit.exchange(threads)})) {}
ThreadLimit::~ThreadLimit() { g_limit = static_cast<int>(reinterpret_cast<std::intptr_t>(handle_)); }

#else

int thread_count() {
  return static_cast<int>(
      tbb::global_control::active_value(tbb::global_control::max_allowed_parallelism));
}

void parallel_chunks(std::size_t chunks, const std::function<void(std::size_t)>& body) {
  if (chunks <= 1 || thread_count() == 1) {
    for (std::size_t c = 0; c < chunks; ++c) body(c);
    return;
  }
  try {
    tbb::parallel_for(tbb::blocked_range<std::size_t>(0, chunks, 1),
                      [&](const tbb::blocked_range<std::size_t>& range) {
                        for (std::size_t c = range.begin(); c != range.end(); ++c) body(c);
                      },
                      tbb::simple_partitioner());
  } catch (const std::runtime_error& error) {
    // TBB has no type of its own for it.
    if (std::string_view(error.what()).starts_with("pthread_create"))
      throw Error(ErrorCode::memory_limit, std::string("no thread: ") + error.what(), "the system allows no more: try again with fewer --threads");
    throw;
  }
}

ThreadLimit::ThreadLimit(int threads)
    : handle_(threads > 0 ? new tbb::global_control(tbb::global_control::max_allowed_parallelism,
                                                    static_cast<std::size_t>(threads))
                          : nullptr) {}
ThreadLimit::~ThreadLimit() { delete static_cast<tbb::global_control*>(handle_); }

#endif

}  // namespace burnish
